"""A scene in MuJoCo under recorded commands: one uninterrupted roll-out over each trajectory, from the recorded start."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np

from . import InputError, Recording

#: Laws of drives that are computed outside of the model, with what they cannot do without.
LAWS = {"pd": ("kp",), "pid": ("kp", "ki"), "cascade": ("kp", "kp_velocity"), "dc_servo": ("torque_per_error",)}
#: Armature of joints of the scene that are none of the arm's, over the arm's largest inertia: within a step they stand still. A larger one
#: costs MuJoCo's solver its digits.
HELD = 1e3


@dataclass
class Law:
    """Drives outside of the model, as the drive file's block `[controller]` has them; all values by joint."""

    kind: str
    values: dict[str, np.ndarray]

    @classmethod
    def of(cls, controller: Mapping[str, Any], joints: int) -> "Law":
        """Of a drive file or a report; a value that is missing by joint is 0, of a limit infinite."""
        kind = controller["kind"]
        if kind not in LAWS:
            raise InputError(f"kind {kind!r} of the controller is none of {', '.join(LAWS)}")
        values = {}
        for key in ("kp", "kd", "ki", "kp_velocity", "ki_velocity", "torque_per_error", "back_emf", "voltage", "limit"):
            values[key] = by_joint(controller, key, joints, np.inf if key in ("voltage", "limit") else 0.0)
        missing = [key for key in LAWS[kind] if not values[key].any()]
        if missing:
            raise InputError(f"the controller has no {', '.join(missing)}: {kind} needs it")
        return cls(kind, values)

    def torque(
        self, error: np.ndarray, rate: np.ndarray, qd: np.ndarray, integral: np.ndarray, step: float, added: Union[np.ndarray, float] = 0.0
    ) -> np.ndarray:
        """Torque at an error of position and a commanded velocity, with what the controller adds; `integral` goes on by `step` s."""
        v = self.values
        if self.kind == "pd":
            torque = v["kp"] * error + v["kd"] * (rate - qd)
        elif self.kind == "pid":
            integral += error * step
            torque = v["kp"] * error + v["kd"] * (rate - qd) + v["ki"] * integral
        elif self.kind == "cascade":
            off = v["kp"] * error + rate - qd
            integral += off * step
            torque = v["kp_velocity"] * off + v["ki_velocity"] * integral
        else:
            torque = np.clip(v["torque_per_error"] * error + added, -v["voltage"], v["voltage"]) - v["back_emf"] * qd
            added = 0.0
        return np.clip(torque + added, -v["limit"], v["limit"])


def by_joint(controller: Mapping[str, Any], key: str, joints: int, default: float) -> np.ndarray:
    """Values of a key, one per joint; `default` where there is none."""
    given = controller.get(key)
    given = [None] * joints if given is None else np.broadcast_to(np.array(given, dtype=object), joints)
    return np.array([default if value is None else float(value) for value in given])


class Replayed:
    """A model whose named joints follow commands, by its own servos of position or, where `controller` has a `kind`, by that law.

    `controller` has keys of the drive file's block `[controller]` and, of a report, `command_zero` (rad, added to the commands); delay and
    gravity compensation act on the model's own servos, too. Contacts and the ends of joints are off, as in the report's simulation, and
    what else the scene holds stands still. `step` is the time step, s (none: the file's own); `weight` a model whose weight the drives
    compensate (none: this one's); with `hard` friction, a joint that sticks stands still instead of creeping as MuJoCo lets it.
    """

    def __init__(
        self,
        model: Union[str, os.PathLike],
        joints: Sequence[str],
        controller: Optional[Mapping[str, Any]] = None,
        step: Optional[float] = None,
        weight: Union[str, os.PathLike, None] = None,
        hard: bool = False,
    ) -> None:
        import mujoco

        self.name, self.model = os.fspath(model), mujoco.MjModel.from_xml_path(os.fspath(model))
        off = mujoco.mjtDisableBit
        self.model.opt.disableflags |= off.mjDSBL_CONTACT | off.mjDSBL_LIMIT | off.mjDSBL_AUTORESET
        if step is not None:
            self.model.opt.timestep = step
        found = [mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, name) for name in joints]
        missing = [name for name, i in zip(joints, found) if i < 0]
        if missing:
            raise InputError(f"{self.name} has no joint named {', '.join(missing)}")
        self.qpos, self.dof = self.model.jnt_qposadr[found], self.model.jnt_dofadr[found]
        #: Positions and velocities of the scene that are not the arm's.
        self.still = np.setdiff1d(np.arange(self.model.nq), self.qpos)
        self.rest = np.setdiff1d(np.arange(self.model.nv), self.dof)
        self.model.dof_armature[self.rest] = HELD * self.model.dof_M0[self.dof].max()
        if hard:
            # The shortest time constant that MuJoCo takes, and an impedance next to one.
            self.model.dof_solref[:] = 2.0 * self.model.opt.timestep, 1.0
            self.model.dof_solimp[:, :2] = 0.9999
        controller = {} if controller is None else controller
        count = len(joints)
        self.actuator, self.servo = self._actuators(found)
        self.law = Law.of(controller, count) if "kind" in controller else None
        if self.law is not None:
            own = self.actuator[self.servo]
            self.model.actuator_gainprm[own], self.model.actuator_biasprm[own] = 0.0, 0.0
            self.actuator[self.servo], self.servo[:] = -1, False
        elif not self.servo.all():
            names = [name for name, servo in zip(joints, self.servo) if not servo]
            raise InputError(f"{self.name} has no servo of position for {', '.join(names)}\ngive the drives' block [controller] by --drive")
        self.linear = controller.get("interpolation") == "linear"
        #: Part of the weight that the drives hold, and of which model.
        self.held = float(controller.get("gravity_compensation") or 0.0)
        self.weight = self.model if weight is None else mujoco.MjModel.from_xml_path(os.fspath(weight))
        self.zero = by_joint(controller, "command_zero", count, 0.0)
        # What the model itself has of delay and smoothing acts there.
        own = np.zeros(count)
        driven = self.actuator[self.actuator >= 0]
        if hasattr(self.model, "actuator_delay"):
            # MuJoCo keeps so many past controls and no more, whatever the time step.
            kept = self.model.actuator_history[driven, 0] * self.model.opt.timestep
            own[self.actuator >= 0] += np.minimum(self.model.actuator_delay[driven], kept)
        own[self.actuator >= 0] += np.where(self.model.actuator_dyntype[driven] > 0, self.model.actuator_dynprm[driven, 0], 0.0)
        self.delay = np.maximum(by_joint(controller, "delay", count, 0.0) - own, 0.0)
        #: What was set free or lost on the way; one line each.
        self.notes: list[str] = []

    def _actuators(self, found: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
        """Actuator of each joint, -1 where there is none, and whether it is a servo of position."""
        import mujoco

        model, affine = self.model, int(mujoco.mjtBias.mjBIAS_AFFINE)
        ends = int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT)
        index, servo = np.full(len(found), -1), np.zeros(len(found), dtype=bool)
        for i in range(model.nu):
            if int(model.actuator_trntype[i]) not in ends or model.actuator_trnid[i, 0] not in found:
                continue
            k = list(found).index(model.actuator_trnid[i, 0])
            if index[k] >= 0:
                raise InputError(f"{self.name}: two actuators drive joint {model.joint(found[k]).name}; leave one")
            bias = model.actuator_biasprm[i] if int(model.actuator_biastype[i]) == affine else np.zeros(3)
            index[k], servo[k] = i, bias[1] != 0.0
            if not servo[k] and bias[2] != 0.0:
                raise InputError(f"{self.name}: joint {model.joint(found[k]).name} has a servo of velocity, which commanded positions do not drive")
        return index, servo

    def errors(self, recording: Recording) -> np.ndarray:
        """q_sim − q at the recorded instants, shape (samples, joints); NaN from where the simulation is lost."""
        if self.law is not None:
            self._free(recording)
        out = np.full(recording.q.shape, np.nan)
        for first, last in zip(recording.starts, [*recording.starts[1:], len(recording)]):
            part = slice(first, last)
            rates = None if recording.qd_ref is None else recording.qd_ref[part]
            start = np.zeros(recording.dof) if recording.qd is None else recording.qd[first]
            added = None if recording.tau_ff is None else recording.tau_ff[part]
            simulated = self._roll(recording.time[part], recording.q[first], start, recording.q_ref[part], rates, added)
            out[part] = simulated - recording.q[part]
        return out

    def _free(self, recording: Recording) -> None:
        """Frees the controls of motors whose range the law along the recorded motion exceeds."""
        known = recording.qd is not None and recording.qd_ref is not None
        rate, qd = (recording.qd_ref, recording.qd) if known else (0.0, 0.0)
        added = 0.0 if recording.tau_ff is None else recording.tau_ff
        demand = np.abs(self.law.torque(recording.q_ref - recording.q, rate, qd, np.zeros(recording.dof), 0.0, added)).max(0)
        for k, i in enumerate(self.actuator):
            if i < 0 or self.servo[k] or not self.model.actuator_ctrllimited[i]:
                continue
            range_ = np.abs(self.model.actuator_ctrlrange[i] * self.model.actuator_gear[i, 0]).max()
            if demand[k] > range_:
                self.model.actuator_ctrllimited[i] = 0
                self.notes.append(f"{self.model.actuator(i).name}: ctrlrange of {range_:g} set free, along the recorded motion {demand[k]:.3g} is asked for")

    def _commands(self, time: np.ndarray, table: np.ndarray, at: np.ndarray) -> np.ndarray:
        """Commands as they reach the drives at the times `at`; the first one holds before its stamp."""
        out = np.empty((len(at), table.shape[1]))
        for k, delay in enumerate(self.delay):
            if self.linear:
                out[:, k] = np.interp(at - delay, time, table[:, k])
            else:
                out[:, k] = table[np.maximum(np.searchsorted(time, at - delay, side="right") - 1, 0), k]
        return out

    def _roll(
        self, time: np.ndarray, q: np.ndarray, qd: np.ndarray, q_ref: np.ndarray, qd_ref: Optional[np.ndarray], tau_ff: Optional[np.ndarray]
    ) -> np.ndarray:
        """Positions at the instants `time` after a start at q, qd."""
        import mujoco

        model, step = self.model, self.model.opt.timestep
        data = mujoco.MjData(model)
        data.time, data.qpos[self.qpos], data.qvel[self.dof] = time[0], q, qd
        count = int(np.ceil((time[-1] - time[0]) / step)) + 1
        servo = self.actuator[self.servo]
        kept = model.actuator_history[servo, 0] if hasattr(model, "actuator_history") else np.zeros(len(servo), dtype=int)
        lead = int(kept.max(initial=0))
        # A step has the command of its middle: none is half a step late. `lead` steps before the first one fill the delays of the model.
        middles = time[0] + (np.arange(-lead, count) + 0.5) * step
        target = self._commands(time, q_ref, middles)
        rate = np.zeros_like(target) if qd_ref is None else self._commands(time, qd_ref, middles)
        added = np.zeros_like(target) if tau_ff is None else self._commands(time, tau_ff, middles)
        target += self.zero
        controls = target[:, self.servo] * model.actuator_gear[servo, 0]
        if tau_ff is not None:
            # A torque beside the servo's own, inside of its range of force: as much control as makes it.
            controls += added[:, self.servo] / (model.actuator_gainprm[servo, 0] * model.actuator_gear[servo, 0])
            model.actuator_ctrllimited[servo] = 0
        for k in np.flatnonzero(kept):
            times = time[0] + np.arange(-kept[k], 0) * step
            mujoco.mj_initCtrlHistory(model, data, servo[k], times, controls[lead - kept[k] : lead, k : k + 1])
        controls, target, rate, added = (table[lead:] for table in (controls, target, rate, added))
        motors = np.flatnonzero(~self.servo & (self.actuator >= 0))
        motor = self.actuator[motors]
        per_control = model.actuator_gainprm[motor, 0] * model.actuator_gear[motor, 0]
        bare = self.actuator < 0
        integral = np.zeros(len(q))
        weight = mujoco.MjData(self.weight) if self.held else None
        path = np.empty((count + 1, len(q)))
        path[0] = q
        for i in range(count):
            data.ctrl[servo] = controls[i]
            held = np.zeros(len(q)) if weight is None else self.held * self._weight(weight, data.qpos)
            drive = data.qfrc_actuator[self.dof] if self.law is None else self.law.torque(
                target[i] - data.qpos[self.qpos], rate[i], data.qvel[self.dof], integral, step, added[i]
            )
            if self.law is not None:
                data.ctrl[motor] = drive[motors] / per_control
            data.qfrc_applied[self.dof] = held + np.where(bare, drive, 0.0) * (self.law is not None)
            mujoco.mj_step(model, data)
            data.qpos[self.still], data.qvel[self.rest] = model.qpos0[self.still], 0.0
            path[i + 1] = data.qpos[self.qpos]
            if not np.isfinite(path[i + 1]).all():
                path[i + 1 :] = np.nan
                self.notes.append(f"{self.name}: the simulation is lost after {(i + 1) * step:.3g} s at steps of {step:g} s: gains too high for its inertias")
                break
        at = time[0] + np.arange(count + 1) * step
        return np.stack([np.interp(time, at, path[:, k]) for k in range(len(q))], axis=1)

    def _weight(self, data, qpos: np.ndarray) -> np.ndarray:
        """Torque that holds the arm against gravity."""
        import mujoco

        data.qpos[:] = qpos
        mujoco.mj_fwdPosition(self.weight, data)
        mujoco.mj_fwdVelocity(self.weight, data)
        return data.qfrc_bias[self.dof]


def unexplained(recording: Recording, errors: np.ndarray) -> np.ndarray:
    """RMS(q_sim − q) / RMS(q_ref − q) by joint; NaN where a joint never moves or the simulation is lost."""
    rms = lambda table: np.sqrt(np.mean(np.square(table), axis=0))
    tracking = rms(recording.q_ref - recording.q)
    moves = (np.ptp(recording.q, axis=0) > 0.0) & (tracking > 0.0)
    return np.divide(rms(errors), tracking, out=np.full(recording.dof, np.nan), where=moves)
