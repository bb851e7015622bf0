"""What a case withholds: an effect that the plant or its channels have and the nominal model has not.

Each class says what it is, in which unit its size is, between which bounds the size is sought, and does one or more of:
change the description (`build`), act at every step (`act`), shift the encoders' zero (`zero`), change the torque channel
(`channel`). Names are those of `docs/formats.md`, "Effects"; joints are named joint1 .. jointN, base first.
"""
import mujoco
import numpy as np

from arm import GRAVITY, LENGTH, PAUSE

TRAJECTORIES = 12


class Effect:
    """Nothing, and what all effects share: drawn with `rng` for an arm and the motions of a session."""

    name = "none"
    mechanism = "none"
    step = 5e-4  # of the simulation, s
    bounds = (0.0, 0.0)  # of the size
    shares = (0.06, 0.3)  # of the joint's torque that are sought
    pace = 1.0  # of the motions
    robots = ("scara", "six_axis", "seven_axis")
    vibrates = False  # its torque counts below 20 Hz only
    joint = None  # that it belongs to; None: the whole arm
    same_as = ()  # effects that no recording can tell from it

    def __init__(self, arm, motions, rng):
        """Draws what is not the size."""

    def build(self, spec, arm, size):
        """Changes the description before it is compiled."""

    def act(self, model, data, at, time, size):
        """Acts on the model or the forces of one step; `time` is the session's clock, `at` the joints' places."""

    def zero(self, arm, size):
        """What the encoders read beyond the true position."""
        return 0.0

    def channel(self, t, tau, size):
        """Torque as recorded, of torque `tau` of the motors at times `t`."""
        return tau

    def parameters(self, size):
        """Its parameters, for the truth."""
        return {}


class OnJoint(Effect):
    """An effect of one joint, any of them."""

    def __init__(self, arm, motions, rng):
        self.joint = int(rng.integers(arm.n))
        self.sign = float(rng.choice([-1.0, 1.0]))

    def of(self, spec, arm):
        """The joint in a description."""
        return spec.joint(arm.names[self.joint])


class OnLarge(OnJoint):
    """An effect of one of the joints that carry most of the arm."""

    def __init__(self, arm, motions, rng):
        super().__init__(arm, motions, rng)
        self.joint = int(rng.integers({"scara": 2, "six_axis": 3, "seven_axis": 4}[arm.robot]))


class Payload(Effect):
    """A body on the last link. Size: kg."""

    name, mechanism, bounds, same_as = "payload", "payload", (0.02, 5.0), ("link_parameters",)
    shares = (0.15, 0.33)

    def __init__(self, arm, motions, rng):
        self.place = rng.uniform(-0.03, 0.03, 3) + [0.0, 0.0, rng.uniform(0.0, 0.06)]
        self.gyration = rng.uniform(0.02, 0.06, 3)

    def build(self, spec, arm, size):
        body = spec.body(arm.bodies[-1]).add_body(name="payload", pos=self.place, mass=size, explicitinertial=True)
        a, b, c = size * self.gyration**2
        body.inertia = [b + c, a + c, a + b]

    def parameters(self, size):
        return {"mass": size, "com": self.place.tolist()}


class RotorInertia(OnJoint):
    """A larger rotor. Size: increase of the nominal armature, as a part of it."""

    name, mechanism, bounds = "rotor_inertia", "armature", (0.3, 2.5)

    def __init__(self, arm, motions, rng):
        super().__init__(arm, motions, rng)
        # The first link turns only about its joint: there both inertias are one.
        self.same_as = ("link_parameters",) if self.joint == 0 else ()

    def build(self, spec, arm, size):
        self.of(spec, arm).armature *= 1 + size

    def parameters(self, size):
        return {"factor": 1 + size}


class FrictionParameters(OnJoint):
    """More friction than the model has. Size: increase of the joint's friction, as a part of it."""

    name, mechanism, bounds = "friction_parameters", "friction_factor", (0.2, 1.5)

    def __init__(self, arm, motions, rng):
        super().__init__(arm, motions, rng)
        self.viscous = rng.uniform(0.4, 1.2)

    def build(self, spec, arm, size):
        joint = self.of(spec, arm)
        joint.frictionloss *= 1 + size
        joint.damping = joint.damping * (1 + self.viscous * size)

    def parameters(self, size):
        return {"coulomb_factor": 1 + size, "viscous_factor": 1 + self.viscous * size}


class BaseTilt(Effect):
    """Gravity that is not along the base's axis. Size: rad."""

    name, mechanism, bounds = "base_tilt", "base_tilt", (np.radians(1.5), np.radians(6.0))

    def __init__(self, arm, motions, rng):
        self.heading = rng.uniform(0, 2 * np.pi)

    def build(self, spec, arm, size):
        level = np.sin(size) * np.array([np.cos(self.heading), np.sin(self.heading)])
        spec.option.gravity = [*(GRAVITY * level), -GRAVITY * np.cos(size)]

    def parameters(self, size):
        return {"angle": size, "heading": self.heading}


class Counterbalance(OnJoint):
    """A coil spring between two pins beside the second joint. Size: N m, stiffness times both levers."""

    name, mechanism, bounds, robots = "counterbalance", "coil_spring", (1.0, 400.0), ("six_axis", "seven_axis")
    shares = (0.1, 0.3)

    def __init__(self, arm, motions, rng):
        super().__init__(arm, motions, rng)
        self.joint = 1
        self.angle = rng.uniform(-np.pi, np.pi)
        self.lever = rng.uniform(0.55, 0.85)
        self.free = rng.uniform(0.5, 0.9) * (1 - self.lever)

    def act(self, model, data, at, time, size):
        angle = data.qpos[at[1]] - self.angle
        length = np.sqrt(1 + self.lever**2 - 2 * self.lever * np.cos(angle))
        data.qfrc_applied[at[1]] -= size * np.sin(angle) * (1 - self.free / length)

    def parameters(self, size):
        return {"stiffness_levers": size, "angle": self.angle, "lever": self.lever, "free_length": self.free}


class StribeckFriction(OnJoint):
    """Dry friction that falls with speed: MuJoCo's, its loss larger by size / (1 + (qd/v)^2). Size: N m."""

    name, mechanism, bounds = "stribeck_friction", "stribeck_lorentz", (0.001, 20.0)

    def __init__(self, arm, motions, rng):
        super().__init__(arm, motions, rng)
        self.v_s = rng.uniform(0.08, 0.3) * (0.2 if arm.slides[self.joint] else 1.0)
        self.loss = arm.loss[self.joint]

    def act(self, model, data, at, time, size):
        j = at[self.joint]
        model.dof_frictionloss[j] = self.loss + size / (1 + (data.qvel[j] / self.v_s) ** 2)

    def parameters(self, size):
        return {"stribeck": size, "v_s": self.v_s}


class AsymmetricFriction(OnJoint):
    """Friction that is larger in one direction: losses and damping differ by the sign of qd. Size: relative difference."""

    name, mechanism, bounds, shares = "asymmetric_friction", "one_way_bearing", (0.1, 0.9), (0.06, 0.2)

    def __init__(self, arm, motions, rng):
        super().__init__(arm, motions, rng)
        self.loss, self.damping = arm.loss[self.joint], arm.plain.dof_damping[self.joint]
        self.dry = rng.uniform(0.0, 0.3)

    def act(self, model, data, at, time, size):
        j = at[self.joint]
        more = self.sign * size * np.sign(data.qvel[j])
        model.dof_frictionloss[j] = self.loss * (1 + self.dry * more)
        model.dof_damping[j] = self.damping * (1 + more)

    def parameters(self, size):
        return {"viscous": self.sign * size * self.damping, "coulomb": self.sign * size * self.dry * self.loss}


class LoadDependentFriction(OnJoint):
    """Dry friction larger by a part of what the gear transmits, |motor's torque - rotor's|. Size: that part."""

    name, mechanism, bounds, robots = "load_dependent_friction", "gear_mesh", (0.02, 0.45), ("six_axis", "seven_axis")

    def __init__(self, arm, motions, rng):
        super().__init__(arm, motions, rng)
        self.joint = int(rng.choice([1, 2] if arm.robot == "six_axis" else [1, 3]))
        self.loss = arm.loss[self.joint]

    def act(self, model, data, at, time, size):
        j = at[self.joint]
        load = data.qfrc_applied[j] + data.qfrc_constraint[j] + data.qfrc_passive[j] - model.dof_armature[j] * data.qacc[j]
        model.dof_frictionloss[j] = self.loss + size * abs(load)

    def parameters(self, size):
        return {"loss": size}


class NonlinearViscousFriction(OnJoint):
    """Oil that shears thinner: a torque size * asinh(qd/v) more, by the joint's damping. Size: N m."""

    name, mechanism, bounds = "nonlinear_viscous_friction", "eyring_flow", (0.001, 20.0)

    def __init__(self, arm, motions, rng):
        super().__init__(arm, motions, rng)
        self.v_0 = rng.uniform(0.03, 0.2) * (0.2 if arm.slides[self.joint] else 1.0)
        self.damping = arm.plain.dof_damping[self.joint]

    def act(self, model, data, at, time, size):
        j = at[self.joint]
        speed = max(abs(data.qvel[j]), 1e-6)
        model.dof_damping[j] = self.damping + size * np.arcsinh(speed / self.v_0) / speed

    def parameters(self, size):
        return {"torque": size, "v_0": self.v_0}


class TorqueGain(OnJoint):
    """A torque channel with a wrong gain. Size: its relative error."""

    name, mechanism, bounds = "torque_gain", "gain", (0.03, 0.35)

    def channel(self, t, tau, size):
        gain = np.ones(tau.shape[1])
        gain[self.joint] += self.sign * size
        return tau * gain

    def parameters(self, size):
        return {"gain": 1 + self.sign * size}


class TorqueOffset(OnJoint):
    """A torque channel with a wrong zero. Size: N m."""

    name, mechanism, bounds, same_as = "torque_offset", "offset", (0.0005, 20.0), ("asymmetric_friction",)

    def channel(self, t, tau, size):
        offset = np.zeros(tau.shape[1])
        offset[self.joint] = self.sign * size
        return tau + offset

    def parameters(self, size):
        return {"offset": self.sign * size}


class TimeDelay(Effect):
    """A torque channel that is late. Size: s."""

    name, mechanism, bounds, shares = "time_delay", "delay", (0.003, 0.01), (0.05, 0.3)

    def channel(self, t, tau, size):
        return np.column_stack([np.interp(t - size, t, column) for column in tau.T])

    def parameters(self, size):
        return {"delay": size}


class Saturation(OnJoint):
    """A torque channel that is cut off. Size: part of the greatest torque of all motions that is cut off."""

    name, mechanism, bounds, shares = "saturation", "clipped_channel", (0.15, 0.4), (0.05, 0.25)

    def __init__(self, arm, motions, rng):
        super().__init__(arm, motions, rng)
        self.greatest = max(abs(arm.demand(m)[:, self.joint]).max() for m in motions)

    def channel(self, t, tau, size):
        limit = np.full(tau.shape[1], np.inf)
        limit[self.joint] = self.greatest * (1 - size)
        return np.clip(tau, -limit, limit)

    def parameters(self, size):
        return {"limit": self.greatest * (1 - size)}


class EncoderOffset(OnJoint):
    """An encoder with a wrong zero, which the control believes. Size: rad."""

    name, mechanism, bounds, robots = "encoder_offset", "encoder_offset", (0.01, 0.12), ("six_axis", "seven_axis")

    def __init__(self, arm, motions, rng):
        super().__init__(arm, motions, rng)
        self.joint = int(rng.integers(1, arm.n))
        # Turning the last link's frame turns its mass distribution, nothing else.
        self.same_as = ("link_parameters",) if self.joint == arm.n - 1 else ()

    def zero(self, arm, size):
        zero = np.zeros(arm.n)
        zero[self.joint] = self.sign * size
        return zero

    def parameters(self, size):
        return {"zero": self.sign * size}


class SplitJoint(OnLarge):
    """A joint in two: a hinge that carries the rotor and is counted, and behind it, on the same axis, the gear's give."""

    vibrates, shares, pace = True, (0.07, 0.2), 1.6

    def gear(self, spec, arm, **options):
        """Adds the second hinge."""
        joint = self.of(spec, arm)
        axis, pos = np.array(joint.axis), np.array(joint.pos)
        # Of the nominal pose: the hinge's inertia less its rotor's.
        self.link = arm.typical_inertia[self.joint] - arm.nominal.dof_armature[self.joint]
        return joint.parent.add_joint(name="gear", type=joint.type, axis=axis, pos=pos, frictionloss=0, armature=0, **options)


class JointElasticity(SplitJoint):
    """A gear that winds up like a spring. Size: s2, 1/(2 pi f)^2 of the link's vibration at a held rotor in mid-region."""

    name, mechanism, bounds = "joint_elasticity", "gear_spring", ((2 * np.pi * 12) ** -2, (2 * np.pi * 5) ** -2)

    def __init__(self, arm, motions, rng):
        super().__init__(arm, motions, rng)
        self.ratio = rng.uniform(0.02, 0.08)

    def build(self, spec, arm, size):
        gear = self.gear(spec, arm, limited=mujoco.mjtLimited.mjLIMITED_FALSE)
        self.stiffness = self.link / size
        gear.stiffness = [self.stiffness, 0, 0]
        gear.damping = [2 * self.ratio * np.sqrt(self.stiffness * self.link), 0, 0]

    def parameters(self, size):
        return {"stiffness": self.stiffness, "damping_ratio": self.ratio, "frequency": size**-0.5 / (2 * np.pi)}


class Backlash(SplitJoint):
    """Play: the gear's give is free between MuJoCo's joint limits. Size: half of the play, rad."""

    FLANK = 35.0  # vibration of the link on a flank at a held rotor, Hz

    name, mechanism, bounds = "backlash", "limited_hinge", (0.001, 0.005)

    def build(self, spec, arm, size):
        half = np.degrees(size) if spec.compiler.degree else size
        gear = self.gear(spec, arm, limited=mujoco.mjtLimited.mjLIMITED_TRUE, range=[-half, half])
        rotor = arm.nominal.dof_armature[self.joint]
        # MuJoCo's time constant is that of both sides against each other.
        gear.solref_limit = [1 / (2 * np.pi * self.FLANK * np.sqrt(1 + self.link / rotor)), 1.0]
        gear.solimp_limit = [0.95, 0.99, 0.0005, 0.5, 2.0]
        gear.damping = [0.6 * self.link, 0, 0]

    def parameters(self, size):
        return {"play": 2 * size}


class ExternalContact(Effect):
    """Pushes on the last link. Size: N, their mean force."""

    name, mechanism, bounds, shares = "external_contact", "pushes", (1.0, 150.0), (0.08, 0.3)

    def __init__(self, arm, motions, rng):
        self.body = arm.bodies[-1]
        self.pushes = []
        for i in range(TRAJECTORIES):
            # The first and the third (held out) are always touched.
            if i not in (0, 2) and rng.random() < 0.45:
                continue
            t = rng.uniform(0.5, 5.0)
            while t < LENGTH - 1.5:
                lasts = rng.uniform(0.4, 1.2)
                force = rng.normal(size=3)
                force *= rng.uniform(0.6, 1.4) / np.linalg.norm(force)
                begun = i * (LENGTH + PAUSE) + t
                self.pushes.append((begun, begun + lasts, force))
                t += lasts + rng.uniform(1.5, 5.0)

    def act(self, model, data, at, time, size):
        body = model.body(self.body).id
        data.xfrc_applied[body, :3] = 0
        for begun, ends, force in self.pushes:
            if begun < time < ends:
                # A hand takes hold and lets go within a tenth of a second.
                edge = min((time - begun) / 0.1, (ends - time) / 0.1, 1.0)
                data.xfrc_applied[body, :3] = size * np.sin(0.5 * np.pi * edge) ** 2 * force

    def parameters(self, size):
        return {"force": size, "times": [[begun, ends] for begun, ends, _ in self.pushes]}


# One slot of the deal each; a slot of several holds one of them at a time.
SINGLES = (
    (Payload,), (RotorInertia,), (FrictionParameters,), (BaseTilt,), (Counterbalance,),
    (StribeckFriction, AsymmetricFriction, LoadDependentFriction, NonlinearViscousFriction),
    (TorqueGain,), (TorqueOffset,), (TimeDelay,), (EncoderOffset,), (JointElasticity,), (Backlash,), (ExternalContact,), (Saturation,),
)  # fmt: skip
