"""What is wrong with a recording, before anything is fitted to it."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Optional, Sequence, Union

from . import _residyn
from .model import as_options
from .recording import RecordingLike, paths, several


@dataclass(frozen=True)
class Check:
    """Check of recordings; `print` shows it."""

    #: What `train --check-only --json` prints: a report of each recording.
    raw: list[dict[str, Any]]
    text: str

    def __str__(self) -> str:
        return self.text


def check(
    robot: Union[_residyn.Robot, str, os.PathLike],
    data: Union[RecordingLike, Sequence[RecordingLike]],
    *,
    cutoff_hz: Optional[float] = None,
) -> Check:
    """Checks recordings as `train --check-only` does: columns, units, signs, gains, delays and clocks of the torque, gaps, short ranges.

    robot: a `Robot`, or its name or path
    data: recordings: files, `Recording`s, or frames of pandas or polars
    cutoff_hz: cut-off of the motion's low-pass, Hz (default: chosen from the data)
    """
    if not isinstance(robot, _residyn.Robot):
        robot = _residyn.Robot(os.fspath(robot))
    with paths(data=several(data, "data")) as files:
        cutoff = [] if cutoff_hz is None else [f"--cutoff-hz={cutoff_hz}"]
        found, lines = _residyn.check([*as_options(robot), *cutoff, "--check-only", "--data", *map(os.fspath, files)])
        return Check(files.named(json.loads(found)), files.said("\n".join(lines)))
