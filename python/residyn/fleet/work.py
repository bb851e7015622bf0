"""The tasks: plain functions of files, each of which stores what it makes under a digest of what that is made from."""

from __future__ import annotations

import hashlib
import json
import os
import pickle
import resource
import time
import uuid
from importlib import metadata
from pathlib import Path
from typing import Any, Callable, Optional

from .. import _residyn
from ..accumulator import Accumulator, Identified
from ..diagnosis import diagnose as diagnose_recordings

#: What a stored part means: another version makes every part anew.
_SCHEMA = f"fleet/1 {metadata.version('residyn')}".encode()


def digest(*parts: bytes) -> str:
    """Digest of some bytes, each with its length."""
    whole = hashlib.sha256(_SCHEMA)
    for part in parts:
        whole.update(len(part).to_bytes(8, "little"))
        whole.update(part)
    return whole.hexdigest()


def write(path: Path, content: bytes) -> None:
    """Writes a file whole or not at all, whoever else writes it meanwhile."""
    path.parent.mkdir(parents=True, exist_ok=True)
    being_written = path.with_name(f".{path.name}.{uuid.uuid4().hex}")
    try:
        being_written.write_bytes(content)
        os.replace(being_written, path)
    finally:
        being_written.unlink(missing_ok=True)


def _file_digest(path: Path) -> bytes:
    whole = hashlib.sha256()
    files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
    for each in files:
        with open(each, "rb") as file:
            while block := file.read(1 << 20):
                whole.update(block)
    return whole.digest()


def described(robot: _residyn.Robot) -> bytes:
    """Digest of what a robot is, wherever its files are: all that its torque is computed from."""
    return Accumulator(robot)._inner.to_bytes()


def _drive(robot: _residyn.Robot) -> bytes:
    """Contents of a robot's drive file, which says how its recordings are read."""
    return b"" if robot.drive is None else Path(robot.drive).read_bytes()


def _measured(work: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """What `work` found, with its seconds of processor and the most memory of this process so far; input that is refused as a `problem`."""
    began = time.process_time()
    try:
        found = {"problem": None, **work()}
    except (_residyn.InputError, OSError) as error:
        found = {"problem": str(error)}
    return {
        "cpu_seconds": time.process_time() - began,
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        **found,
    }


def _values(found: Identified) -> list[list[Any]]:
    return [[p.name, p.unit, p.value, p.std] for p in found.parameters]


def add(empty: bytes, recording: Path, out: Path) -> dict[str, Any]:
    """Adds one recording to the accumulator pickled in `empty`: a stored part, and what the recording alone tells."""

    def work() -> dict[str, Any]:
        own: Accumulator = pickle.loads(empty)
        key = digest(empty, _drive(own.robot), _file_digest(recording))
        part, told = out / "parts" / f"{key}.pickle", out / "parts" / f"{key}.json"
        cached = part.exists() and told.exists()
        if not cached:
            own.add(recording)
            try:
                alone = _values(own.finish())
            except _residyn.InputError:
                # A recording at rest tells nothing by itself; its sums count.
                alone = []
            write(part, pickle.dumps(own))
            preparation = own.preparation
            assert preparation is not None
            said = {
                "samples": own.samples,
                "cutoff_hz": preparation[0],
                "alone": alone,
                # What the others of this robot start from.
                "empty": pickle.dumps(own.emptied()).hex(),
            }
            write(told, json.dumps(said).encode())
        return {"part": str(part), "cached": cached, **json.loads(told.read_text())}

    return _measured(work)


def merge(parts: list[str], out: Path) -> dict[str, Any]:
    """Merges stored parts into one, two of them in memory at a time."""

    def work() -> dict[str, Any]:
        path = out / "merged" / f"{digest(*(Path(p).name.encode() for p in parts))}.pickle"
        cached = path.exists()
        if not cached:
            whole: Optional[Accumulator] = None
            for part in parts:
                with open(part, "rb") as file:
                    own = pickle.load(file)
                whole = own if whole is None else whole.merge(own)
            write(path, pickle.dumps(whole))
        return {"part": str(path), "cached": cached}

    return _measured(work)


def finish(part: str) -> dict[str, Any]:
    """The parameters behind a stored part."""

    def work() -> dict[str, Any]:
        with open(part, "rb") as file:
            whole: Accumulator = pickle.load(file)
        found = whole.finish()
        fit = [s / t if t > 0 else None for s, t in zip(found.residual_std, found.torque_rms)]
        return {"parameters": _values(found), "fit": fit, "rank": found.rank, "samples": whole.samples}

    return _measured(work)


def diagnose(robot: _residyn.Robot, recordings: list[Path], fast: bool, out: Path) -> dict[str, Any]:
    """Diagnoses one robot on its recordings but the last, which is held out."""

    def work() -> dict[str, Any]:
        if len(recordings) < 2:
            raise _residyn.InputError("a diagnosis needs two recordings, of which the last is held out")
        source = Path(robot.source)
        given = source.read_bytes() if source.is_file() else robot.source.encode()
        key = digest(str(fast).encode(), given, described(robot), _drive(robot), *map(_file_digest, recordings))
        path = out / "diagnosed" / f"{key}.json"
        cached = path.exists()
        if not cached:
            report = diagnose_recordings(robot, data=recordings[:-1], heldout=recordings[-1], fast=fast)
            write(path, json.dumps(report.raw).encode())
        report = json.loads(path.read_text())
        return {"cached": cached, "verdict": report["verdict"], "causes": report["causes"]}

    return _measured(work)
