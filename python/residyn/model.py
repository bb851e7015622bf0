"""Identification, training, and what comes of them: a model directory."""

from __future__ import annotations

import difflib
import inspect
import json
import os
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Literal, Optional, Sequence, TypedDict, TypeVar, Union, get_type_hints

import numpy as np

from . import _residyn, plots
from .recording import Recording, RecordingLike, paths, several

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from typing_extensions import Unpack

#: Called with joint, network, epoch, most epochs, and the error on held-back groups in N·m where there are some.
Progress = Callable[[int, int, int, int, Optional[float]], None]
Estimator = Literal["ols", "wls", "irls", "iterative"]
Weight = Literal["hard", "huber", "tukey"]
Lmi = Literal["off", "last", "every"]
Preset = Literal["default", "ucm"]


@dataclass(frozen=True, repr=False)
class Prediction:
    """Torque over a recording, shape (samples, joints), N·m (N)."""

    time: np.ndarray
    #: Whole model.
    torque: np.ndarray
    #: Physics alone.
    physics: np.ndarray
    #: Standard deviation of `torque`.
    std: np.ndarray
    #: What `eval --json` writes: scores by model and scope, notes.
    report: dict[str, Any]
    #: Positions, velocities and accelerations that the model saw, low-passed, shape (samples, joints), rad (m) and s.
    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray

    def plot(self, joints: Optional[Sequence[str]] = None) -> "Figure":
        """Torque over time: of the physics, and of the whole model with its standard deviation, joint by joint. Needs matplotlib.

        `joints` are those to draw, by name (default: all). Trajectories follow each other on one axis of time.
        """
        curves = {"physics": self.physics, "model": self.torque}
        names = self.report["joints"]
        return plots.over_time(self.time, plots.trajectories(self.time), curves, names, joints, "N·m (N)", band=self.std)

    def __repr__(self) -> str:
        mean = np.mean([v for v in self.nrmse() if v is not None]) if self.report["rows"] else None
        scored = "" if mean is None else f", mean NRMSE {mean:.4f}"
        return f"Prediction({len(self.time)} samples, {self.torque.shape[1]} joints{scored}: torque, physics, std, q, qd, qdd, report; nrmse(), plot())"

    def nrmse(self, name: str = "physics+compensator", scope: str = "all") -> list[Optional[float]]:
        """Error over the torque's standard deviation by joint; without a compensator, that of the physics."""
        names = [row["name"] for row in self.report["rows"]]
        wanted = "physics" if name == "physics+compensator" and name not in names else name
        for row in self.report["rows"]:
            if row["name"] == wanted and row["scope"] == scope:
                return row["nrmse"]
        if not self.report["rows"]:
            raise KeyError("no scores: the recording has no torque, or its columns are named by a drive file that `predict` was not given (drive=)")
        scopes = list(dict.fromkeys(row["scope"] for row in self.report["rows"]))
        raise KeyError(f"no scores of {wanted!r} over {scope!r}: there are {', '.join(dict.fromkeys(names))}, over {', '.join(scopes)}")


class Model:
    """A model directory."""

    def __init__(self, directory: Union[str, os.PathLike], *, period: Optional[float] = None) -> None:
        """`period`: of the control loop that calls `torque`, s (default: that of training)."""
        self._inner = _residyn.Model(Path(directory), period=period)
        #: Drive file of the robot that it was trained for in this session.
        self._drive: Optional[Path] = None

    @property
    def directory(self) -> Path:
        """Where it lies."""
        return Path(self._inner.directory)

    @property
    def joints(self) -> list[str]:
        """Joint names, base first."""
        return self._inner.joints

    @property
    def period(self) -> float:
        """Control period of `torque`, s."""
        return self._inner.period

    def torque(self, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
        """Torque at the next sample of a control loop; call it once per period, in order. Arrays have the shape (joints,)."""
        q, qd, qdd = (np.ascontiguousarray(x, dtype=np.float64) for x in (q, qd, qdd))
        if any(x.shape != (len(self.joints),) for x in (q, qd, qdd)):
            raise _residyn.InputError(f"q, qd and qdd of one sample have the shape ({len(self.joints)},); a whole recording goes to `predict`")
        return self._inner.torque(q, qd, qdd)

    @property
    def compensation(self) -> Optional[np.ndarray]:
        """The compensator's part of the last `torque`, N·m (N), by joint; None where the model has no compensator."""
        return self._inner.compensation

    def reset(self, clock: Optional[float] = None) -> None:
        """Forgets the motion so far."""
        self._inner.reset(clock)

    def predict(
        self,
        recording: RecordingLike,
        *,
        drive: Union[str, os.PathLike, None] = None,
        cutoff_hz: Optional[float] = None,
    ) -> Prediction:
        """Torque over a recording, with scores where it has measured torque: what `eval` computes.

        drive: drive file that says how the recording's columns are named (default: of a model that `identify` or `train` has returned, that
            of the robot; a model directory does not hold it). Arrays (`Recording`) are in SI units, without it.
        """
        if drive is None and not isinstance(recording, Recording):
            drive = self._drive
        with paths(recording=recording) as files:
            found = self._inner.evaluate(files[0], None if drive is None else Path(drive), cutoff_hz)
        found["report"] = files.named(json.loads(found["report"]))
        return Prediction(**found)

    def __repr__(self) -> str:
        return repr(self._inner)


class Options(TypedDict, total=False):
    """Keyword options of `identify` and of `train`, both."""

    #: Seed of all random numbers (default: 0).
    seed: int
    #: Fit viscous and Coulomb friction, offset and rotor inertia, and select no further terms.
    basic: bool
    #: Estimator of the parameters: "wls" (default), "ols", "irls", "iterative".
    estimator: Estimator
    #: Weight of a row by its residual, for "irls" and "iterative": "hard" (default), "huber", "tukey".
    weight: Weight
    #: Steps in which every link must be a possible body: "off" (default), "last", "every".
    lmi: Lmi
    #: Parameters that the ridge pulls towards: "nominal", or an older model directory.
    prior: Union[str, os.PathLike]
    #: Strength of the ridge, relative to each column's norm (default: 3e-5, with `prior` 0.1).
    ridge: float
    #: Fit only samples in motion.
    moving_only: bool
    #: Average the runs of each motion of `data`: trajectories that repeat and, of a number, periods of so many seconds.
    average: Union[bool, float]
    #: With `average`: fit the motion by a Fourier series with so many harmonics.
    harmonics: int
    #: Smooth the torque of `data` by robust local regression over so many samples.
    rloess: int
    #: Cut-off of the motion's low-pass, Hz (default: chosen from the data).
    cutoff_hz: float
    #: Rows per second of tables without a column of time.
    rate: float
    #: Number of threads; the result does not depend on it (default: all cores).
    threads: int


Function = TypeVar("Function", bound=Callable[..., Any])


def _named(function: Function) -> Function:
    """Shows `Options` in the signature of a function that takes them, for `help` and for notebooks; None is the default."""
    own = inspect.signature(function)
    kept = [p for p in own.parameters.values() if p.kind is not p.VAR_KEYWORD]
    hints = get_type_hints(Options).items()
    options = (inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=hint) for name, hint in hints)
    function.__signature__ = own.replace(parameters=[*kept, *options])
    return function


@_named
def identify(
    robot: Union[_residyn.Robot, str, os.PathLike],
    data: Union[RecordingLike, Sequence[RecordingLike]],
    out: Union[str, os.PathLike],
    *,
    heldout: Optional[RecordingLike] = None,
    **options: Unpack[Options],
) -> Model:
    """Identifies the physics alone and writes a model directory: `train --physics-only`.

    robot: a `Robot`, or its name or path
    data: recordings to learn from: files, `Recording`s, or frames of pandas or polars
    out: model directory to write
    heldout: recording that is scored and nothing else
    options: see `Options`; an option that is None is left at its default

    Raises `InputError` with the words of the command line, options as keywords; Ctrl-C stops it. Severe points of a recording or of the
    model are warned of (`UserWarning`); `check` tells all of a recording.
    """
    return _trained(robot, data, out, heldout, None, {"physics_only": True}, options)


@_named
def train(
    robot: Union[_residyn.Robot, str, os.PathLike],
    data: Union[RecordingLike, Sequence[RecordingLike]],
    out: Union[str, os.PathLike],
    *,
    heldout: Optional[RecordingLike] = None,
    progress: Optional[Progress] = None,
    preset: Optional[Preset] = None,
    members: Optional[int] = None,
    epochs: Optional[int] = None,
    yardsticks: bool = False,
    resume: bool = False,
    physics_only: bool = False,
    **options: Unpack[Options],
) -> Model:
    """Identifies the physics, trains the compensator on what is left, and writes a model directory: `train`.

    robot, data, out, heldout, options: as in `identify`
    progress: called while networks train
    preset: kind of compensator: "default", or "ucm", the published unit
    members: networks that are averaged for each joint
    epochs: passes over the training data
    yardsticks: also fit ridge regression and boosted trees, for `eval --leaderboard`
    resume: go on with an interrupted run of the same arguments, where its recordings are files: arrays are written to new ones
    physics_only: train no compensator

    Ctrl-C stops it; with `resume=True` the same call goes on.
    """
    own = {"preset": preset, "members": members, "epochs": epochs, "yardsticks": yardsticks, "resume": resume, "physics_only": physics_only}
    return _trained(robot, data, out, heldout, progress, own, options)


def as_options(robot: _residyn.Robot) -> list[str]:
    """Options of `train` that say which robot it is, and how its recordings are read."""
    options = ["--robot", robot.source]
    if robot.chosen:
        options.append("--joints=" + ",".join(robot.chosen))
    if robot.drive is not None:
        options += ["--drive", os.fspath(robot.drive)]
    if robot.gravity is not None:
        options.append("--gravity=" + ",".join(map(repr, robot.gravity)))
    return options


def _trained(
    robot: Union[_residyn.Robot, str, os.PathLike],
    data: Union[RecordingLike, Sequence[RecordingLike]],
    out: Union[str, os.PathLike],
    heldout: Optional[RecordingLike],
    progress: Optional[Progress],
    own: dict[str, Any],
    options: Options,
) -> Model:
    """Runs `train` with its own options and those of `Options`, by their names."""
    for name in options:
        if name not in Options.__annotations__:
            # `identify` has no options of its own.
            known = ["heldout", *(["progress", *own] if len(own) > 1 else []), *Options.__annotations__]
            like = difflib.get_close_matches(name, known, 1)
            raise TypeError(f"{name!r} is no option: " + (f"did you mean {like[0]!r}?" if like else f"there are {', '.join(known)}"))
    if not isinstance(robot, _residyn.Robot):
        robot = _residyn.Robot(os.fspath(robot))
    arguments = ["--quiet", *as_options(robot), "--out", os.fspath(out)]
    for name, value in {**own, **options}.items():
        flag = "--" + name.replace("_", "-")
        if value is True:
            arguments.append(flag)
        elif value is not None and value is not False:
            arguments.append(f"{flag}={value}")
    data = several(data, "data")
    with paths(data=data, heldout=heldout) as files:
        arguments += ["--data", *map(os.fspath, files[: len(data)])]
        if heldout is not None:
            arguments += ["--heldout", os.fspath(files[-1])]

        def warn(line: str) -> None:
            # The caller's line: of `train` or `identify`, two frames above this one's.
            warnings.warn(files.said(line), stacklevel=4)

        _residyn.train(arguments, progress, warn)
    model = Model(out)
    model._drive = robot.drive
    return model
