"""Tables of a fleet from the files of its robots, one robot in memory at a time where rows are many."""

from __future__ import annotations

import collections
import contextlib
import json
import os
from pathlib import Path
from typing import Any, Iterator, Optional

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

#: Robust deviations from which a parameter is an outlier: of normal ones, one in two million is.
LIMIT = 5.0
#: Robots with one description, at least, that are compared.
FEWEST = 5
#: 1.4826 times the median distance from the median is the standard deviation of normal values.
_NORMAL = 1.4826

_TEXT, _NUMBER, _COUNT, _FLAG = pa.string(), pa.float64(), pa.int64(), pa.bool_()
_ROBOTS = pa.schema([
    ("robot", _TEXT), ("description", _TEXT), ("recordings", _COUNT), ("refused", _COUNT), ("samples", _COUNT),
    ("cutoff_hz", _NUMBER), ("rank", _COUNT), ("residual_over_torque", _NUMBER), ("outliers", _COUNT), ("verdict", _TEXT),
    ("problem", _TEXT),
])
_RECORDINGS = pa.schema([
    ("robot", _TEXT), ("place", _COUNT), ("recording", _TEXT), ("samples", _COUNT), ("cpu_seconds", _NUMBER), ("peak_mb", _NUMBER),
    ("cached", _FLAG), ("problem", _TEXT),
])
_PARAMETERS = pa.schema([
    ("robot", _TEXT), ("description", _TEXT), ("parameter", _TEXT), ("unit", _TEXT), ("value", _NUMBER), ("std", _NUMBER),
    ("median", _NUMBER), ("z", _NUMBER), ("outlier", _FLAG),
])
_OVER_TIME = pa.schema([
    ("robot", _TEXT), ("place", _COUNT), ("recording", _TEXT), ("parameter", _TEXT), ("value", _NUMBER), ("std", _NUMBER),
])
_CAUSES = pa.schema([("effect", _TEXT), ("robots", _COUNT), ("of", _COUNT), ("names", pa.list_(_TEXT))])
_BY_ROBOT = pa.schema([
    ("robot", _TEXT), ("effect", _TEXT), ("joints", pa.list_(_TEXT)), ("confirmed", _FLAG), ("confidence", _NUMBER),
    ("gap_closed", _NUMBER),
])


def robust(values: np.ndarray) -> tuple[float, float]:
    """Median and robust deviation."""
    median = float(np.median(values))
    return median, _NORMAL * float(np.median(np.abs(values - median)))


def robust_z(values: np.ndarray, deviations: np.ndarray) -> tuple[float, np.ndarray]:
    """Median, and the distance of each value from it over the larger of the fleet's robust deviation and the value's own
    standard deviation: what is merely badly known is no outlier."""
    median, spread = robust(values)
    scale = np.maximum(spread, deviations)
    apart = values - median
    return median, np.divide(apart, scale, out=np.zeros_like(apart), where=scale > 0)


@contextlib.contextmanager
def _table(folder: Path, name: str, schema: pa.Schema) -> Iterator[Any]:
    """Gives a function that appends rows; the file is there when all are written."""
    path, being_written = folder / f"{name}.parquet", folder / f".{name}.parquet.part"
    try:
        with pq.ParquetWriter(being_written, schema) as writer:
            yield lambda rows: rows and writer.write_table(pa.Table.from_pylist(rows, schema=schema))
        os.replace(being_written, path)
    finally:
        being_written.unlink(missing_ok=True)


def write(folder: Path, places: list[Path]) -> None:
    """Writes every table; `places` are the robots' files in the order of the members."""

    def robots() -> Iterator[dict[str, Any]]:
        return (json.loads(place.read_text()) for place in places)

    compared = _compared(robots())
    causes: dict[str, list[str]] = collections.defaultdict(list)
    diagnosed = 0
    with contextlib.ExitStack() as stack:
        def table(name: str, schema: pa.Schema) -> Any:
            return stack.enter_context(_table(folder, name, schema))

        add_robots, add_recordings = table("robots", _ROBOTS), table("recordings", _RECORDINGS)
        add_parameters, add_over_time = table("parameters", _PARAMETERS), table("over_time", _OVER_TIME)
        add_by_robot = table("causes_by_robot", _BY_ROBOT)
        for robot in robots():
            parameters = [_parameter(robot, row, compared) for row in robot["parameters"]]
            add_parameters(parameters)
            add_recordings([_recording(robot["robot"], k, one) for k, one in enumerate(robot["recordings"])])
            add_over_time([row for k, one in enumerate(robot["recordings"]) for row in _alone(robot["robot"], k, one)])
            add_robots([_robot(robot, sum(p["outlier"] for p in parameters))])
            found = (robot.get("diagnosis") or {}).get("causes")
            if found is not None:
                diagnosed += 1
                add_by_robot([_cause(robot["robot"], cause) for cause in found])
                for effect in {cause["effect"] for cause in found}:
                    causes[effect].append(robot["robot"])
        rows = [{"effect": e, "robots": len(names), "of": diagnosed, "names": names} for e, names in causes.items()]
        table("causes", _CAUSES)(sorted(rows, key=lambda row: (-row["robots"], row["effect"])))


def _compared(robots: Iterator[dict[str, Any]]) -> dict[tuple[str, str], tuple[Optional[float], dict[str, float]]]:
    """Median of each description's parameters and each robot's z; of too few robots neither."""
    values: dict[tuple[str, str], list[tuple[str, float, float]]] = collections.defaultdict(list)
    for robot in robots:
        for name, _, value, std in robot["parameters"]:
            values[robot["description"], name].append((robot["robot"], value, std))
    out = {}
    for key, rows in values.items():
        if len(rows) < FEWEST:
            out[key] = (None, {})
            continue
        names, own, stds = zip(*rows)
        median, z = robust_z(np.array(own), np.array(stds))
        out[key] = (median, dict(zip(names, z.tolist())))
    return out


def _parameter(robot: dict[str, Any], row: list[Any], compared: dict[Any, Any]) -> dict[str, Any]:
    name, unit, value, std = row
    median, by_robot = compared[robot["description"], name]
    z = by_robot.get(robot["robot"])
    return {
        "robot": robot["robot"], "description": robot["description"], "parameter": name, "unit": unit, "value": value, "std": std,
        "median": median, "z": z, "outlier": z is not None and abs(z) > LIMIT,
    }


def _recording(robot: str, place: int, one: dict[str, Any]) -> dict[str, Any]:
    names = ("recording", "samples", "cpu_seconds", "peak_mb", "cached", "problem")
    return {"robot": robot, "place": place, **{name: one.get(name) for name in names}}


def _alone(robot: str, place: int, one: dict[str, Any]) -> list[dict[str, Any]]:
    rows = one.get("alone") or []
    return [
        {"robot": robot, "place": place, "recording": one["recording"], "parameter": name, "value": value, "std": std}
        for name, _, value, std in rows
    ]


def _robot(robot: dict[str, Any], outliers: int) -> dict[str, Any]:
    used = [one for one in robot["recordings"] if one["problem"] is None]
    fit = [f for f in robot["fit"] if f is not None]
    diagnosis = robot.get("diagnosis") or {}
    return {
        "robot": robot["robot"], "description": robot["description"], "recordings": len(used),
        "refused": len(robot["recordings"]) - len(used), "samples": robot["samples"],
        "cutoff_hz": used[0]["cutoff_hz"] if used else None, "rank": robot["rank"],
        "residual_over_torque": sum(fit) / len(fit) if fit else None, "outliers": outliers,
        "verdict": diagnosis.get("verdict"), "problem": robot["problem"] or diagnosis.get("problem"),
    }


def _cause(robot: str, cause: dict[str, Any]) -> dict[str, Any]:
    names = ("effect", "joints", "confirmed", "confidence", "gap_closed")
    return {"robot": robot, **{name: cause[name] for name in names}}
