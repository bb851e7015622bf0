"""Whether the gap in motion has closed in MuJoCo itself: the recorded commands replayed, before and after, beside the report's figures."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np

from . import InputError, Recording, ReplayReport, Robot
from .rollout import Replayed, unexplained

PathLike = Union[str, os.PathLike]

#: Steps of the report's ladder that are no corrected model.
NO_MODEL = ("learned", "repeatability")
#: A figure of MuJoCo that is off the report's by no more than this, relative, is the same.
CLOSE = 0.05


@dataclass(frozen=True)
class Column:
    """Figures by joint under one setting of MuJoCo, or of the report."""

    head: str
    unexplained: np.ndarray


@dataclass(frozen=True)
class Rows:
    """One model: the report's figures where there are some, then MuJoCo's."""

    model: str
    report: Optional[Column]
    columns: list[Column]
    notes: list[str]


def corrected(controller: Mapping[str, Any], report: Mapping[str, Any]) -> dict[str, Any]:
    """The drive file's block with the values that the report has found; what it says of torque goes by the block's keys."""
    found = dict(_drives(report))
    kind = found.pop("kind")
    if kind == "dc_servo":
        found["torque_per_error"] = found.pop("kp", None)
    elif kind == "cascade":
        # Of a report kp and kd are the gains from errors to torque.
        found["kp"], found["kp_velocity"] = [p / d for p, d in zip(found["kp"], found["kd"])], found["kd"]
    known = {key: value for key, value in found.items() if value is not None and not key.endswith("_std")}
    return {**controller, **known}


def step_of(report: Mapping[str, Any], first: bool) -> Column:
    """A step of the report's ladder: the first, or what the corrected file leaves by itself, which is the last that is a model where it holds all."""
    alone = report.get("file_alone")
    if alone is not None and not first:
        return Column("report", np.array([np.nan if u is None else u for u in alone["unexplained"]]))
    ladder = [s for s in report["ladder"] if s["step"] not in NO_MODEL]
    if not ladder:
        raise InputError("the report's ladder has no step")
    step = ladder[0 if first else -1]
    return Column("report", np.array([np.nan if u is None else u for u in step["unexplained"]]))


def verify(
    robot: PathLike,
    data: Union[PathLike, Recording],
    given: Optional[PathLike] = None,
    *,
    joints: Sequence[str] = (),
    drive: Optional[PathLike] = None,
    report: Union[ReplayReport, Mapping[str, Any], None] = None,
    step: float = 1e-3,
) -> tuple[list[str], list[Rows]]:
    """Joints, and the corrected model `robot` behind the `given` one, replayed at `step` (s), at the file's own time step, and with friction that
    holds. `drive` is a drive file: the law of its block `[controller]` stands in place of the models' actuators; `report` is that of `replay`, or what `replay --json` wrote."""
    if isinstance(report, ReplayReport):
        report = report.raw
    names = list(joints) or ([] if report is None else list(report["joints"]))
    arm = Robot(os.fspath(given or robot), joints=names, drive=drive)
    recording = data if isinstance(data, Recording) else Recording.read(data, arm)
    if recording.q_ref is None:
        raise InputError("the recording has no commanded positions\nadd q_ref1 …, or name them in the drive file ([columns])")
    block = arm.controller or {}
    models = [] if given is None else [("as given", given, block)]
    after = block if report is None else corrected(block, report) if block else _beside_servos(report)
    models.append(("corrected", robot, after))
    out = []
    for name, path, controller in models:
        settings = [(step, False), (None, False), (step, True)]
        columns, notes = [], []
        for seconds, hard in settings:
            one = Replayed(path, arm.joints, controller, seconds, given, hard)
            if seconds is None and one.model.opt.timestep == step:
                continue
            errors = one.errors(recording)
            own = ", its own" if seconds is None else ", hard friction" if hard else ""
            columns.append(Column(f"{1e3 * one.model.opt.timestep:g} ms{own}", unexplained(recording, errors)))
            notes += [note for note in one.notes if note not in notes]
        rows = None if report is None else step_of(report, path is given)
        out.append(Rows(name, rows, columns, notes))
    return arm.joints, out


def _drives(report: Mapping[str, Any]) -> Mapping[str, Any]:
    """The drives that belong to the written file."""
    return report.get("file_alone", {}).get("controller", report["controller"])


def _beside_servos(report: Mapping[str, Any]) -> dict[str, Any]:
    """What a report says of drives that no actuator of a model holds."""
    found = _drives(report)
    return {key: found[key] for key in ("delay", "command_zero", "gravity_compensation") if found.get(key) is not None}


def _mean(values: np.ndarray) -> float:
    """Over the joints that have a figure; NaN where the simulation is lost on every one."""
    return float(np.mean(values[np.isfinite(values)])) if np.isfinite(values).any() else float("nan")


def table(joints: Sequence[str], rows: Sequence[Rows]) -> str:
    """The figures as text, and how far MuJoCo's mean is off the report's."""
    lines = []
    for one in rows:
        columns = ([] if one.report is None else [one.report]) + one.columns
        width = [max(10, len(c.head) + 3) for c in columns]
        head = "".join(f"{c.head:>{w}}" for c, w in zip(columns, width))
        lines.append(f"{one.model:<24}{head}")
        for k, joint in enumerate(joints):
            lines.append(f"  {joint:<22}" + "".join(f"{c.unexplained[k]:>{w}.4f}" for c, w in zip(columns, width)))
        lines.append(f"  {'mean':<22}" + "".join(f"{_mean(c.unexplained):>{w}.4f}" for c, w in zip(columns, width)))
        if one.report is not None:
            said = _mean(one.report.unexplained)
            off = [f"{100.0 * (_mean(c.unexplained) / said - 1.0):+.1f} %" for c in one.columns]
            lines.append(f"  {'off the report':<22}" + "".join(f"{o:>{w}}" for o, w in zip(["", *off], width)))
        lines += [f"  {note}" for note in one.notes]
    return "\n".join(lines)


def main(given: Any) -> int:
    """`python -m residyn.verify --replay`: 1 where MuJoCo loses a motion."""
    report = None
    if given.report is not None:
        try:
            report = json.loads(Path(given.report).read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise InputError(f"{given.report}: {error}") from None
        if not isinstance(report, dict) or report.get("schema") != "replay/1":
            raise InputError(f"{given.report} is no report of replay\ngive what `replay --json` has written")
    lost = False
    print("unexplained = RMS(q_sim − q) / RMS(q_ref − q), one roll-out in MuJoCo over each trajectory from its recorded start")
    for path in given.data:
        joints, rows = verify(
            given.robot,
            path,
            given.given,
            joints=[j for j in given.joints.split(",") if j],
            drive=given.drive,
            report=report,
            step=given.step,
        )
        print(f"{path}\n{table(joints, rows)}")
        lost |= any(np.isnan(_mean(c.unexplained)) for one in rows for c in one.columns)
        for one in rows:
            if one.report is None or one.model == "as given":
                continue
            off = _mean(one.columns[0].unexplained) / _mean(one.report.unexplained) - 1.0
            holds = "within" if abs(off) <= CLOSE else "not within"
            print(f"{one.model}: MuJoCo has the report's figure {holds} {100 * CLOSE:.0f} % at {one.columns[0].head}")
    return 1 if lost else 0
