"""What a case withholds that the catalogue does not list, in the form of `effects.py`."""
import mujoco
import numpy as np

from arm import LENGTH, PAUSE
from effects import TRAJECTORIES, OnJoint


class Outside(OnJoint):
    """Something that the catalogue does not list."""

    name = "unknown"
    shares = (0.1, 0.3)


class CableTug(Outside):
    """A cable from the base to a point far out that pulls beyond a length: a spatial tendon. Size: N/m."""

    mechanism, bounds, robots = "cable_tug", (0.5, 3000.0), ("six_axis", "seven_axis")

    def __init__(self, arm, motions, rng):
        self.anchor = np.array([*rng.uniform(-0.5, 0.5, 2), rng.uniform(0.2, 0.9)])
        self.body, self.joint = arm.bodies[3], None
        self.place = rng.uniform(-0.05, 0.05, 3)
        data, model = mujoco.MjData(arm.plain), arm.plain
        lengths = []
        for motion in motions:
            for q in motion.at(np.arange(0, LENGTH, 0.1))[0]:
                data.qpos[:] = q
                mujoco.mj_kinematics(model, data)
                point = data.body(self.body).xpos + data.body(self.body).xmat.reshape(3, 3) @ self.place
                lengths.append(np.linalg.norm(point - self.anchor))
        self.slack = float(np.quantile(lengths, rng.uniform(0.35, 0.7)))

    def build(self, spec, arm, size):
        spec.worldbody.add_site(name="anchor", pos=self.anchor)
        spec.body(self.body).add_site(name="clamp", pos=self.place)
        cable = spec.add_tendon(name="cable", stiffness=[size, 0, 0], springlength=[0, self.slack])
        cable.wrap_site("anchor")
        cable.wrap_site("clamp")

    def parameters(self, size):
        return {"stiffness": size, "slack": self.slack, "body": self.body}


class CrossDrag(Outside):
    """Dry friction of one joint larger by size * qd^2 of another. Size: N m s2/rad2."""

    mechanism, bounds = "cross_drag", (1e-3, 300.0)

    def __init__(self, arm, motions, rng):
        super().__init__(arm, motions, rng)
        self.other = int(rng.choice([j for j in range(arm.n) if j != self.joint and not arm.slides[j]]))
        self.loss = arm.loss[self.joint]

    def act(self, model, data, at, time, size):
        model.dof_frictionloss[at[self.joint]] = self.loss + size * data.qvel[at[self.other]] ** 2

    def parameters(self, size):
        return {"drag": size, "other": f"joint{self.other + 1}"}


class Wandering(Outside):
    """A torque that wanders at random: half cosines between knots, each of which keeps 3/4 of the last. Size: N m."""

    mechanism, bounds = "wandering", (1e-4, 50.0)

    def __init__(self, arm, motions, rng):
        super().__init__(arm, motions, rng)
        self.every = rng.uniform(0.6, 1.5)
        knots = [0.0]
        while len(knots) * self.every < TRAJECTORIES * (LENGTH + PAUSE) + 5:
            knots.append(0.75 * knots[-1] + 0.66 * rng.normal())
        self.knots = knots

    def act(self, model, data, at, time, size):
        k, part = divmod(max(time, 0.0) / self.every, 1.0)
        a, b = self.knots[int(k)], self.knots[int(k) + 1]
        data.qfrc_applied[at[self.joint]] += size * (a + (b - a) * (0.5 - 0.5 * np.cos(np.pi * part)))

    def parameters(self, size):
        return {"torque": size, "every": self.every}


OUTSIDE = (CableTug, CrossDrag, Wandering)
