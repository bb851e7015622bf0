"""A trained compensator inside a simulation by MuJoCo."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Optional, Sequence, Union

import numpy as np

from . import InputError
from .model import Model

if TYPE_CHECKING:
    import mujoco


class Compensated:
    """Makes an arm in MuJoCo resist as the real one does: a callback for `mujoco.set_mjcb_passive`.

    The MJCF holds the physics that were identified; what the compensator learned beyond them acts on the joints as a passive torque. It is
    computed once per time step, from the positions and velocities of that step and the accelerations of the one before, with the memory of
    the motion that the model has in a control loop. Outside the motion that it was trained on it fades to nothing.

        simulated = mujoco.MjModel.from_xml_path("arm_identified.xml")
        mujoco.set_mjcb_passive(residyn.Compensated("model", simulated))
    """

    def __init__(
        self,
        directory: Union[str, os.PathLike],
        simulated: "mujoco.MjModel",
        joints: Optional[Sequence[str]] = None,
    ) -> None:
        """`directory`: of a trained model. `joints`: names of the arm's joints in the MJCF, base first (default: those of the model)."""
        import mujoco

        if simulated.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4:
            raise InputError("the integrator RK4 evaluates each step four times, and a memory of the motion cannot follow: use implicitfast")
        #: The model in its control loop, one sample per time step.
        self.model = Model(directory, period=simulated.opt.timestep)
        if self.model.compensation is None:
            raise InputError(f"{os.fspath(directory)} has no compensator: its physics are all that it knows")
        names = self.model.joints if joints is None else list(joints)
        if len(names) != len(self.model.joints):
            raise InputError(f"{len(names)} joints are named and the model has {len(self.model.joints)}")
        found = [mujoco.mj_name2id(simulated, mujoco.mjtObj.mjOBJ_JOINT, name) for name in names]
        missing = [name for name, i in zip(names, found) if i < 0]
        if missing:
            raise InputError(f"the simulation has no joint named {', '.join(missing)}")
        self._qpos, self._dof = simulated.jnt_qposadr[found], simulated.jnt_dofadr[found]
        self._step = simulated.opt.timestep
        self._last: Optional[float] = None
        #: Torque that acts, N·m (N), by joint: against the compensator's.
        self.torque = np.zeros(len(names))

    def __call__(self, simulated: "mujoco.MjModel", data: "mujoco.MjData") -> None:
        """Adds the torque to `data.qfrc_passive`."""
        if self._last is not None and data.time < self._last:
            # The simulation was set back.
            self._last = None
            self.model.reset()
        # MuJoCo asks again within a step, for instance for inverse dynamics.
        if self._last is None or data.time > self._last + 0.5 * self._step:
            self._last = data.time
            self.model.torque(data.qpos[self._qpos], data.qvel[self._dof], data.qacc[self._dof])
            self.torque = -self.model.compensation
        data.qfrc_passive[self._dof] += self.torque
