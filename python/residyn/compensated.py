"""A trained compensator inside a simulation by MuJoCo."""

from __future__ import annotations

import os
import weakref
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

    Every `mujoco.MjData` has a memory of its own, so that one callback serves many copies of the arm. It starts anew where a copy's time goes
    back, and by `reset`.

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
        self._directory, self._step = directory, simulated.opt.timestep
        loop = Model(directory, period=self._step)
        if loop.compensation is None:
            raise InputError(f"{os.fspath(directory)} has no compensator: its physics are all that it knows")
        names = loop.joints if joints is None else list(joints)
        if len(names) != len(loop.joints):
            raise InputError(f"{len(names)} joints are named and the model has {len(loop.joints)}")
        found = [mujoco.mj_name2id(simulated, mujoco.mjtObj.mjOBJ_JOINT, name) for name in names]
        missing = [name for name, i in zip(names, found) if i < 0]
        if missing:
            raise InputError(f"the simulation has no joint named {', '.join(missing)}")
        self._qpos, self._dof = simulated.jnt_qposadr[found], simulated.jnt_dofadr[found]
        self._loops: "weakref.WeakKeyDictionary[mujoco.MjData, _Loop]" = weakref.WeakKeyDictionary()
        #: Torque that acts on the copy that was computed last, N·m (N), by joint: against the compensator's.
        self.torque = np.zeros(len(names))

    def reset(self, data: Optional["mujoco.MjData"] = None) -> None:
        """Forgets the motion of this copy of the arm; None for all."""
        if data is None:
            self._loops.clear()
        else:
            self._loops.pop(data, None)

    def __call__(self, simulated: "mujoco.MjModel", data: "mujoco.MjData") -> None:
        """Adds the torque to `data.qfrc_passive`."""
        loop = self._loops.get(data)
        if loop is None:
            loop = self._loops[data] = _Loop(Model(self._directory, period=self._step))
        if loop.last is not None and data.time < loop.last:
            # The simulation was set back.
            loop.last = None
            loop.model.reset()
        # MuJoCo asks again within a step, for instance for inverse dynamics.
        if loop.last is None or data.time > loop.last + 0.5 * self._step:
            loop.last = data.time
            loop.model.torque(data.qpos[self._qpos], data.qvel[self._dof], data.qacc[self._dof])
            loop.torque = -loop.model.compensation
        self.torque = loop.torque
        data.qfrc_passive[self._dof] += loop.torque


class _Loop:
    """The model in the control loop of one copy of the arm, one sample per time step."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.last: Optional[float] = None
        self.torque: np.ndarray = np.zeros(len(model.joints))
