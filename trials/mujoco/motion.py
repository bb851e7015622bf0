"""Sealed cases of motion by MuJoCo: python trials/mujoco/motion.py --cases 26 --seed 1 --out DIR; then `replay score DIR`.

The robots are those of `arm.py`, under MuJoCo's own position actuators, with its friction, its limits of force, its compensation of
gravity and its integrator. A case is a description with a drive file, commands and counted positions of two trajectories of
12 s to fit and two to measure on, and what was withheld. Case i depends on seed and i alone.

Writes cases/ID/{robot.xml,drive.toml,train.parquet,test.parquet} and truth/ID.json, in the fields of `proof/src/motion/case.rs`. The deal of
kinds is that of the project's own plant there: of thirteen cases three without an effect, one with two, one outside.
"""
import argparse
import json
import sys
from pathlib import Path

import mujoco
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from arm import Arm, dofs, inverse_dynamics, nominal_spec

STEP = 5e-4  # of the plant, s
LENGTH = 12.0  # of a trajectory, s
BEFORE = 2.0  # under the drive before it, s
SEEN = 0.1  # part of the departure from the commands that an effect changes at least
FARTHEST = 1.5  # from its command, rad (m)
STATED = 0.03  # deviation of a stated value, relative
INSEPARABLE = 0.95  # correlation beyond which two values cannot be told apart
SINGLES = (
    "servo_gain", "command_delay", "joint_delay", "effort_limit", "gravity_compensation", "friction_parameters", "stribeck_friction",
    "load_dependent_friction", "rotor_inertia", "encoder_offset", "payload", "base_tilt", "link_parameters", "joint_coupling",
)  # fmt: skip
OUTSIDE = ("detent", "cross_drag")


def kind(i):
    slot = i % 13
    if slot in (0, 5, 10):
        return "none"
    if slot in (3, 8):
        return "two" if slot == 3 else "outside"
    return SINGLES[(i // 13 * 8 + slot - sum(s < slot for s in (0, 3, 5, 8, 10))) % len(SINGLES)]


class Commands:
    """A sum of sines of different speeds, or moves with rests."""

    def __init__(self, arm, moves, rng):
        self.moves, n = moves, arm.n
        if moves:
            self.starts = np.cumsum(rng.uniform(0.8, 1.8, 20))
            self.goals = arm.middle + arm.half * rng.uniform(-0.6, 0.6, (21, n))
            self.time = 1.9 * np.abs(np.diff(self.goals, axis=0)).max(axis=1) / rng.uniform(0.8, 1.8, 20)
            self.starts += np.concatenate([[0], np.cumsum(self.time)[:-1]])
            return
        self.omega = 2 * np.pi * np.exp(rng.uniform(np.log(0.08), np.log(1.2), (6, n)))
        self.a = rng.uniform(0.2, 1.0, (6, n)) / self.omega**0.7
        self.phase = rng.uniform(0, 2 * np.pi, (6, n))
        speed = (self.a * self.omega).sum(axis=0)
        self.a *= np.minimum(np.where(arm.slides, 0.3, 2.5) / speed, 0.8 * arm.half / self.a.sum(axis=0))
        self.middle = arm.middle

    def at(self, t):
        if not self.moves:
            return self.middle + (self.a * np.sin(self.omega * t[:, None, None] + self.phase)).sum(axis=1)
        q = np.tile(self.goals[0], (len(t), 1))
        for start, lasts, way in zip(self.starts, self.time, np.diff(self.goals, axis=0)):
            u = np.clip((t - start) / lasts, 0, 1)[:, None]
            q += way * u**3 * (10 - 15 * u + 6 * u**2)
        return q


class Real:
    """What really moves: a compiled model with position actuators, and what MuJoCo has no attribute for."""

    def __init__(self, arm, kp, kd, limit):
        spec = nominal_spec(arm.robot)
        for joint in spec.joints:
            joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
            joint.solref_friction = [2 * STEP, 1.0]
            joint.solimp_friction = [0.99, 0.99, 0.001, 0.5, 2.0]
        # MuJoCo compensates gravity where a body asked for it when the model was compiled.
        for body in spec.bodies[1:]:
            body.gravcomp = 1e-9
        # A motor that another joint turns, too, pulls a tendon over both; without a ratio its own joint alone.
        for driven, name in enumerate(arm.names):
            for driver in (driven - 1, driven + 1):
                if 0 <= driver < arm.n:
                    tendon = spec.add_tendon(name=f"{driven} {driver}")
                    tendon.wrap_joint(name, 1.0)
                    tendon.wrap_joint(arm.names[driver], 0.0)
        spec.option.timestep = STEP
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        self.model = spec.compile()
        self.names, self.at, self.n = arm.names, dofs(self.model, arm.names), arm.n
        self.bodies = [self.model.body(b).id for b in arm.bodies]
        # What is fixed to a link moves with it: the description's link is both.
        self.links = [np.flatnonzero(self.model.body_weldid == b) for b in self.bodies]
        m = self.model
        m.actuator_gaintype[:] = mujoco.mjtGain.mjGAIN_FIXED
        m.actuator_biastype[:] = mujoco.mjtBias.mjBIAS_AFFINE
        m.actuator_gainprm[:, 0], m.actuator_biasprm[:, 1], m.actuator_biasprm[:, 2] = kp, -kp, -kd
        m.actuator_forcelimited[:], m.actuator_ctrllimited[:] = 1, 0
        m.actuator_forcerange[:] = np.column_stack([-limit, limit])
        self.late, self.zero = np.zeros(self.n), np.zeros(self.n)
        self.turns = np.eye(self.n)  # motors by joints
        self.more = np.zeros(self.n)  # dry friction beside that of an effect which sets it at every step
        self.acts = []

    def set(self, joint, kp):
        self.model.actuator_gainprm[joint, 0] = kp
        self.model.actuator_biasprm[joint, 1] = -kp

    def couple(self, driven, driver, ratio):
        m = self.model
        tendon = m.tendon(f"{driven} {driver}").id
        m.wrap_prm[m.tendon_adr[tendon] + 1] = self.turns[driven, driver] = ratio
        m.actuator_trntype[driven], m.actuator_trnid[driven] = mujoco.mjtTrn.mjTRN_TENDON, [tendon, -1]

    def run(self, commands, period):
        """Commands and positions at the stamps, or None where it does not follow."""
        m, n = self.model, self.n
        mujoco.mj_setConst(m, mujoco.MjData(m))
        d = mujoco.MjData(m)
        every, rows, before = round(period / STEP), round(LENGTH / period), round(BEFORE / period)
        sent = commands.at((np.arange(before + rows) - before) * period)
        now = np.arange((before + rows) * every) * STEP
        # Rows of the commands that have arrived, joint by joint.
        row = np.clip(np.floor((now[:, None] - self.late) / period + 1e-9).astype(int), 0, before + rows - 1)
        ctrl = sent[row, np.arange(n)] - self.zero
        q_ref = sent[before:]
        q = np.empty_like(q_ref)
        d.qpos[self.at] = np.linalg.solve(self.turns, ctrl[0])
        for k in range(len(now)):
            if k % every == 0 and k >= before * every:
                q[k // every - before] = self.turns @ d.qpos[self.at] + self.zero
            d.ctrl[:] = ctrl[k]
            d.qfrc_applied[:] = 0
            for act in self.acts:
                act(m, d, self.at)
            mujoco.mj_step(m, d)
        if not np.isfinite(q).all() or abs(q - q_ref).max() > FARTHEST:
            return None
        return q_ref, q


def shape(name, arm, kp, torque, tolerance, period, rng):
    """An effect: joint or None, and a function that puts it into a robot in a size and returns its parameters."""
    j, n = int(rng.integers(arm.n)), arm.n
    side, usual = rng.choice([-1, 1]), rng.uniform(0.7, 1.4)
    inertia = arm.typical_inertia[j]
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    angle, order, reach = rng.uniform(0, 2 * np.pi), rng.uniform(8, 24), rng.uniform(0.03, 0.12)
    v_s, other = rng.uniform(0.1, 0.25), int(rng.choice([k for k in range(n) if k != j]))
    viscous = rng.random() < 0.5
    beside = j + 1 if j == 0 or (j + 1 < n and viscous) else j - 1

    def gain(r, s):
        # Beyond what the stated tolerance makes of it.
        r.set(j, kp[j] * np.exp(side * (0.45 * usual * s + 2.5 * tolerance)))
        return {"kp": r.model.actuator_gainprm[j, 0]}

    def delay(r, s):
        r.late += max(0.6 * period, 0.012) * usual * s
        return {"delay": r.late[0]}

    def own_delay(r, s):
        r.late[j] += max(period, 0.02) * usual * s
        return {"delay": r.late[j]}

    def limit(r, s):
        value = torque[j] * max(0.75 - 0.2 * usual * s, 0.1)
        r.model.actuator_forcerange[j] = [-value, value]
        return {"limit": value}

    def compensation(r, s):
        r.model.body_gravcomp[1:] = 0.7 * usual * min(s, 1.5)
        return {"gain": r.model.body_gravcomp[r.bodies[-1]]}

    def friction(r, s):
        dof = r.at[j]
        r.model.dof_frictionloss[dof] += 0.12 * torque[j] * usual * s
        if viscous:
            r.model.dof_damping[dof] *= 1 + usual * s
        return {"viscous": r.model.dof_damping[dof], "coulomb": r.model.dof_frictionloss[dof]}

    def stribeck(r, s):
        size, loss = 0.2 * torque[j] * usual * s, r.model.dof_frictionloss[r.at[j]]

        def act(m, d, at):
            m.dof_frictionloss[at[j]] = loss + r.more[j] + size / (1 + (d.qvel[at[j]] / v_s) ** 2)

        r.acts.append(act)
        return {"stribeck": size}

    def load(r, s):
        part, loss = min(0.2 * usual * s, 0.45), r.model.dof_frictionloss[r.at[j]]

        def act(m, d, at):
            m.dof_frictionloss[at[j]] = loss + r.more[j] + part * abs(d.qfrc_actuator[at[j]])

        r.acts.append(act)
        return {"load": part}

    def rotor(r, s):
        r.model.dof_armature[r.at[j]] += 0.8 * inertia * usual * s
        return {"inertia": r.model.dof_armature[r.at[j]]}

    def zero(r, s):
        r.zero[j] += side * 0.05 * usual * s
        return {"zero": -r.zero[j]}

    def payload(r, s):
        m, b = r.model, r.bodies[-1]
        mass = 0.08 * m.body_mass.sum() * usual * s
        was = m.body_mass[b]
        place = m.body_ipos[b] + reach * direction
        m.body_ipos[b] = (was * m.body_ipos[b] + mass * place) / (was + mass)
        m.body_mass[b] = was + mass
        m.body_inertia[b] += mass * 0.0016 + mass * was / (mass + was) * reach**2
        return {"mass": mass, **dict(zip(("com_x", "com_y", "com_z"), place))}

    def tilt(r, s):
        turn = np.array([np.cos(angle), np.sin(angle), 0]) * 0.06 * usual * s
        matrix = np.zeros(9)
        quat = np.zeros(4)
        size = np.linalg.norm(turn)
        mujoco.mju_axisAngle2Quat(quat, turn / size, size)
        mujoco.mju_quat2Mat(matrix, quat)
        r.model.opt.gravity[:] = matrix.reshape(3, 3) @ r.model.opt.gravity
        return {"tilt_x": -turn[0], "tilt_y": -turn[1]}

    def link(r, s):
        factor = np.exp(side * 0.35 * usual * s)
        r.model.body_mass[r.links[j]] *= factor
        r.model.body_inertia[r.links[j]] *= factor
        return {"mass_factor": factor}

    def coupling(r, s):
        ratio = side * 0.25 * usual * s
        r.couple(j, beside, ratio)
        return {"ratio": ratio}

    def detent(r, s):
        size = 0.25 * torque[j] * usual * s

        def act(m, d, at):
            d.qfrc_applied[at[j]] -= size * np.sin(order * d.qpos[at[j]] + angle)

        r.acts.append(act)
        return {}

    def cross_drag(r, s):
        size, loss = 0.3 * torque[j] * usual * s, r.model.dof_frictionloss[r.at[j]]

        def act(m, d, at):
            m.dof_frictionloss[at[j]] = loss + r.more[j] + size * d.qvel[at[other]] ** 2

        r.acts.append(act)
        return {}

    change = {
        "servo_gain": gain, "command_delay": delay, "joint_delay": own_delay, "effort_limit": limit, "gravity_compensation": compensation,
        "friction_parameters": friction, "stribeck_friction": stribeck, "load_dependent_friction": load, "rotor_inertia": rotor,
        "encoder_offset": zero, "joint_coupling": coupling, "payload": payload, "base_tilt": tilt, "link_parameters": link, "detent": detent, "cross_drag": cross_drag,
    }[name]  # fmt: skip
    whole = name in ("command_delay", "gravity_compensation", "payload", "base_tilt")
    return None if whole else j, beside if name == "joint_coupling" else None, change


def vary(name, real, j, change):
    """Adds a change to one value of a robot."""
    m, dof = real.model, real.at[j]
    if name == "kp":
        real.set(j, m.actuator_gainprm[j, 0] + change)
    elif name == "viscous":
        m.dof_damping[dof] += change
    elif name == "coulomb":
        m.dof_frictionloss[dof] += change
        real.more[j] += change
    elif name == "inertia":
        m.dof_armature[dof] += change
    elif name == "mass_factor":
        # The change is that of the factor on the description's masses, here a thousandth of it up or down.
        m.body_mass[real.links[j]] *= 1 + np.copysign(1e-3, change)
        m.body_inertia[real.links[j]] *= 1 + np.copysign(1e-3, change)
    elif name == "zero":
        real.zero[j] -= change
    else:
        real.late[j if j is not None else slice(None)] += change


def information(build, names, runs, commands, period, kd, tolerance, withheld, sigma):
    """What the motion to fit shows of the true values: differences of MuJoCo's own roll-outs, as `proof/src/motion/shown.rs` has them.

    `build` makes the real robot, `runs` are its motions. None where a robot with a value varied does not follow its commands.
    """
    known = {(p["name"], p["joint"]): p["value"] for w in withheld for p in w["parameters"]}
    real, gain, late = build(), np.hypot(tolerance, STATED), max(2 * period, 0.02)
    m, values = real.model, []  # name, joint, value, prior, change
    for j, name in enumerate(names):
        dof = real.at[j]
        for what, value, stated in (
            ("kp", m.actuator_gainprm[j, 0], gain),
            # Without commanded velocities the motion shows the sum of the joint's damping and the drive's.
            ("viscous", m.dof_damping[dof] + kd[j], gain),
            ("coulomb", m.dof_frictionloss[dof], STATED),
            ("inertia", m.dof_armature[dof], STATED),
        ):
            if value > 0:
                values.append((what, j, value, value * (1 if (what, name) in known else stated), 1e-3 * value))
        factor = known.get(("mass_factor", name), 1)
        values.append(("mass_factor", j, factor, factor if ("mass_factor", name) in known else STATED, 1e-3 * factor))
        if ("zero", name) in known:
            values.append(("zero", j, -real.zero[j], 0.05, 1e-4))
        if ("delay", name) in known:
            values.append(("delay", j, real.late[j], late, 2 * STEP))
    values.append(("delay", None, real.late.min(), late if ("delay", None) in known else 1e-3, 2 * STEP))
    columns = []
    for what, j, _, prior, change in values:
        sides = []
        # A delay can hardly be less.
        for by in (change, 0 if what == "delay" else -change):
            other = build()
            vary(what, other, j, by)
            sides.append([other.run(c, period) for c in commands] if by else runs)
        if any(o is None for side in sides for o in side):
            return None
        span = change if what == "delay" else 2 * change
        columns.append(np.concatenate([((a[1] - b[1]) / span * prior / sigma).ravel() for a, b in zip(*sides)]))
    changes = np.array(columns)
    covariance = np.linalg.inv(changes @ changes.T + np.eye(len(values)))
    deviation = np.sqrt(np.diag(covariance))
    correlated = abs(covariance / np.outer(deviation, deviation)) > INSEPARABLE
    return {
        "values": [
            {"name": what, "joint": None if j is None else names[j], "value": float(value), "prior": float(prior), "deviation": float(prior * d)}
            for (what, j, value, prior, _), d in zip(values, deviation)
        ],
        "inseparable": [[int(i), int(k)] for i, k in zip(*np.nonzero(np.triu(correlated, 1)))],
    }


def attempt(case, rng):
    """A case's files, or None where this robot does not show what is asked for."""
    arm = Arm(str(rng.choice(["scara", "six_axis", "seven_axis"])), rng)
    omega = 2 * np.pi * np.exp(rng.uniform(np.log(1.5), np.log(5.0), arm.n))
    kp = arm.typical_inertia * omega**2
    kd = 2 * rng.uniform(0.5, 1.2) * arm.typical_inertia * omega
    period = float(rng.choice([0.02, 0.01, 0.005, 0.002]))
    all_commands = [Commands(arm, k % 2 == 1, rng) for k in range(4)]
    torque = np.zeros(arm.n)
    for commands in all_commands[:2]:
        q = commands.at(np.arange(0, LENGTH, 0.02))
        qd = np.gradient(q, 0.02, axis=0)
        tau = inverse_dynamics(arm.nominal, q, qd, np.gradient(qd, 0.02, axis=0)) + arm.nominal.dof_frictionloss * np.sign(qd)
        torque = np.maximum(torque, abs(tau).max(axis=0))
    limit = 3 * torque
    tolerance = float(rng.choice([0.0, 0.1, 0.3]))
    true_kp, true_kd = (g * np.exp(tolerance * np.clip(rng.normal(size=arm.n), -2, 2)) for g in (kp, kd))
    names = {"none": (), "two": rng.choice(SINGLES, 2, replace=False), "outside": (rng.choice(OUTSIDE),)}.get(case, (case,))
    shapes = [(str(n), *shape(str(n), arm, kp, torque, tolerance, period, rng)) for n in names]
    sizes, withheld = [], []
    base = [Real(arm, true_kp, true_kd, limit).run(c, period) for c in all_commands[:2]]
    if any(b is None for b in base):
        return None
    for name, joint, _, change in shapes:
        for size in (1.0, 1.6, 2.5):
            real = Real(arm, true_kp, true_kd, limit)
            change(real, size)
            with_it = [real.run(c, period) for c in all_commands[:2]]
            if any(w is None for w in with_it):
                return None
            moved = sum(((a[1] - b[1]) ** 2).sum(axis=0) for a, b in zip(base, with_it))
            part = np.sqrt(moved / sum(((a[1] - a[0]) ** 2).sum(axis=0) for a in base))
            if (part.max() if joint is None else part[joint]) >= SEEN:
                break
        else:
            return None
        sizes.append(size)
    real = Real(arm, true_kp, true_kd, limit)
    for (name, joint, driver, change), size in zip(shapes, sizes):
        values, own = change(real, size), None if joint is None else arm.names[joint]
        parameters = [{"name": k, "joint": own, "value": float(v)} for k, v in values.items()]
        effect = "command_delay" if name == "joint_delay" else name
        withheld.append({"effect": effect, "joint": own, "parameters": parameters})
        if driver is not None:
            withheld[-1]["driver"] = arm.names[driver]
    runs = [real.run(c, period) for c in all_commands]
    if any(r is None for r in runs):
        return None
    count = 2 * np.pi / 2 ** int(rng.integers(12, 18))
    noise, jitter = count * rng.uniform(0.1, 0.5), period * rng.uniform(0, 0.05)
    tables = []
    for pair in (runs[:2], runs[2:]):
        rows = len(pair[0][0])
        time = np.concatenate([k * (LENGTH + 2) + np.arange(rows) * period + jitter * rng.uniform(size=rows) for k in range(2)])
        q_ref, q = (np.concatenate([r[i] for r in pair]) for i in range(2))
        q = np.round((q + noise * rng.normal(size=q.shape)) / count) * count
        columns = {"time": time, "trajectory": np.repeat(["1", "2"], rows)}
        columns |= {f"q{j + 1}": q[:, j] for j in range(arm.n)} | {f"q_ref{j + 1}": q_ref[:, j] for j in range(arm.n)}
        tables.append(pa.table(columns))
    drives = []
    for j, name in enumerate(arm.names):
        drives.append({"name": "kp", "joint": name, "value": float(real.model.actuator_gainprm[j, 0])})
        drives.append({"name": "delay", "joint": name, "value": float(real.late[j])})
    listed = ["[" + ", ".join(f"{v:.6e}" for v in row) + "]" for row in (kp, kd, limit)]
    drive = (
        f'[controller]\nkind = "pd"\nkp = {listed[0]}\nkd = {listed[1]}\nlimit = {listed[2]}\n'
        f"tolerance = {{ kp = {tolerance}, kd = {tolerance} }}\n"
        f'period = {period}\ninterpolation = "hold"\ngravity_compensation = false\n'
    )
    truth = {
        "kind": case, "simulator": "mujoco", "withheld": [] if case == "outside" else withheld, "drives": drives,
        "tolerance": tolerance, "period": period,
    }  # fmt: skip

    def build():
        again = Real(arm, true_kp, true_kd, limit)
        for (_, _, _, change), size in zip(shapes, sizes):
            change(again, size)
        return again

    shown = information(build, arm.names, runs[:2], all_commands[:2], period, true_kd, tolerance, truth["withheld"], np.hypot(noise, count / 12**0.5))
    if shown is not None:
        truth["information"] = shown
    return arm.xml, drive, tables, truth


def make(i, seed, out):
    rng = np.random.default_rng([seed, i])
    for _ in range(60):
        made = attempt(kind(i), rng)
        if made:
            break
    else:
        print(f"case {i} is left out: of 60 robots none shows {kind(i)}", file=sys.stderr)
        return
    xml, drive, tables, truth = made
    name = f"mujoco-{i:04d}"
    folder = out / "cases" / name
    folder.mkdir(parents=True, exist_ok=True)
    (out / "truth").mkdir(exist_ok=True)
    (folder / "robot.xml").write_text(xml, encoding="utf-8")
    (folder / "drive.toml").write_text(drive, encoding="utf-8")
    for file, table in zip(("train", "test"), tables):
        pq.write_table(table, folder / f"{file}.parquet")
    (out / "truth" / f"{name}.json").write_text(json.dumps(truth, indent=1), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", type=int, default=26)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    for i in range(options.cases):
        make(i, options.seed, options.out)
        print(f"{i + 1} of {options.cases}: {kind(i)}", flush=True)


if __name__ == "__main__":
    main()
