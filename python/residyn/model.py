"""Identification, training, and what comes of them: a model directory."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Optional, Sequence, Union

import numpy as np

from . import _residyn
from .recording import RecordingLike, paths, several

#: Called with joint, network, epoch, most epochs, and the error on held-back groups in N·m where there are some.
Progress = Callable[[int, int, int, int, Optional[float]], None]


@dataclass(frozen=True)
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

    def nrmse(self, name: str = "physics+compensator", scope: str = "all") -> list[Optional[float]]:
        """Error over the torque's standard deviation by joint; without a compensator, that of the physics."""
        names = [row["name"] for row in self.report["rows"]]
        wanted = "physics" if name == "physics+compensator" and name not in names else name
        for row in self.report["rows"]:
            if row["name"] == wanted and row["scope"] == scope:
                return row["nrmse"]
        raise KeyError(f"no scores of {wanted!r} over {scope!r}: was torque recorded?")


class Model:
    """A model directory."""

    def __init__(self, directory: Union[str, os.PathLike], *, period: Optional[float] = None) -> None:
        """`period`: of the control loop that calls `torque`, s (default: that of training)."""
        self._inner = _residyn.Model(Path(directory), period=period)

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
        """Torque at the next sample of a control loop; call it once per period, in order."""
        q, qd, qdd = (np.ascontiguousarray(x, dtype=np.float64) for x in (q, qd, qdd))
        return self._inner.torque(q, qd, qdd)

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
        """Torque over a recording, with scores where it has measured torque: what `eval` computes."""
        with paths(recording) as (path,):
            drive = None if drive is None else Path(drive)
            found = self._inner.evaluate(path, drive, cutoff_hz)
        found["report"] = json.loads(found["report"])
        return Prediction(**found)

    def __repr__(self) -> str:
        return repr(self._inner)


def identify(
    robot: Union[_residyn.Robot, str, os.PathLike],
    data: Union[RecordingLike, Sequence[RecordingLike]],
    out: Union[str, os.PathLike],
    *,
    heldout: Optional[RecordingLike] = None,
    **options: Any,
) -> Model:
    """Identifies the physics alone and writes a model directory: `train --physics-only`.

    `heldout` is scored and nothing else. `options` are those of `train`, with underscores: `cutoff_hz=8`, `basic=True`,
    `estimator="iterative"`, …
    """
    return train(robot, data, out, heldout=heldout, physics_only=True, **options)


def train(
    robot: Union[_residyn.Robot, str, os.PathLike],
    data: Union[RecordingLike, Sequence[RecordingLike]],
    out: Union[str, os.PathLike],
    *,
    heldout: Optional[RecordingLike] = None,
    progress: Optional[Progress] = None,
    **options: Any,
) -> Model:
    """Identifies the physics, trains the compensator on what is left, and writes a model directory: `train`.

    Ctrl-C stops it; with `resume=True` the same call goes on, where its recordings are files: arrays are written to new ones.
    """
    if not isinstance(robot, _residyn.Robot):
        robot = _residyn.Robot(os.fspath(robot))
    arguments = ["--quiet", "--robot", robot.source, "--out", os.fspath(out)]
    if robot.chosen:
        arguments.append("--joints=" + ",".join(robot.chosen))
    if robot.drive is not None:
        arguments += ["--drive", os.fspath(robot.drive)]
    if robot.gravity is not None:
        arguments.append("--gravity=" + ",".join(map(repr, robot.gravity)))
    for name, value in options.items():
        flag = "--" + name.replace("_", "-")
        if value is True:
            arguments.append(flag)
        elif value is not None and value is not False:
            arguments.append(f"{flag}={value}")
    data = several(data)
    extra = [] if heldout is None else [heldout]
    with paths(*data, *extra) as files:
        arguments += ["--data", *map(os.fspath, files[: len(data)])]
        if extra:
            arguments += ["--heldout", os.fspath(files[-1])]
        _residyn.train(arguments, progress)
    return Model(out)
