"""Short recordings of many robots of one make, in closed form: a folder for each robot, as `python -m residyn.fleet` takes it.

    python python/tests/simulated_fleet.py FOLDER --robots 200 --recordings 10
    python python/tests/simulated_fleet.py FOLDER --against OUT        # how far a fleet's tables are from one process

Robots are UR5s whose inertials, viscous and Coulomb friction differ by a few per cent; the elbows of some are worn (`worn`).
"""

import argparse
from pathlib import Path

import numpy as np

import residyn
import residyn.fleet

RATE = 100.0
#: Viscous and Coulomb friction of each joint, N·m·s/rad and N·m.
FRICTION = np.array([[8.0, 8.0, 6.0, 1.2, 1.2, 1.0], [9.0, 9.0, 6.0, 1.5, 1.5, 1.2]])
#: How far robots of one make differ.
SPREAD = 0.03
ELBOW = 2
#: Times the usual friction of a worn elbow.
WORN = 1.6


def name(number):
    return f"robot-{number:04d}"


def worn(number):
    """Every fiftieth robot, from the third on."""
    return number % 50 == 3


def motion(rng, seconds, joints):
    """Positions, velocities and accelerations: sines of five incommensurate frequencies."""
    time = np.arange(int(seconds * RATE)) / RATE
    omega = 2 * np.pi * np.array([0.11, 0.23, 0.37, 0.53, 0.71])[:, None, None]
    phase, size = rng.uniform(0, 2 * np.pi, (2, 5, 1, joints))
    angle = omega * time[None, :, None] + phase
    size = 0.05 * size / omega
    tables = (size * np.sin(angle), size * omega * np.cos(angle), -size * omega**2 * np.sin(angle))
    return time, [table.sum(axis=0) for table in tables]


def make(folder, robots, recordings, seconds=10.0, seed=1):
    """Writes the recordings of `robots` robots."""
    robot = residyn.Robot("ur5")
    nominal = np.array(robot.parameters)
    for number in range(robots):
        rng = np.random.default_rng([seed, number])
        own = nominal * (1 + SPREAD * rng.normal(size=nominal.size))
        friction = FRICTION * (1 + SPREAD * rng.normal(size=FRICTION.shape))
        if worn(number):
            friction[:, ELBOW] *= WORN
        place = Path(folder) / name(number)
        place.mkdir(parents=True, exist_ok=True)
        for k in range(recordings):
            time, (q, qd, qdd) = motion(rng, seconds, robot.dof)
            tau = robot.regressor(q, qd, qdd) @ own + friction[0] * qd + friction[1] * np.sign(qd)
            tau += 0.01 * tau.std(axis=0) * rng.normal(size=tau.shape)
            residyn.Recording(time, q, tau).write(place / f"{k:03d}.parquet")


def apart(folder, out):
    """Largest difference of a fleet's parameters and deviations from those of one process that has a robot's recordings all to
    itself, over the larger of both; and the number of parameters."""
    rows = residyn.fleet.Fleet(Path(out)).table("parameters")
    worst, count = 0.0, 0
    for place in sorted(Path(folder).iterdir()):
        one = residyn.Accumulator("ur5")
        for path in sorted(place.iterdir()):
            one.add(path)
        ours = {p.name: np.array([p.value, p.std]) for p in one.finish().parameters}
        theirs = [row for row in rows if row["robot"] == place.name]
        assert [row["parameter"] for row in theirs] == list(ours)
        for row in theirs:
            own = ours[row["parameter"]]
            worst = max(worst, np.abs(own - [row["value"], row["std"]]).max() / np.abs(own).max())
            count += 1
    return worst, count


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder")
    parser.add_argument("--robots", type=int, default=200)
    parser.add_argument("--recordings", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--against", help="tables of a fleet of the recordings that are there")
    arguments = vars(parser.parse_args())
    against = arguments.pop("against")
    if against is None:
        make(**arguments)
    else:
        worst, count = apart(arguments["folder"], against)
        print(f"{count} parameters and deviations, at most {worst:.1e} apart")
