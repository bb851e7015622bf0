"""Sealed diagnosis cases whose plant is MuJoCo: python trials/mujoco/cases.py --cases 40 --seed 1 --out DIR [--only KIND]

An independent simulator beside the one in `trials/src/cases`: other code for the dynamics, other integrator, friction by a
constraint solver. A case is a robot's description, a session of twelve trajectories of 15 s at 250 Hz under closed loop, four
of them held out, and a sealed truth. The plant is the description with link masses and inertias off by up to 3 % and friction
by up to 10 %, and one withheld effect (`effects.py`, `outside.py`); how it is simulated stands in `arm.py`.

The size of an effect is set on three trajectories and must give 0.05 to 0.35 of its joint's torque on the held-out ones. Its torque
is all that the recorded torque, before noise, has beyond inverse dynamics and friction of the plant without it on the true motion.
The control knows the true motion; counts and noise are in the recording alone.

Writes cases/ID/robot.xml, cases/ID/train.parquet, cases/ID/test.parquet and truth/ID.json, the last as
`tools/score_cases.py` reads it, in the fields of `trials/src/cases/truth.rs`. Forty cases hold four without an effect (`none`), four of
something that the catalogue does not list (`outside`), and two or three of each slot of `effects.SINGLES`. Case i depends on seed and
i alone; the same seed writes the same bytes. Columns: trajectory; time, s; q, rad (m); qd, rad/s; tau, N m (N).
Needs mujoco (4.0), numpy, pyarrow.
"""
import argparse
import copy
import hashlib
import itertools
import json
import os
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
import pyarrow
import pyarrow.parquet

from arm import LENGTH, PAUSE, RATE, Arm, Control, Motion, Trace, effect_torque, inverse_dynamics, low_pass, simulate
from effects import SINGLES, TRAJECTORIES, Effect
from outside import OUTSIDE

ROUND = 40  # cases after which kinds are balanced
HELD_OUT = (2, 5, 8, 11)
PILOT = (2, 5, 8)  # trajectories on which the size is set
ROUNDS = 3  # times that it is
ATTEMPTS = 30  # draws before giving up; some do not suit their effect
SHARES = (0.05, 0.35)  # share of the reference joint's torque that a case may have
CUTOFFS = (10.0, 15.0, 25.0, 40.0)  # of the oracle's low-pass, Hz
SOFTNESS = 0.003  # of the oracle's sign of the velocity, rad/s
STRIDE = 7  # rows between those of the projection
ROTOR = 10.0  # inertia beside single parameters, kg m2


def deal(seed, index):
    """Effect class of a case; None: nothing is withheld."""
    rng = np.random.default_rng([seed, index // ROUND, 0xDEA1])
    more = rng.choice(len(SINGLES), 4, replace=False)
    slots = [rng.permutation(len(s)) for s in SINGLES]
    deck = [None] * 4 + [OUTSIDE[i % len(OUTSIDE)] for i in range(4)]
    for i, slot in enumerate(SINGLES):
        for k in range(3 if i in more else 2):
            deck.append(slot[slots[i][k % len(slot)]])
    return deck[rng.permutation(ROUND)[index % ROUND]]


def kind_of(effect):
    """Name of the kind of a case."""
    return "none" if effect is None else "outside" if effect in OUTSIDE else effect.name


def name(seed, index):
    """Name of a case: ten hexadecimal digits."""
    return hashlib.sha256(f"residyn mujoco case {seed} {index}".encode()).hexdigest()[:10]


def rms(x):
    """Root mean square of each column."""
    return np.sqrt((x**2).mean(axis=0))


def derivative(x):
    """Central differences in time within each trajectory."""
    rows = round(LENGTH * RATE)
    return np.concatenate([np.gradient(x[k : k + rows], 1 / RATE, axis=0) for k in range(0, len(x), rows)])


def draw(arm, effect_class, seed, index, attempt):
    """A session with an effect in a size that suits: (effect, size, motions, control), or None."""
    rng = np.random.default_rng([seed, index, attempt, 1])
    motions = {i: Motion(arm, rng, effect_class.pace) for i in range(TRAJECTORIES)}
    control = Control(arm, rng)
    effect = effect_class(arm, list(motions.values()), rng)
    low, high = effect.bounds
    if high == 0:
        return effect, 0.0, motions, control
    wanted = np.exp(rng.uniform(*np.log(effect.shares)))
    size = np.exp(rng.uniform(*np.log(effect.bounds)))
    pilot = {i: motions[i] for i in PILOT}
    share = 0.0
    for _ in range(ROUNDS):
        traces = simulate(arm, effect, size, control, pilot)
        if traces is None:
            # Too large to be followed.
            size = max(low, size / 4)
            continue
        share = reference(effect, shares(arm, effect, traces))[1]
        before, size = size, float(np.clip(size * np.clip(wanted / share, 0.01, 100), low, high))
        if 0.8 < size / before < 1.25:
            break
    share *= size / before if share else 0.0
    return (effect, size, motions, control) if 0.9 * SHARES[0] < share < 1.1 * SHARES[1] else None


def shares(arm, effect, traces):
    """Root mean square of the effect's torque over the deviation of each joint's."""
    return rms(effect_torque(arm, effect, traces)) / Trace.joined(traces).tau.std(axis=0)


def reference(effect, share):
    """Joint on which an effect's size counts, and its share there."""
    joint = int(np.argmax(share)) if effect.joint is None else effect.joint
    return joint, share[joint]


def oracle(arm, q, tau, withheld, vibrates, noise):
    """Held-out NRMSE by joint that models can have on the recording, at the cut-off at which the true one does best.

    `withheld` is the effect's torque; where it acts through vibration of the plant it is filtered as the motion is.
    """
    best = None
    for cutoff in CUTOFFS:
        q_smooth = low_pass(q, cutoff)
        qd = derivative(q_smooth)
        qdd, sign = derivative(qd), np.tanh(qd / SOFTNESS)
        given = inverse_dynamics(arm.nominal, q_smooth, qd, qdd) + arm.nominal.dof_frictionloss * sign
        plain = inverse_dynamics(arm.plain, q_smooth, qd, qdd) + arm.loss * sign
        effect = low_pass(withheld, cutoff) if vibrates else withheld
        rest = {"as_given": tau - given, "without_effect": tau - plain, "with_effect": tau - plain - effect, "noise_floor": noise}
        nrmse = {key: rms(r) / tau.std(axis=0) for key, r in rest.items()}
        if best is None or nrmse["with_effect"].mean() < best[1]["with_effect"].mean():
            best = cutoff, nrmse
    cutoff, nrmse = best
    return {
        "cutoff_hz": cutoff,
        "mean_nrmse": {key: v.mean() for key, v in nrmse.items()},
        "nrmse": {key: v.tolist() for key, v in nrmse.items()},
    }


def regressor(arm, q, qd, qdd):
    """Torque per standard parameter of each moving body and per joint's friction: samples x joints x parameters.

    Inverse dynamics is linear in the parameters, so a column is its torque with one body of unit parameter and no other.
    """
    model = copy.copy(arm.nominal)
    # With some rotor inertia, which is taken off again, no mass matrix is singular.
    model.dof_damping[:], model.dof_armature[:] = 0, ROTOR
    columns = []
    for body in arm.bodies:
        b = model.body(body).id
        for mass, ipos in ((1, (0, 0, 0)), (1, (1, 0, 0)), (1, (0, 1, 0)), (1, (0, 0, 1))):
            columns.append((b, mass, ipos, (0, 0, 0), (1, 0, 0, 0)))
        for axis in range(3):
            unit, turn = np.eye(3)[axis], np.zeros(4)
            turn[0], turn[1 + axis] = np.cos(np.pi / 8), np.sin(np.pi / 8)
            # A principal moment, and a product of inertia: moments 1 and -1 turned by 45 degrees.
            columns.append((b, 0, (0, 0, 0), unit, (1, 0, 0, 0)))
            columns.append((b, 0, (0, 0, 0), np.roll([0, 1, -1], axis), turn))
    table = np.empty((*q.shape, len(columns) + 2 * arm.n))
    table[:, :, len(columns) :] = 0
    for c, (b, mass, ipos, inertia, iquat) in enumerate(columns):
        model.body_mass[:], model.body_inertia[:] = 0, 0
        model.body_mass[b], model.body_ipos[b], model.body_inertia[b], model.body_iquat[b] = mass, ipos, inertia, iquat
        table[:, :, c] = inverse_dynamics(model, q, qd, qdd) - ROTOR * qdd
    for j in range(arm.n):
        table[:, j, len(columns) + 2 * j] = qd[:, j]
        table[:, j, len(columns) + 2 * j + 1] = np.tanh(qd[:, j] / SOFTNESS)
    return table


def unabsorbed(arm, trace, torque, noise):
    """Root mean square by joint of what is left of a torque when rigid-body parameters, viscous and Coulomb friction of all
    joints are fitted to it together, with weights 1/noise. Offsets and rotor inertia are not fitted, as in `trials/src/cases`."""
    rows = slice(None, None, STRIDE)
    table = regressor(arm, trace.q[rows], trace.qd[rows], trace.qdd[rows]) / noise[:, None]
    flat = table.reshape(-1, table.shape[2])
    flat = flat / np.maximum(np.linalg.norm(flat, axis=0), 1e-9)
    target = (torque[rows] / noise).reshape(-1)
    found = np.linalg.lstsq(flat, target, rcond=1e-6)[0]
    return rms((target - flat @ found).reshape(-1, arm.n)) * noise


class Sensors:
    """Encoder counts, velocity noise, torque noise as a part of the torque's deviation."""

    def __init__(self, arm, rng):
        self.count = 2 * np.pi / 2.0 ** rng.integers(17, 20, arm.n) * np.where(arm.slides, 0.1, 1.0)
        self.velocity = rng.uniform(0.0004, 0.0014, arm.n) * np.where(arm.slides, 0.2, 1.0)
        self.torque = np.exp(rng.uniform(*np.log((0.005, 0.02)), arm.n))

    def record(self, trace, rng):
        """q, qd, tau as recorded, and the noise in tau."""
        noise = rng.normal(size=trace.tau.shape) * self.torque * trace.tau.std(axis=0)
        q = np.round(trace.q / self.count) * self.count
        return q, trace.qd + rng.normal(size=q.shape) * self.velocity, trace.tau + noise, noise


@dataclass
class Session:
    """An arm with an effect, its motions, and what was really so on them."""

    arm: Arm
    effect: Effect
    size: float
    motions: dict
    traces: list
    joint: int  # on which the size counts
    share: float
    attempt: int
    rng: np.random.Generator

    def recordings(self):
        """Tables by file, and which rows are held out with what was recorded and its noise."""
        q, qd, tau, noise = Sensors(self.arm, self.rng).record(Trace.joined(self.traces), self.rng)
        rows = round(LENGTH * RATE)
        label = np.repeat(np.arange(TRAJECTORIES), rows)
        time = label * (LENGTH + PAUSE) + np.tile(np.arange(rows) / RATE, TRAJECTORIES)
        test = np.isin(label, HELD_OUT)
        parts = (("train.parquet", ~test), ("test.parquet", test))
        files = {f: table(label[at], time[at], q[at], qd[at], tau[at]) for f, at in parts}
        return files, test, q, tau, noise


def session(effect_class, seed, index):
    """The session of a case: the first draw that suits its effect (None: nothing is withheld)."""
    for attempt in range(ATTEMPTS):
        rng = np.random.default_rng([seed, index, attempt])
        robots = (effect_class or Effect).robots
        arm = Arm(robots[rng.integers(len(robots))], rng)
        drawn = draw(arm, effect_class or Effect, seed, index, attempt)
        if drawn is None:
            continue
        effect, size, motions, control = drawn
        traces = simulate(arm, effect, size, control, motions)
        if traces is None:
            continue
        joint, share = reference(effect, shares(arm, effect, [traces[i] for i in HELD_OUT]))
        if effect_class is None or SHARES[0] <= share <= SHARES[1]:
            return Session(arm, effect, size, motions, traces, joint, share, attempt, rng)
    sys.exit(f"No robot suited case {index} ({kind_of(effect_class)}) in {ATTEMPTS} draws.")


def make(seed, index):
    """A case: its robot's description, recorded tables by file, and truth."""
    effect_class = deal(seed, index)
    s = session(effect_class, seed, index)
    arm, effect, size, joint, attempt = s.arm, s.effect, s.size, s.joint, s.attempt
    files, test, q, tau, noise = s.recordings()
    held_out = [s.traces[i] for i in HELD_OUT]

    torque, held_out = effect_torque(arm, effect, held_out), Trace.joined(held_out)
    std, noise_rms, strength = tau[test].std(axis=0), rms(noise[test]), rms(torque)
    left = unabsorbed(arm, held_out, torque, noise_rms)
    effects = []
    if effect_class is not None:
        own = effect.joint is not None
        touched = [joint] if own else [j for j in range(arm.n) if strength[j] > 0.02 * std[j]]
        effects.append({
            "effect": effect.name,
            "mechanism": effect.mechanism,
            "scope": "joint" if own or effect_class in OUTSIDE else "global",
            "joints": [arm.names[j] for j in touched],
            "reference_joint": arm.names[joint],
            "level": size,
            "parameters": effect.parameters(size),
            "share": strength[joint] / std[joint],
            "share_after_reidentification": left[joint] / std[joint],
            "snr_after_reidentification": left[joint] / noise_rms[joint],
            "indistinguishable": list(effect.same_as),
        })  # fmt: skip
    truth = {
        "case": name(seed, index),
        "kind": kind_of(effect_class),
        "robot": arm.robot,
        "simulator": f"mujoco {mujoco.__version__}",
        "seed": [seed, index, attempt],
        "joints": arm.n,
        "effects": effects,
        "torque_std": std.tolist(),
        "effect_rms": strength.tolist(),
        "unabsorbed_rms": left.tolist(),
        "noise_rms": noise_rms.tolist(),
        "control_error_rms": rms(held_out.error).tolist(),
        "oracle": oracle(arm, q[test], tau[test], torque, effect.vibrates, noise[test]),
        "plant": {"Fc": arm.loss.tolist(), "Fv": arm.plain.dof_damping.tolist(), "mass_factors": list(arm.mass.values())},
    }
    return arm.xml, files, rounded(truth)


def table(label, time, q, qd, tau):
    """A recording as `docs/formats.md` has it."""
    columns = {"trajectory": label.astype(np.int64), "time": time}
    for key, values in (("q", q), ("qd", qd), ("tau", tau)):
        columns.update({f"{key}{j + 1}": values[:, j] for j in range(values.shape[1])})
    return pyarrow.table(columns)


def rounded(x):
    """A truth with figures of eight digits: more differ with the machine's linear algebra."""
    if isinstance(x, dict):
        return {k: rounded(v) for k, v in x.items()}
    if isinstance(x, (list, tuple)):
        return [rounded(v) for v in x]
    return float(f"{x:.8g}") if isinstance(x, float) else x


def write(path, save):
    """Has `save` write a file under a temporary name, then gives it its own."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent)
    os.close(handle)
    try:
        save(Path(temporary))
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


def main():
    kinds = ["none", "outside", *(e.name for slot in SINGLES for e in slot)]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, required=True, help="how many")
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--out", type=Path, required=True, help="folder that they are written into")
    parser.add_argument("--only", choices=kinds, help="the run's first cases of this kind alone")
    options = parser.parse_args()
    dealt = (i for i in itertools.count() if options.only in (None, kind_of(deal(options.seed, i))))
    for index in itertools.islice(dealt, options.cases):
        xml, files, truth = make(options.seed, index)
        case = options.out / "cases" / truth["case"]
        write(case / "robot.xml", lambda path: path.write_text(xml))
        for file, recording in files.items():
            write(case / file, lambda path: pyarrow.parquet.write_table(recording, path))
        write(options.out / "truth" / f"{truth['case']}.json", lambda path: path.write_text(json.dumps(truth, indent=2) + "\n"))
        print(truth["case"], truth["kind"], flush=True)


if __name__ == "__main__":
    main()
