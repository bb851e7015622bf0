"""The driver: what waits for what, and how much of it is on its way at once."""

from __future__ import annotations

import collections
import json
import os
import pickle
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Generator, Iterable, Optional, Union
from urllib.parse import quote

from .. import _residyn
from ..accumulator import Accumulator
from . import work
from .members import Member

#: Parts that one merge takes.
FAN = 8
#: Times that a task is run again elsewhere when its machine or worker died.
RETRIES = 5

#: A task: the function and its arguments.
Call = tuple[Callable[..., dict[str, Any]], tuple[Any, ...]]
#: What a robot asks for, some tasks at a time; it is sent their results, in order.
Plan = Generator[list[Call], list[dict[str, Any]], None]


@dataclass(frozen=True)
class Fleet:
    """What a run wrote: Parquet tables and a page."""

    folder: Path

    @property
    def page(self) -> Path:
        """The page."""
        return self.folder / "fleet.html"

    def table(self, name: str) -> list[dict[str, Any]]:
        """Rows of `robots`, `recordings`, `parameters`, `over_time`, `causes` or `causes_by_robot`."""
        parquet = _needed("pyarrow.parquet")
        return parquet.read_table(self.folder / f"{name}.parquet").to_pylist()

    def outliers(self) -> list[dict[str, Any]]:
        """Parameters far from those of the other robots with the same description, furthest first."""
        rows = [row for row in self.table("parameters") if row["outlier"]]
        return sorted(rows, key=lambda row: -abs(row["z"]))


def run(
    members: Iterable[Member],
    out: Union[str, os.PathLike],
    *,
    cutoff_hz: Optional[float] = None,
    diagnose: bool = False,
    fast: bool = False,
    in_flight: Optional[int] = None,
    address: Optional[str] = None,
) -> Fleet:
    """Identifies every robot from its recordings, and compares robots with the same description.

    `cutoff_hz` is of the motion's low-pass on all robots; without it each robot's first usable recording decides for that robot.
    `diagnose` also diagnoses each robot against its description, the last recording held out, which takes far longer; with `fast`
    as `residyn.diagnose(…, fast=True)` does.
    `in_flight` tasks are on their way at once (default: two for each core of the cluster), which bounds the memory of the driver and
    of the object store. Ray is started on this machine unless it runs already or an `address` is given; it is left running.

    A recording that cannot be used is listed with its reason and left out; so is a task that fails as often as it may be run.
    """
    members = list(members)
    names = [m.name for m in members]
    twice = sorted(name for name, count in collections.Counter(names).items() if count > 1)
    if twice:
        raise _residyn.InputError(f"two robots are called {twice[0]!r}\nGive every robot a name of its own.")
    if not members:
        raise _residyn.InputError("no robot is given")
    _needed("pyarrow")
    ray = _needed("ray")
    if not ray.is_initialized():
        ray.init(address=address, include_dashboard=False, log_to_driver=False)
    folder = Path(out).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    limit = in_flight or max(2, int(2 * ray.cluster_resources().get("CPU", 1)))
    plans = (_robot(member, folder, cutoff_hz, (diagnose, fast)) for member in members)
    _drive(ray, plans, limit)

    from . import page, tables

    tables.write(folder, [_place(folder, name) for name in names])
    page.write(folder)
    return Fleet(folder)


def _needed(name: str) -> Any:
    """A package of PyPI that only fleets need."""
    import importlib

    try:
        return importlib.import_module(name)
    except ImportError:
        raise ImportError("residyn.fleet needs Ray and Arrow, which are not installed\npip install ray pyarrow") from None


def _place(folder: Path, name: str) -> Path:
    return folder / "robots" / f"{quote(name, safe='')}.json"


def _robot(member: Member, folder: Path, cutoff_hz: Optional[float], diagnosed: tuple[bool, bool]) -> Plan:
    """All that is done for one robot, ending with its file."""
    recordings = [Path(r).resolve() for r in member.recordings]
    said: list[dict[str, Any]] = []
    parts: list[str] = []
    result: dict[str, Any] = {"robot": member.name, "problem": None, "parameters": [], "fit": [], "rank": None, "samples": 0}
    try:
        robot = member.loaded()
        empty = pickle.dumps(Accumulator(robot, cutoff_hz=cutoff_hz))
        result["description"] = work.digest(work.described(robot))
    except _residyn.InputError as error:
        result.update(problem=str(error), description=None)
        recordings = []
    # The first recording that can be used decides how all are prepared.
    waiting = collections.deque(recordings)
    while waiting and not parts:
        taken = [waiting.popleft() for _ in range(1 if cutoff_hz is None else len(waiting))]
        said += yield [(work.add, (empty, recording, folder)) for recording in taken]
        parts = [one["part"] for one in said if one["problem"] is None]
    if waiting:
        empty = bytes.fromhex(said[-1]["empty"])
        said += yield [(work.add, (empty, recording, folder)) for recording in waiting]
        parts = [one["part"] for one in said if one["problem"] is None]
    told = [{**one, "recording": str(r), "empty": None} for r, one in zip(recordings, said)]
    result["recordings"] = told
    while len(parts) > 1 and result["problem"] is None:
        merged = yield [(work.merge, (parts[k : k + FAN], folder)) for k in range(0, len(parts), FAN)]
        parts = [one.get("part") for one in merged]
        result["problem"] = next((one["problem"] for one in merged if one["problem"]), None)
    if parts and result["problem"] is None:
        (found,) = yield [(work.finish, (parts[0],))]
        result.update(found)
    elif result["problem"] is None:
        result["problem"] = "none of its recordings can be used"
    diagnose, fast = diagnosed
    if diagnose and parts:
        usable = [Path(one["recording"]) for one in told if one["problem"] is None]
        (result["diagnosis"],) = yield [(work.diagnose, (robot, usable, fast, folder))]
    work.write(_place(folder, member.name), json.dumps(result).encode())


def _drive(ray: Any, plans: Iterable[Plan], limit: int) -> None:
    """Runs tasks of plans, at most `limit` at a time; a plan is begun when those before have nothing more to start."""
    remote: dict[Callable[..., dict[str, Any]], Any] = {}
    # One core for each task: many of them make the speed.
    alone = {"env_vars": {"RAYON_NUM_THREADS": "1"}}
    waiting: collections.deque[tuple[int, int, Call]] = collections.deque()
    running: dict[Any, tuple[int, int]] = {}
    active: dict[int, tuple[Plan, list[Optional[dict[str, Any]]]]] = {}
    unbegun = enumerate(plans)

    def ask(number: int, plan: Plan, results: Optional[list[dict[str, Any]]]) -> None:
        try:
            calls = next(plan) if results is None else plan.send(results)
            while not calls:
                calls = plan.send([])
        except StopIteration:
            active.pop(number, None)
            return
        active[number] = (plan, [None] * len(calls))
        waiting.extend((number, k, call) for k, call in enumerate(calls))

    while True:
        while not waiting and len(running) < limit:
            following = next(unbegun, None)
            if following is None:
                break
            ask(*following, None)
        while waiting and len(running) < limit:
            number, k, (function, arguments) = waiting.popleft()
            if function not in remote:
                options = {"num_cpus": 1, "max_retries": RETRIES, "runtime_env": alone}
                remote[function] = ray.remote(**options)(function)
            running[remote[function].remote(*arguments)] = (number, k)
        if not running:
            return
        (ready, *_), _ = ray.wait(list(running), num_returns=1)
        number, k = running.pop(ready)
        plan, results = active[number]
        try:
            results[k] = ray.get(ready)
        except ray.exceptions.RayError as error:
            # It died as often as it may, or failed with what is no refusal.
            last = str(error).strip().splitlines() or [""]
            results[k] = {"problem": f"{type(error).__name__}: {last[-1]}", "cpu_seconds": None, "peak_mb": None}
        if all(r is not None for r in results):
            ask(number, plan, [r for r in results if r is not None])
