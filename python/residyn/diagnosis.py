"""Where the gap between a simulator and a real robot lies, and what causes it."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Sequence, Union

import numpy as np

from . import _residyn, plots
from .model import Model
from .recording import Files, RecordingLike, paths, several

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Step:
    """A step of the ladder: how large the held-out error is with the causes so far."""

    step: str
    mean_nrmse: Optional[float]
    #: By joint; None where a joint is not judged.
    nrmse: list[Optional[float]]


@dataclass(frozen=True)
class Place:
    """A region where the gap lies."""

    joint: str
    coordinate: str
    range: tuple[float, float]
    unit: str
    share_of_gap: float
    share_of_time: float

    @classmethod
    def of(cls, raw: dict[str, Any]) -> "Place":
        """From a report's JSON."""
        names = ("joint", "coordinate", "unit", "share_of_gap", "share_of_time")
        return cls(range=tuple(raw["range"]), **{name: raw[name] for name in names})


@dataclass(frozen=True)
class Push:
    """A force from outside during part of a recording."""

    recording: str
    trajectory: str
    start: float
    end: float
    link: str
    torque: list[float]


@dataclass(frozen=True)
class Cause:
    """An effect that the model lacks. Fields as in the report's JSON; None is "not estimated"."""

    effect: str
    kind: str
    joints: list[str]
    share_of_gap: float
    gap_closed: float
    gap_closed_interval: Optional[tuple[float, float]]
    confirmed: bool
    confidence: Optional[float]
    p_value: Optional[float]
    #: Sizes by name, with the joint in brackets where a cause has several: value, standard deviation or None, unit.
    parameters: dict[str, tuple[float, Optional[float], str]]
    ambiguous_with: list[str]
    driver: Optional[str] = None
    pushes: list[Push] = field(default_factory=list)

    @classmethod
    def of(cls, raw: dict[str, Any]) -> "Cause":
        """From a report's JSON."""
        several_of = [p["name"] for p in raw["parameters"]]
        parameters = {}
        for p in raw["parameters"]:
            name = p["name"]
            if several_of.count(name) > 1 and "joint" in p:
                name = f"{name}[{p['joint']}]"
            parameters[name] = (p["value"], p["std"], p["unit"])
        interval = raw["gap_closed_interval"]
        return cls(
            effect=raw["effect"],
            kind=raw["kind"],
            joints=raw["joints"],
            share_of_gap=raw["share_of_gap"],
            gap_closed=raw["gap_closed"],
            gap_closed_interval=None if interval is None else tuple(interval),
            confirmed=raw["confirmed"],
            confidence=raw["confidence"],
            p_value=raw["p_value"],
            parameters=parameters,
            ambiguous_with=raw["ambiguous_with"],
            driver=raw.get("driver"),
            pushes=[Push(**p) for p in raw.get("pushes", [])],
        )


@dataclass(frozen=True)
class Report:
    """A diagnosis."""

    verdict: str
    #: Why nothing can be said, where the verdict is `cannot_tell`.
    reason: Optional[str]
    joints: list[str]
    causes: list[Cause]
    ladder: list[Step]
    places: list[Place]
    notes: list[str]
    #: Everything, as `diagnose --json` writes it.
    raw: dict[str, Any] = field(repr=False)
    _diagnosis: _residyn.Diagnosis = field(repr=False, compare=False)
    _files: Files = field(repr=False, compare=False)
    #: What `patch` has written, the description first; the page names it.
    _written: list[Path] = field(default_factory=list, repr=False, compare=False)

    def __str__(self) -> str:
        return self._files.named("\n".join(self._diagnosis.lines()))

    def to_html(self, path: Union[str, os.PathLike, None] = None) -> str:
        """The page of the report; written to `path` where one is given."""
        text = self._files.named(self._diagnosis.html(self._written))
        if path is not None:
            Path(path).write_text(text, encoding="utf-8")
        return text

    def _repr_html_(self) -> str:
        """In a notebook: the page in a frame of its own."""
        return framed(self._files.named(self._diagnosis.html(self._written)))

    def plot(self, joints: Optional[Sequence[str]] = None) -> "Figure":
        """Torque over time of the held-out recording: measured, as given, corrected, joint by joint. Needs matplotlib.

        `joints` are those to draw, by name (default: all). Trajectories follow each other on one axis of time.
        """
        motion = self.motion()
        curves = {"measured": motion["tau"], "as given": motion["given"], "corrected": motion["explained"]}
        return plots.over_time(motion["time"], plots.trajectories(motion["time"]), curves, self.joints, joints, "N·m (N)")

    def patch(self, path: Union[str, os.PathLike]) -> list[Path]:
        """Writes the corrected description to `path` and beside it what a URDF cannot hold; returns all paths."""
        self._written[:] = map(Path, self._diagnosis.patch(Path(path)))
        return list(self._written)

    def write_model(self, directory: Union[str, os.PathLike]) -> Model:
        """Writes a model directory that predicts what the last structural step of the ladder does."""
        self._diagnosis.write_model(Path(directory))
        return Model(directory)

    def motion(self) -> dict[str, Any]:
        """The held-out recording as it was scored: `time`, and `q`, `qd`, `qdd` (after the low-pass) and the recorded `tau`
        of shape (samples, joints); `given` and `explained` are the report's own torque without and with the causes; `clock_known` says
        whether its session's clock is."""
        return self._diagnosis.motion()

    def session(self) -> dict[str, np.ndarray]:
        """What friction's memory has run through by the end of the held-out recording, in this order: recordings on one clock
        interleave. `time`, `q`, `qd`, `qdd`, and `row`: which sample of `motion()` each one is, -1 for those of the fitted recording."""
        return self._diagnosis.session()

    def next_motion(self, path: Union[str, os.PathLike]) -> bool:
        """Writes the motion that tells ambiguous causes apart; false where none is needed or none was asked for."""
        return self._diagnosis.next_motion(Path(path))


def diagnose(
    given: Union[_residyn.Robot, Model, str, os.PathLike],
    data: Union[RecordingLike, Sequence[RecordingLike]],
    heldout: Optional[RecordingLike] = None,
    *,
    before: Union[RecordingLike, Sequence[RecordingLike]] = (),
    drive: Union[str, os.PathLike, None] = None,
    cutoff_hz: Optional[float] = None,
    fast: bool = False,
    learn: bool = False,
    next_motion: bool = False,
) -> Report:
    """Diagnoses the gap between a simulator's torque and a real robot's.

    given: the simulator's model, a `Robot` (or its name or path), or an identified `Model`
    data: recordings on which effects are fitted: files, `Recording`s, or frames of pandas or polars
    heldout: recording on which every figure is measured
    before: earlier recordings of the same robot; the report then says what has changed since. Of `given`, a `Robot`, lengths and axes
        are used, and without `heldout` every third trajectory of `data` is held out
    drive: drive file; needed for a `Model` alone, a `Robot` has its own
    cutoff_hz: of the motion's low-pass (default: chosen from the data)
    fast: skip all that is computed from surrogate recordings (p-values, the level of chance)
    learn: also train a compensator, and say how much of the rest of the gap it would close
    next_motion: also plan the motion that tells ambiguous causes apart, for `Report.next_motion`

    Raises `InputError` with the words of the command line, options as keywords; Ctrl-C returns at once.
    """
    if isinstance(given, (str, os.PathLike)):
        given = _residyn.Robot(os.fspath(given))
    robot = given if isinstance(given, _residyn.Robot) else None
    model = None if robot is not None else given.directory
    if robot is not None and drive is None:
        drive = robot.drive
    before, data = several(before, "before", least=0), several(data, "data")
    if before and robot is None:
        raise _residyn.InputError("before needs a Robot: its lengths and axes")
    if heldout is None and not before:
        raise _residyn.InputError("heldout is needed: a recording that is not in data")
    with paths(before=before, data=data, heldout=heldout) as files:
        done = _residyn.diagnose(
            robot,
            model,
            files[: len(before)],
            files[len(before) : len(before) + len(data)],
            None if heldout is None else files[-1],
            drive=None if drive is None else Path(drive),
            cutoff_hz=cutoff_hz,
            fast=fast,
            learn=learn,
            next_motion=next_motion,
        )
    raw = files.named(json.loads(done.json()))
    return Report(
        verdict=raw["verdict"],
        reason=raw.get("reason"),
        joints=raw["joints"],
        causes=[Cause.of(c) for c in raw["causes"]],
        ladder=[Step(s["step"], s["mean_nrmse"], s["nrmse"]) for s in raw["ladder"]],
        places=[Place.of(p) for p in raw["where"]],
        notes=raw["notes"],
        raw=raw,
        _diagnosis=done,
        _files=files,
    )


def framed(page: str) -> str:
    """A page in a frame of its own, for a notebook."""
    page = page.replace("&", "&amp;").replace('"', "&quot;")
    return f'<iframe srcdoc="{page}" style="width: 100%; height: 40em; border: 0"></iframe>'
