"""A simulated arm in MuJoCo: its own inverse dynamics and rollouts along a recorded motion, and their error beside the report's."""

from __future__ import annotations

import importlib.util
import os
import xml.etree.ElementTree as xml
from dataclasses import dataclass
from pathlib import Path
from typing import Mapping, Optional, Sequence, Union

import numpy as np

from . import InputError, ReplayReport, Report

#: A joint is away from reversals where it is faster than this, rad/s (m/s), and MuJoCo's friction has come to its limit against the motion
#: in every model compared: nearer, every simulator has its own idea of friction. MuJoCo's turns round 9.5 ms early, over a range of speed that grows
#: with friction over inertia. Limit: within this part.
AWAY, LIMIT = 0.05, 1e-6
#: Length of a rollout under the recorded torque, and time from one start to the next, s.
ROLLOUT, EVERY = 0.5, 2.0


@dataclass(frozen=True)
class Row:
    """One model: mean over joints of the NRMSE away from reversals, by MuJoCo and by the report's own dynamics."""

    model: str
    mujoco: float
    report: float
    #: Position error after a rollout under the recorded torque, rad (m); NaN where there was none.
    drift: float
    #: NRMSE by joint, by MuJoCo.
    joints: tuple[float, ...]
    #: Part of the samples that are away from reversals, mean over joints.
    share: float
    #: Joints without a figure, left out of both means: no sample of theirs is away from reversals, or their torque never changes.
    left_out: tuple[str, ...] = ()


class Simulated:
    """Named joints of an MJCF or URDF in MuJoCo, with what generated code adds; the rest of the scene stands still at its reference.

    `rotors`: rotor inertia by joint, kg·m² (kg), of a URDF, which cannot hold it.
    """

    def __init__(
        self,
        model: Union[str, os.PathLike],
        joints: Sequence[str],
        code: Union[str, os.PathLike, None] = None,
        clock: Optional[float] = None,
        rotors: Optional[Mapping[str, float]] = None,
    ) -> None:
        import mujoco

        try:
            self.model = mujoco.MjModel.from_xml_path(os.fspath(model))
        except ValueError as error:
            raise InputError(f"MuJoCo cannot load {os.fspath(model)}: {error}") from None
        # What touches in a scene without its environment is no torque of the arm's own, and neither is a servo's.
        off = mujoco.mjtDisableBit
        self.model.opt.disableflags |= off.mjDSBL_CONTACT | off.mjDSBL_LIMIT | off.mjDSBL_ACTUATION
        found = [mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, name) for name in joints]
        missing = [name for name, i in zip(joints, found) if i < 0]
        if missing:
            raise InputError(f"{os.fspath(model)} has no joint named {', '.join(missing)}")
        self.qpos, self.dof = self.model.jnt_qposadr[found], self.model.jnt_dofadr[found]
        #: Positions and velocities of the scene that are not the arm's.
        self.still = np.setdiff1d(np.arange(self.model.nq), self.qpos)
        self.rest = np.setdiff1d(np.arange(self.model.nv), self.dof)
        self.data = mujoco.MjData(self.model)
        if rotors is not None:
            self.model.dof_armature[self.dof] = [rotors[name] for name in joints]
            # Constants of the solver go by inertia: with the old ones friction of a light joint never comes to its limit.
            mujoco.mj_setConst(self.model, self.data)
        #: The generated callback; `memory` after each sample of the last inverse dynamics.
        self.effects = None if code is None else _module(code).Effects(self.model, clock)
        self.memory: list = []
        #: Where friction had come to its limit in the last inverse dynamics, shape (samples, joints).
        self.slides = np.zeros((0, len(joints)), dtype=bool)

    def inverse(self, time: np.ndarray, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
        """Torque along a motion as MuJoCo computes it, shape (samples, joints)."""
        import mujoco

        data, torque = self.data, np.empty_like(q)
        self.memory, self.slides = [], np.ones(q.shape, dtype=bool)
        mujoco.mj_resetData(self.model, data)
        mujoco.set_mjcb_passive(self.effects)
        try:
            for i in range(len(q)):
                # Trajectories follow each other, on whatever clocks.
                data.time = time[i]
                data.qpos[self.qpos], data.qvel[self.dof], data.qacc[self.dof] = q[i], qd[i], qdd[i]
                mujoco.mj_inverse(self.model, data)
                torque[i] = data.qfrc_inverse[self.dof]
                self.slides[i] = self._at_limit()
                if self.effects is not None:
                    self.memory.append(self.effects.end)
        finally:
            mujoco.set_mjcb_passive(None)
        return torque

    def along(self, report: Report) -> np.ndarray:
        """Torque along the report's held-out motion. What friction remembers at the start of a trajectory is of the one before on the same
        clock, which may be one of the fitted recording's: a callback with memory runs through these, too."""
        if self.effects is None or not len(self.effects.end[0]):
            motion = report.motion()
            return self.inverse(motion["time"], motion["q"], motion["qd"], motion["qdd"])
        session = report.session()
        torque = self.inverse(session["time"], session["q"], session["qd"], session["qdd"])
        own = np.flatnonzero(session["row"] >= 0)
        own = own[np.argsort(session["row"][own])]
        self.slides, self.memory = self.slides[own], [self.memory[i] for i in own]
        return torque[own]

    def _at_limit(self) -> np.ndarray:
        """Which joints' friction is at its limit against the motion; true of joints without."""
        import mujoco

        data = self.data
        own = np.flatnonzero(data.efc_type == mujoco.mjtConstraint.mjCNSTR_FRICTION_DOF)
        dof, resists = data.efc_id[own], -data.efc_force[own] * np.sign(data.qvel[data.efc_id[own]])
        return ~np.isin(self.dof, dof[resists < (1.0 - LIMIT) * data.efc_frictionloss[own]])

    def drift(self, time: np.ndarray, q: np.ndarray, qd: np.ndarray, tau: np.ndarray) -> float:
        """How far the simulated arm is off the recorded one after `ROLLOUT` seconds under the recorded torque alone: root mean
        square over joints and starts, rad (m). Memory starts as `inverse` left it; NaN where no stretch is long enough."""
        import mujoco

        step, off = self.model.opt.timestep, []
        mujoco.set_mjcb_passive(self.effects)
        try:
            for start, last in _starts(time):
                data = mujoco.MjData(self.model)
                data.time = time[start]
                data.qpos[self.qpos], data.qvel[self.dof] = q[start], qd[start]
                if self.effects is not None:
                    self.effects.end = self.memory[start]
                end = start + np.searchsorted(time[start : last + 1], time[start] + ROLLOUT)
                part = slice(start, end + 1)
                for _ in range(round((time[end] - time[start]) / step)):
                    for k, dof in enumerate(self.dof):
                        data.qfrc_applied[dof] = np.interp(data.time + step / 2, time[part], tau[part, k])
                    mujoco.mj_step(self.model, data)
                    # What else the scene holds stands still, whatever falls on it.
                    data.qpos[self.still], data.qvel[self.rest] = self.model.qpos0[self.still], 0.0
                # Where it is at the last recorded instant, not a part of a step from it.
                rest = time[end] - data.time
                off.append(data.qpos[self.qpos] + rest * data.qvel[self.dof] - q[end])
        finally:
            mujoco.set_mjcb_passive(None)
        return float(np.sqrt(np.mean(np.square(off)))) if off else float("nan")


def _starts(time: np.ndarray) -> list[tuple[int, int]]:
    """Starts of rollouts, `EVERY` seconds apart, that do not reach beyond a trajectory, and the last row of theirs."""
    breaks = np.flatnonzero((np.diff(time) <= 0) | (np.diff(time) > 10 * np.median(np.abs(np.diff(time)))))
    starts = []
    for first, last in zip([0, *(breaks + 1)], [*breaks, len(time) - 1]):
        instants = np.arange(time[first] + 0.5, time[last] - ROLLOUT, EVERY)
        starts += [(first + k, last) for k in np.searchsorted(time[first : last + 1], instants)]
    return starts


def is_urdf(path: Union[str, os.PathLike]) -> bool:
    """Whether a description's outermost element is a URDF's."""
    try:
        with open(path, "rb") as file:
            return next(xml.iterparse(file, events=("start",)))[1].tag == "robot"
    except (OSError, xml.ParseError, StopIteration) as error:
        raise InputError(f"{os.fspath(path)}: {error}") from None


def rotor_inertias(values: Union[str, os.PathLike]) -> tuple[dict[str, float], dict[str, float]]:
    """Rotor inertia by joint, kg·m² (kg), as given and as corrected, from a patch's table of values."""
    rows = [line.split("\t") for line in Path(values).read_text(encoding="utf-8").splitlines()]
    own = [row for row in rows if len(row) == 8 and row[5] == "armature"]
    return {row[0]: float(row[2]) for row in own}, {row[0]: float(row[3]) for row in own}


def _module(path: Union[str, os.PathLike]):
    """A generated file, as a module."""
    spec = importlib.util.spec_from_file_location(Path(path).stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def nrmse(tau: np.ndarray, predicted: np.ndarray, away: np.ndarray) -> np.ndarray:
    """Error of the samples that are away from reversals over the torque's standard deviation, by joint; NaN where a joint never is."""
    out = np.full(tau.shape[1], np.nan)
    for j in range(tau.shape[1]):
        if away[:, j].any() and tau[:, j].std() > 0:
            out[j] = np.sqrt(np.mean((tau - predicted)[away[:, j], j] ** 2)) / tau[:, j].std()
    return out


def verify(
    report: Report,
    given: Union[str, os.PathLike],
    written: Sequence[Union[str, os.PathLike]],
    rollouts: bool = True,
) -> list[Row]:
    """The model as given, patched and, where there is generated code, patched with that along the report's held-out motion;
    `written` are the paths that `Report.patch` returned. Without `rollouts` there is no drift. A report of `replay` is refused: its
    commands are replayed by `residyn.verify_replay.verify`.

    A URDF holds no rotor inertia: those of the table of values among `written` are set in MuJoCo."""
    if isinstance(report, ReplayReport):
        raise InputError(
            "the report is one of replay, which compares motion and has no torque\n"
            "call residyn.verify_replay.verify(corrected, recording, given, report=report), or python -m residyn.verify --replay"
        )
    motion = report.motion()
    time = motion["time"]
    code = next((p for p in written if str(p).endswith("_mujoco.py")), None)
    before, after = None, None
    if is_urdf(written[0]):
        table = next((p for p in written if str(p).endswith(".values.tsv")), None)
        if table is None:
            raise InputError("a URDF holds no rotor inertia, and the table of values is not among the written files\npass all that `patch` has returned")
        before, after = rotor_inertias(table)
    models = [("as given", given, None, "given", before), ("patched", written[0], None, "explained", after)]
    if code is not None:
        models.append(("patched with code", written[0], code, "explained", after))
    clock = 0.0 if motion["clock_known"] else None
    simulated = [Simulated(path, report.joints, code, clock, rotors) for _, path, code, _, rotors in models]
    torques = [s.along(report) for s in simulated]
    away = np.logical_and.reduce([np.abs(motion["qd"]) > AWAY, *(s.slides for s in simulated)])
    rows = []
    for (name, _, _, own, _), one, torque in zip(models, simulated, torques):
        joints = nrmse(motion["tau"], torque, away)
        said = nrmse(motion["tau"], motion[own], away)
        drift = one.drift(time, motion["q"], motion["qd"], motion["tau"]) if rollouts else float("nan")
        left_out = tuple(joint for joint, figure in zip(report.joints, joints) if np.isnan(figure))
        rows.append(Row(name, _mean(joints), _mean(said), drift, tuple(map(float, joints)), float(away.mean()), left_out))
    return rows


def _mean(figures: np.ndarray) -> float:
    """Over the joints that have a figure; NaN where none has."""
    judged = figures[~np.isnan(figures)]
    return float(judged.mean()) if judged.size else float("nan")
