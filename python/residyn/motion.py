"""Where a simulator's motion departs from the robot's under the same commands, and what causes it; no torque is needed."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Sequence, Union

import numpy as np

from . import _residyn, plots
from .diagnosis import Cause, Place, framed
from .recording import Files, RecordingLike, paths, several

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class ReplayStep:
    """A step of the ladder: how far the simulator with the causes so far is off on the held-out recording."""

    step: str
    #: Mean over joints of RMS(q_sim - q) / RMS(q_ref - q): 1 knows nothing of the departure from the commands, 0 is perfect.
    mean_unexplained: Optional[float]
    #: The same by joint; None for a joint that never moves.
    unexplained: list[Optional[float]]
    #: RMS(q_sim - q) by joint, rad (m).
    rmse: list[Optional[float]]
    #: RMS(q_ref - q) by joint, rad (m).
    tracking: list[Optional[float]]

    @classmethod
    def of(cls, raw: dict[str, Any]) -> "ReplayStep":
        """From a report's JSON."""
        return cls(**{f.name: raw[f.name] for f in fields(cls)})


@dataclass(frozen=True)
class ReplayReport:
    """A diagnosis of motion."""

    verdict: str
    #: Why nothing can be said, where the verdict is `cannot_tell`.
    reason: Optional[str]
    joints: list[str]
    causes: list[Cause]
    #: First the simulator as given, then with each cause. Where the held-out recording repeats a motion, the last step is
    #: `repeatability`: how far one execution is from another, which is no simulator.
    ladder: list[ReplayStep]
    places: list[Place]
    #: What this motion cannot show: `effect` (or None), `joints` and `reason`.
    not_identifiable: list[dict[str, Any]]
    #: The drives as fitted: values by joint, with standard deviations (None: the given value).
    controller: dict[str, Any]
    #: `damping`, `frictionloss` and `armature` as fitted, by joint.
    joint_parameters: dict[str, list[float]]
    notes: list[str]
    #: Everything, as `replay --json` writes it.
    raw: dict[str, Any] = field(repr=False)
    _replay: _residyn.Replay = field(repr=False, compare=False)
    _files: Files = field(repr=False, compare=False)
    #: What `patch` has written, the model first; the page names it.
    _written: list[Path] = field(default_factory=list, repr=False, compare=False)

    def __str__(self) -> str:
        return self._files.named("\n".join(self._replay.lines()))

    def to_html(self, path: Union[str, os.PathLike, None] = None) -> str:
        """The page of the report; written to `path` where one is given."""
        text = self._files.named(self._replay.html(self._written))
        if path is not None:
            Path(path).write_text(text, encoding="utf-8")
        return text

    def _repr_html_(self) -> str:
        """In a notebook: the page in a frame of its own."""
        return framed(self._files.named(self._replay.html(self._written)))

    def plot(self, joints: Optional[Sequence[str]] = None) -> "Figure":
        """Position over time of the held-out recording: command, measured, as given, corrected, joint by joint. Needs matplotlib.

        `joints` are those to draw, by name (default: all). Trajectories follow each other on one axis of time.
        """
        trajectories = self.motion()
        ends = np.cumsum([len(t["time"]) for t in trajectories])
        parts = [slice(end - len(t["time"]), end) for end, t in zip(ends, trajectories)]
        of = {"command": "q_ref", "measured": "q", "as given": "given", "corrected": "corrected"}
        curves = {name: np.concatenate([t[key] for t in trajectories]) for name, key in of.items()}
        return plots.over_time(np.concatenate([t["time"] for t in trajectories]), parts, curves, self.joints, joints, "rad (m)")

    def patch(self, path: Union[str, os.PathLike]) -> tuple[list[Path], list[str]]:
        """Writes the corrected model to `path`, and beside it a drive file and values for Isaac Lab and Newton; returns all paths, and
        what the model's format cannot hold."""
        written, left_out = self._replay.patch(Path(path))
        self._written[:] = map(Path, written)
        return list(self._written), left_out

    def motion(self) -> list[dict[str, np.ndarray]]:
        """The held-out trajectories as they were scored: `time`, and of shape (samples, joints) the recorded `q`, the command `q_ref`, and
        the simulated motion as `given` and `corrected`."""
        return self._replay.motion()


def replay(
    given: Union[_residyn.Robot, str, os.PathLike],
    data: Union[RecordingLike, Sequence[RecordingLike]],
    heldout: RecordingLike,
    *,
    before: Union[RecordingLike, Sequence[RecordingLike]] = (),
    drive: Union[str, os.PathLike, None] = None,
    fast: bool = False,
    ceiling: bool = False,
) -> ReplayReport:
    """Diagnoses the gap in motion between a simulator and a real robot under the same commands.

    given: the simulator's model, a `Robot` (or its name or path); a URDF needs a drive file with the block [controller]
    data: recordings to fit: files, `Recording`s, or frames of pandas or polars, with commanded positions (`q_ref`) beside `q` and no
        torque; `tau_ff` is what the controller adds to its own law
    heldout: recording on which every figure is measured
    before: earlier recordings of the same robot; the report then says what has changed since
    drive: in place of the robot's own drive file
    fast: measure the causes' shares by shorter fits
    ceiling: fit the same effects to `heldout` itself, too (`raw["ceiling"]`)

    Raises `InputError` with the words of the command line, options as keywords; Ctrl-C returns at once.
    """
    drive = None if drive is None else Path(drive)
    if isinstance(given, (str, os.PathLike)):
        given = _residyn.Robot(os.fspath(given), drive=drive)
    data, before = several(data, "data"), several(before, "before", least=0)
    with paths(data=data, before=before, heldout=heldout) as files:
        earlier = files[len(data) : -1]
        done = _residyn.replay(given, files[: len(data)], files[-1], before=earlier, drive=drive or given.drive, fast=fast, ceiling=ceiling)
    raw = files.named(json.loads(done.json()))
    return ReplayReport(
        verdict=raw["verdict"],
        reason=raw.get("reason"),
        joints=raw["joints"],
        causes=[Cause.of(c) for c in raw["causes"]],
        ladder=[ReplayStep.of(s) for s in raw["ladder"]],
        places=[Place.of(p) for p in raw["where"]],
        not_identifiable=raw["not_identifiable"],
        controller=raw["controller"],
        joint_parameters=raw["joint_parameters"],
        notes=raw["notes"],
        raw=raw,
        _replay=done,
        _files=files,
    )
