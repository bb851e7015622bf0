"""Recordings of motion and torque as arrays."""

from __future__ import annotations

import contextlib
import os
import tempfile
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Iterable, Iterator, Mapping, Optional, Protocol, Sequence, Union

import numpy as np

from . import _residyn
from .said import in_python


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
        self._fits()

    def _fits(self) -> None:
        """Refuses tables that are not of one shape, and starts that are no rows."""
        shape = (len(self.time), self.q.shape[1])
        for name in _TABLES:
            table = getattr(self, name)
            if table is None or table.shape == shape:
                continue
            if len(table) != shape[0]:
                turned = f"\ntranspose it: {name}.T" if table.shape[1] == shape[0] else ""
                raise _residyn.InputError(f"{name} has the shape {table.shape} and time {self.time.shape}: one row per sample is needed{turned}")
            raise _residyn.InputError(f"{name} has the shape {table.shape} and q {self.q.shape}: one column per joint is needed")
        if self.starts[:1] != (0,) or not all(a < b for a, b in zip(self.starts, [*self.starts[1:], shape[0]])):
            raise _residyn.InputError(f"starts are {list(self.starts)}: rows below {shape[0]} that increase from 0 are needed")

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


class Files(list[Path]):
    """Paths of recordings, and the names of those that are temporary files."""

    def __init__(self) -> None:
        super().__init__()
        self.names: dict[str, str] = {}

    def said(self, text: str) -> str:
        """`text` with the names of the arguments in the place of temporary files."""
        return in_python(text, self.names)

    def named(self, raw: Any) -> Any:
        """What a report's JSON, text or page holds, with those names."""
        if isinstance(raw, dict):
            return {key: self.named(value) for key, value in raw.items()}
        if isinstance(raw, list):
            return [self.named(value) for value in raw]
        if isinstance(raw, str):
            for path, name in self.names.items():
                # A page has its slashes as character references.
                raw = raw.replace(path, name).replace(path.replace("/", "&#x2f;"), name)
        return raw


@contextlib.contextmanager
def paths(**arguments: Union[RecordingLike, Sequence[RecordingLike], None]) -> Iterator[Files]:
    """Paths of recordings by argument, in order: their own, or of files that last as long as the context.

    What is raised within speaks of arguments (`data[1]`, `heldout`) and keywords. An argument that is None is none.
    """
    with tempfile.TemporaryDirectory(prefix="residyn-") as folder:
        out = Files()
        for argument, given in arguments.items():
            for name, one in _called(argument, given):
                out.append(_path(one, Path(folder) / f"{argument}-{len(out) + 1}", name))
                if out[-1].parent == Path(folder):
                    out.names[str(out[-1])] = name
        try:
            yield out
        except (_residyn.InputError, RuntimeError) as error:
            raise type(error)(out.said(str(error))) from None


def _called(argument: str, given: Union[RecordingLike, Sequence[RecordingLike], None]) -> list[tuple[str, RecordingLike]]:
    """Recordings of an argument, and what each is called."""
    if given is None:
        return []
    if _is_one(given):
        return [(argument, given)]
    return [(f"{argument}[{i}]" if len(given) > 1 else argument, one) for i, one in enumerate(given)]


def _path(one: RecordingLike, stem: Path, name: str) -> Path:
    """A recording's own path, or that of a new file."""
    if isinstance(one, Recording):
        if one.source is not None:
            return one.source
        one.write(stem.with_suffix(".parquet"))
        return stem.with_suffix(".parquet")
    if is_frame(one):
        return _written(one, stem)
    if isinstance(one, (str, os.PathLike)):
        return Path(one)
    raise _residyn.InputError(f"{name} is of type {type(one).__name__}: a path, a residyn.Recording, or a frame of pandas or polars is needed")


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


def _is_one(data: Any) -> bool:
    """Whether it is one recording, and not several."""
    return isinstance(data, (str, os.PathLike, Recording)) or is_frame(data)


def several(data: Union[RecordingLike, Sequence[RecordingLike]], name: str, least: int = 1) -> list[RecordingLike]:
    """One recording or several of the argument `name`, as a list of at `least` so many."""
    if not _is_one(data) and (not isinstance(data, Iterable) or isinstance(data, Mapping)):
        raise _residyn.InputError(f"{name} is of type {type(data).__name__}: a recording or a list of recordings is needed")
    given = [data] if _is_one(data) else list(data)
    if len(given) < least:
        raise _residyn.InputError(f"{name} is empty: at least one recording is needed")
    return given
