"""Recordings of motion and torque as arrays."""

from __future__ import annotations

import contextlib
import os
import tempfile
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Iterator, Optional, Protocol, Sequence, Union

import numpy as np

from . import _residyn


class Frame(Protocol):
    """A table of pandas or polars, with the columns of a recording's file."""

    @property
    def columns(self) -> Any: ...
    @property
    def shape(self) -> tuple[int, int]: ...


#: A recording as most functions take it: a path, arrays, or a frame.
RecordingLike = Union[str, os.PathLike, "Recording", Frame]

_TABLES = ("q", "tau", "qd", "qdd", "ql", "q_ref", "qd_ref", "tau_ff", "temp")


@dataclass(frozen=True)
class Recording:
    """Motion and torque of one robot: tables of shape (samples, joints), joints base first, SI units.

    `time` in s increases within each trajectory; `starts` are the rows at which trajectories begin (the first is 0) and
    `labels` their names. Only `time`, `q` and (except for prediction) `tau` are needed: velocity and acceleration are
    derived where they are missing.
    """

    time: np.ndarray
    q: np.ndarray
    tau: Optional[np.ndarray] = None
    qd: Optional[np.ndarray] = None
    qdd: Optional[np.ndarray] = None
    ql: Optional[np.ndarray] = None
    q_ref: Optional[np.ndarray] = None
    qd_ref: Optional[np.ndarray] = None
    tau_ff: Optional[np.ndarray] = None
    temp: Optional[np.ndarray] = None
    starts: Sequence[int] = (0,)
    labels: Optional[Sequence[str]] = None
    #: File that it was read from; functions read that file again, with all that it says beside the arrays.
    #: A copy with other arrays (`dataclasses.replace`) has none.
    source: Optional[Path] = field(default=None, init=False, compare=False)

    def __post_init__(self) -> None:
        keep = object.__setattr__
        keep(self, "time", _frozen(self.time, 1, "time"))
        for name in _TABLES:
            table = getattr(self, name)
            if table is not None:
                keep(self, name, _frozen(table, 2, name))
        keep(self, "starts", tuple(int(s) for s in self.starts))
        labels = self.labels
        if labels is None:
            labels = [str(i) for i in range(len(self.starts))]
        keep(self, "labels", tuple(str(label) for label in labels))
        if len(self.labels) != len(self.starts):
            raise _residyn.InputError(f"{len(self.starts)} starts and {len(self.labels)} labels")

    def __len__(self) -> int:
        return len(self.time)

    @property
    def dof(self) -> int:
        """Number of joints."""
        return self.q.shape[1]

    @classmethod
    def read(cls, path: Union[str, os.PathLike], robot: Optional[_residyn.Robot] = None) -> "Recording":
        """Reads .csv, .parquet, .npz, .mcap, rosbag2 folders (.mat of the KR300 benchmark); `robot` says names and units of columns."""
        path = Path(path)
        recording = cls(**_residyn.read_recording(path, robot))
        object.__setattr__(recording, "source", path)
        return recording

    def write(self, path: Union[str, os.PathLike]) -> None:
        """Writes .csv or .parquet, by the ending."""
        tables = {name: getattr(self, name) for name in _TABLES}
        given = {name: table for name, table in tables.items() if table is not None}
        _residyn.write_recording(Path(path), self.time, list(self.labels), list(self.starts), **given)

    def __repr__(self) -> str:
        present = [f.name for f in fields(self) if f.name in _TABLES and getattr(self, f.name) is not None]
        return f"Recording({len(self)} samples, {self.dof} joints, {len(self.starts)} trajectories: {', '.join(present)})"


def _frozen(table: np.ndarray, dimensions: int, name: str) -> np.ndarray:
    """A copy that cannot change beneath the recording."""
    try:
        table = np.array(table, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise _residyn.InputError(f"{name}: {error}") from None
    if table.ndim != dimensions:
        shape = "(samples,)" if dimensions == 1 else "(samples, joints)"
        raise _residyn.InputError(f"{name} has {table.ndim} dimensions; {shape} is needed")
    table.setflags(write=False)
    return table


@contextlib.contextmanager
def paths(*recordings: RecordingLike) -> Iterator[list[Path]]:
    """Paths of recordings: their own, or of files that last as long as the context."""
    with tempfile.TemporaryDirectory(prefix="residyn-") as folder:
        out = []
        for number, one in enumerate(recordings):
            if isinstance(one, Recording):
                out.append(one.source or Path(folder) / f"arrays-{number + 1}.parquet")
                if one.source is None:
                    one.write(out[-1])
            elif is_frame(one):
                out.append(_written(one, Path(folder) / f"frame-{number + 1}"))
            else:
                out.append(Path(one))
        yield out


def is_frame(data: Any) -> bool:
    """Whether it is a table of pandas or polars."""
    return hasattr(data, "columns") and (hasattr(data, "to_parquet") or hasattr(data, "write_parquet"))


def _written(frame: Any, stem: Path) -> Path:
    """A frame as a file that programs read: Parquet, or CSV where pandas has nothing to write Parquet with. A named index is a column."""
    parquet = stem.with_suffix(".parquet")
    if hasattr(frame, "write_parquet"):
        frame.write_parquet(parquet)
        return parquet
    if any(name is not None for name in frame.index.names):
        frame = frame.reset_index()
    try:
        frame.to_parquet(parquet, index=False)
    except ImportError:
        frame.to_csv(stem.with_suffix(".csv"), index=False)
        return stem.with_suffix(".csv")
    return parquet


def several(data: Union[RecordingLike, Sequence[RecordingLike]]) -> list[RecordingLike]:
    """One recording or several, as a list."""
    return [data] if isinstance(data, (str, os.PathLike, Recording)) or is_frame(data) else list(data)
