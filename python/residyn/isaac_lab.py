"""An actuator of Isaac Lab whose joints resist as the real ones do: what a trained compensator learned acts on them.

Nothing of Isaac Lab is imported here: the class is made from the explicit actuator that is handed in.

    from isaaclab.actuators import IdealPDActuator, IdealPDActuatorCfg
    from isaaclab.utils import configclass
    from residyn.isaac_lab import resisting

    @configclass
    class ArmActuatorCfg(IdealPDActuatorCfg):
        class_type: type = resisting(IdealPDActuator)
        model_directory: str = "model"
        #: Time step of the physics, s.
        period: float = 0.005
"""

from __future__ import annotations

from typing import Any, Optional, Sequence

from . import InputError
from .learned import Learned


def resisting(actuator: type) -> type:
    """A subclass of an explicit actuator, such as `IdealPDActuator` or `DCMotor`, with the learned torque of `cfg.model_directory`.

    The actuator computes and limits the motor's effort as before; `applied_effort` is the motor's. What the compensator learned is taken off
    what goes to the joints, in N·m (N). The group needs all joints of the model, in any order; others get the motor's effort alone.
    The physics, friction included, belong into the simulated robot. `compute` has to be called once per `cfg.period`.
    """
    if getattr(actuator, "is_implicit_model", False):
        raise InputError(f"{actuator.__name__} leaves the joint's torque to the simulation: take an explicit actuator, such as IdealPDActuator")

    class Resisting(actuator):
        """An explicit actuator with what a compensator learned."""

        def __init__(self, cfg: Any, *args: Any, **kwargs: Any) -> None:
            super().__init__(cfg, *args, **kwargs)
            #: The compensator of all environments.
            self.learned = Learned(cfg.model_directory, self._num_envs, period=cfg.period, device=self._device)
            names = list(self.joint_names)
            missing = [name for name in self.learned.joints if name not in names]
            if missing:
                raise InputError(f"the group of joints lacks {', '.join(missing)}, which the model has")
            #: Columns of the group that are the model's joints, base first.
            self._own = [names.index(name) for name in self.learned.joints]

        def reset(self, env_ids: Optional[Sequence[int]]) -> None:
            """Forgets the motion of these environments; None for all."""
            super().reset(env_ids)
            self.learned.reset(env_ids)

        def compute(self, control_action: Any, joint_pos: Any, joint_vel: Any) -> Any:
            """The motor's action, less what the joints resist with."""
            action = super().compute(control_action, joint_pos, joint_vel)
            resistance = self.learned.torque(joint_pos[:, self._own], joint_vel[:, self._own])
            # The motor's effort stays as it is: another array goes to the joints.
            efforts = action.joint_efforts + 0.0
            efforts[:, self._own] = efforts[:, self._own] - resistance
            action.joint_efforts = efforts
            return action

    Resisting.__name__ = Resisting.__qualname__ = f"Resisting{actuator.__name__}"
    return Resisting
