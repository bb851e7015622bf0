"""Arms in MuJoCo: their nominal models, motions, closed-loop simulation, and the torque of a model on a given motion.

SI units (rad, rad/s, N m, kg; m, m/s, N of a sliding joint). Tables have a row per sample and a column per joint.

The plant's integrator is implicitfast with steps of 0.5 ms, its friction MuJoCo's own constraint `frictionloss`.
`solreffriction` is set to twice the step, the stiffest that MuJoCo takes: the constraint then asks for standstill at the
end of the step, so its torque has the sign of the velocity one step ahead (MuJoCo's default asks for it within some 10 ms, and
friction turns round that early). `solimpfriction` is 0.99: the full torque is there from speeds below 1e-3 rad/s on.
Source: "Solver parameters" in MuJoCo's documentation,
https://mujoco.readthedocs.io/en/stable/modeling.html#solver-parameters
"""
from dataclasses import dataclass, fields
from pathlib import Path

import mujoco
import numpy as np

FIXTURES = Path(__file__).resolve().parents[2] / "physics" / "tests" / "fixtures" / "mjcf"
# Of the drives, joint by joint: rotor inertia (kg m2), viscous (N m s/rad) and Coulomb friction (N m). The fixtures lack some.
DRIVES = {
    "scara": {"armature": (0.8, 0.2, 3.0, 0.004), "damping": (1.5, 0.6, 30.0, 0.012), "frictionloss": (2.0, 0.8, 4.0, 0.01)},
    "six_axis": {
        "armature": (0.7, 0.7, 0.4, 0.1, 0.1, 0.1),
        "damping": (4.0, 5.0, 3.0, 0.5, 0.5, 0.4),
        "frictionloss": (3.5, 5.0, 2.5, 0.5, 0.45, 0.35),
    },
    "seven_axis": {
        "armature": (0.4, 0.4, 0.3, 0.3, 0.1, 0.1, 0.06),
        "damping": (1.0, 1.0, 1.0, 1.0, 0.3, 0.3, 0.2),
        "frictionloss": (1.5, 2.0, 1.2, 1.2, 0.4, 0.4, 0.25),
    },
}
RATE = 250.0  # of the recordings, Hz
LENGTH = 15.0  # of a trajectory, s
PAUSE = 2.0  # between trajectories, s
SETTLE = 1.0  # at rest before a trajectory is recorded, s
VIBRATION = 20.0  # torque of effects that vibrate counts up to here, Hz
GRAVITY = 9.81


def nominal_spec(robot):
    """The description of a robot that a diagnosis is given: the fixture's bodies, the drives above, a motor on each joint."""
    spec = mujoco.MjSpec.from_file(str(FIXTURES / f"{robot}.xml"))
    for group in (spec.actuators, spec.equalities, spec.tendons, spec.keys):
        for one in list(group):
            spec.delete(one)
    # Fingers stay where they are.
    joints = [j for j in spec.joints if not j.name.startswith("finger")]
    for finger in [j for j in spec.joints if j.name.startswith("finger")]:
        spec.delete(finger)
    for i, joint in enumerate(joints):
        joint.armature = DRIVES[robot]["armature"][i]
        joint.damping = [DRIVES[robot]["damping"][i], 0, 0]
        joint.frictionloss = DRIVES[robot]["frictionloss"][i]
        motor = spec.add_actuator(name=joint.name, target=joint.name)
        motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
        motor.set_to_motor()
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    return spec


class Arm:
    """Nominal description of a robot, its region, and how its true parameters differ from it."""

    def __init__(self, robot, rng):
        self.robot = robot
        spec = nominal_spec(robot)
        self.nominal = spec.compile()
        self.xml = spec.to_xml()
        self.names = [j.name for j in spec.joints]
        self.bodies = [j.parent.name for j in spec.joints]
        self.n = n = len(self.names)
        self.slides = self.nominal.jnt_type == mujoco.mjtJoint.mjJNT_SLIDE
        limits = np.where(self.nominal.jnt_limited[:, None].astype(bool), self.nominal.jnt_range, [-2.5, 2.5])
        middle, half = limits.mean(axis=1), 0.45 * np.ptp(limits, axis=1)
        self.middle, self.half = middle, np.minimum(half, 2.4)
        # Bodies: mass, place of the centre of mass, inertia; joints: damping, frictionloss.
        self.mass = {b: 1 + rng.uniform(-0.03, 0.03) for b in self.bodies}
        self.shift = {b: rng.uniform(-0.017, 0.017, 3) for b in self.bodies}
        self.inertia = {b: 1 + rng.uniform(-0.03, 0.03) for b in self.bodies}
        self.friction = 1 + rng.uniform(-0.1, 0.1, (2, n))
        self.plain = self.true(nominal_spec(robot))
        self.loss = self.plain.dof_frictionloss.copy()
        self.typical_inertia = np.diag(mass_matrix(self.nominal, middle)).copy()

    def demand(self, motion):
        """Torque of the plain plant on a motion as commanded, at 50 Hz."""
        q, qd, qdd = motion.at(np.arange(0, LENGTH, 0.02))
        return inverse_dynamics(self.plain, q, qd, qdd) + self.loss * np.sign(qd)

    def true(self, spec, step=1e-3):
        """Compiles a description with the true parameters, without limits and contacts, with stiff friction."""
        for joint in spec.joints:
            if joint.name in self.names:
                joint.limited = mujoco.mjtLimited.mjLIMITED_FALSE
                joint.solref_friction = [2 * step, 1.0]
                joint.solimp_friction = [0.99, 0.99, 0.001, 0.5, 2.0]
        for actuator in list(spec.actuators):
            spec.delete(actuator)
        spec.option.timestep = step
        spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        model = spec.compile()
        for body in self.bodies:
            b = model.body(body).id
            model.body_mass[b] *= self.mass[body]
            model.body_ipos[b] += self.shift[body] * np.linalg.norm(model.body_ipos[b])
            model.body_inertia[b] *= self.inertia[body]
        at = dofs(model, self.names)
        model.dof_damping[at] *= self.friction[0]
        model.dof_frictionloss[at] *= self.friction[1]
        mujoco.mj_setConst(model, mujoco.MjData(model))
        return model


def dofs(model, names):
    """Places of the named joints among a model's degrees of freedom."""
    return np.array([model.jnt_dofadr[model.joint(name).id] for name in names])


def mass_matrix(model, q):
    """Mass matrix with rotors."""
    data = mujoco.MjData(model)
    data.qpos[:] = q
    mujoco.mj_forward(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full


def inverse_dynamics(model, q, qd, qdd):
    """Torque of rigid bodies, rotors and viscous friction on a motion by `mj_inverse`; Coulomb friction is left out."""
    flags = model.opt.disableflags
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data = mujoco.MjData(model)
    tau = np.empty_like(q)
    for k in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], qd[k], qdd[k]
        mujoco.mj_inverse(model, data)
        tau[k] = data.qfrc_inverse
    model.opt.disableflags = flags
    return tau


class Motion:
    """A Fourier series of five harmonics per joint that swells from rest and goes back to it, within the robot's region."""

    EASE = 1.0  # Time in which it swells and goes, s.

    def __init__(self, arm, rng, pace=1.0):
        self.omega = 2 * np.pi * pace * rng.uniform(0.1, 0.25) * np.arange(1, 6)
        # Amplitudes such that all harmonics have about the same speed.
        self.a, self.b = rng.normal(size=(2, 5, arm.n)) / self.omega[:, None]
        self.centre = np.zeros(arm.n)
        self.scale = np.ones(arm.n)
        q, qd, _ = self.at(np.arange(0, LENGTH, 0.01))
        speed = rng.uniform(0.8, 1.5, arm.n) * np.where(arm.slides, 0.2, 1.0)
        low, high = q.min(axis=0), q.max(axis=0)
        self.scale = np.minimum(speed / abs(qd).max(axis=0), 1.6 * arm.half / (high - low))
        low, high = low * self.scale, high * self.scale
        self.centre = arm.middle + rng.uniform(-arm.half - low, arm.half - high)

    def at(self, t):
        """q, qd, qdd at times t (s); before 0 and after the end at rest."""
        phase = np.clip(np.minimum(t, LENGTH - t) / self.EASE, 0, 1)
        sense = np.where(t < LENGTH / 2, 1, -1) / self.EASE
        w = (phase**3 * (10 - 15 * phase + 6 * phase**2))[:, None]
        wd = (30 * phase**2 * (1 - phase) ** 2 * sense)[:, None]
        wdd = (60 * phase * (1 - phase) * (1 - 2 * phase) * sense**2)[:, None]
        sin, cos = np.sin(np.outer(t, self.omega)), np.cos(np.outer(t, self.omega))
        s = sin @ self.a + cos @ self.b
        sd = (cos * self.omega) @ self.a - (sin * self.omega) @ self.b
        sdd = -(sin * self.omega**2) @ self.a - (cos * self.omega**2) @ self.b
        q = self.centre + self.scale * w * s
        return q, self.scale * (wd * s + w * sd), self.scale * (wdd * s + 2 * wd * sd + w * sdd)


@dataclass
class Trace:
    """What was really so at each step of a trajectory, and the torque as its channel gives it."""

    q: np.ndarray  # as the encoders count it
    qd: np.ndarray
    qdd: np.ndarray  # (qd of the next step - qd) / step, the acceleration that the integrator takes
    sign: np.ndarray  # torque of dry friction over its largest, -1..1
    tau: np.ndarray  # of the channel, without noise
    error: np.ndarray  # of the control

    def sampled(self):
        """The trace at the recordings' rate."""
        every = round(len(self.q) / (LENGTH * RATE))
        return Trace(*(getattr(self, f.name)[::every] for f in fields(self)))

    @staticmethod
    def joined(traces):
        """Trajectories one after another, at the recordings' rate."""
        sampled = [t.sampled() for t in traces]
        return Trace(*(np.concatenate([getattr(t, f.name) for t in sampled]) for f in fields(Trace)))


class Control:
    """PD by joint, its velocity through a low-pass, and the nominal model's inverse dynamics of the reference, at every step."""

    CORNER = 60.0  # of the velocity's low-pass, Hz

    def __init__(self, arm, rng):
        omega = 2 * np.pi * rng.uniform(6, 9)
        self.kp, self.kd = arm.typical_inertia * omega**2, 1.6 * arm.typical_inertia * omega
        self.arm = arm
        self.known = {}

    def reference(self, index, motion, t):
        """q, qd and feedforward torque at times t (s). The torque is worked out at the recording's rate, once."""
        if index not in self.known:
            grid = np.arange(-SETTLE, LENGTH + 1 / RATE, 1 / RATE)
            q, qd, qdd = motion.at(grid)
            nominal = self.arm.nominal
            tau = inverse_dynamics(nominal, q, qd, qdd) + nominal.dof_frictionloss * np.tanh(qd / 0.05)
            self.known[index] = grid, tau
        grid, tau = self.known[index]
        q, qd, _ = motion.at(t)
        return q, qd, np.column_stack([np.interp(t, grid, column) for column in tau.T])


def simulate(arm, effect, size, control, motions):
    """Runs an arm with an effect in a size over some of the session's motions, a dict of them by their place in it.

    Returns a trace for each, or None if the arm does not follow.
    """
    spec = nominal_spec(arm.robot)
    effect.build(spec, arm, size)
    model = arm.true(spec, effect.step)
    data = mujoco.MjData(model)
    at = dofs(model, arm.names)
    step = effect.step
    zero = effect.zero(arm, size)
    traces = []
    for index, motion in motions.items():
        t = np.arange(round(-SETTLE / step), round(LENGTH / step) + 1) * step
        begun = index * (LENGTH + PAUSE)
        q_ref, qd_ref, feedforward = control.reference(index, motion, t)
        q, qd, sign, tau = (np.empty_like(q_ref) for _ in range(4))
        mujoco.mj_resetData(model, data)
        data.qpos[at] = q_ref[0] - zero
        kp, kd, part, speed = control.kp, control.kd, 1 - np.exp(-2 * np.pi * control.CORNER * step), np.zeros(arm.n)
        for k in range(len(t)):
            q[k], qd[k] = data.qpos[at], data.qvel[at]
            speed += part * (qd[k] - speed)
            tau[k] = feedforward[k] + kp * (q_ref[k] - q[k] - zero) + kd * (qd_ref[k] - speed)
            data.qfrc_applied[at] = tau[k]
            effect.act(model, data, at, begun + t[k], size)
            mujoco.mj_step(model, data)
            sign[k] = -data.qfrc_constraint[at] / model.dof_frictionloss[at]
        error = q + zero - q_ref
        if not np.isfinite(q).all() or (abs(error) > 0.25 * arm.half).any():
            return None
        qdd = np.diff(qd, axis=0, append=qd[-1:]) / step
        rows = slice(round(SETTLE / step), len(t) - 1)
        traces.append(Trace(*(x[rows] for x in (q + zero, qd, qdd, sign, effect.channel(t, tau, size), error))))
    return traces


def low_pass(x, cutoff, rate=RATE):
    """Each trajectory of a table by a zero-phase filter with the gain of a fourth-order Butterworth there and back."""
    rows, pad = round(LENGTH * rate), round(rate)
    out = np.empty_like(x)
    for k in range(0, len(x), rows):
        y = x[k : k + rows]
        y = np.concatenate([2 * y[0] - y[pad:0:-1], y, 2 * y[-1] - y[-2 : -pad - 2 : -1]])
        gain = 1 / (1 + (np.fft.rfftfreq(len(y), 1 / rate) / cutoff) ** 8)
        out[k : k + rows] = np.fft.irfft(np.fft.rfft(y, axis=0) * gain[:, None], len(y), axis=0)[pad : pad + rows]
    return out


def beyond(arm, trace):
    """What a channel's torque has beyond the plain plant on the true motion."""
    return trace.tau - inverse_dynamics(arm.plain, trace.q, trace.qd, trace.qdd) - arm.loss * trace.sign


def effect_torque(arm, effect, traces):
    """Torque of the effect at the recordings' rate, trajectories one after another: all that is beyond the plain plant.

    Of an effect that vibrates it counts below `VIBRATION`, filtered before it is sampled: above, it is the difference of two
    large torques, those of blows on the rotor.
    """
    if not effect.vibrates:
        return beyond(arm, Trace.joined(traces))
    every = round(1 / (RATE * effect.step))
    return np.concatenate([low_pass(beyond(arm, t), VIBRATION, 1 / effect.step)[::every] for t in traces])
