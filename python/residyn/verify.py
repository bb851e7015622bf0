"""Whether the gap has closed in MuJoCo itself: its own inverse dynamics along the held-out motion, before and after.

    python -m residyn.verify --robot scene.xml --data monday.csv --heldout tuesday.csv --patch corrected.xml
    python -m residyn.verify --table [--effects payload,torque_ripple]
    python -m residyn.verify --replay --robot corrected.xml --given scene.xml --data tuesday.csv --report replay.json

Diagnoses, writes the corrected model, and lets MuJoCo (PyPI `mujoco`) compute the torque of both models along the held-out
motion. Beside MuJoCo's figures stand the report's, which come from this project's own dynamics. `--table` does it effect by effect on
simulated robots; `--replay` replays recorded commands, without any torque.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from typing import Optional, Sequence, Union

from . import InputError, Robot, diagnose, effects as catalogue, verify_replay
from .in_mujoco import AWAY, ROLLOUT, Row, verify


def table(rows: Sequence[Row]) -> str:
    """The figures as text."""
    lines = [f"{'NRMSE off reversals':<22}{'MuJoCo':>10}{'report':>10}{f'off after {ROLLOUT} s':>18}"]
    lines += [f"{row.model:<22}{row.mujoco:>10.4f}{row.report:>10.4f}{row.drift:>18.4f}" for row in rows]
    lines.append(f"of {100 * rows[0].share:.0f} % of the samples: faster than {AWAY} rad/s, MuJoCo's friction at its limit")
    if rows[0].left_out:
        lines.append(f"left out of the means, since no such sample is theirs or their torque never changes: {', '.join(rows[0].left_out)}")
    return "\n".join(lines)


def by_effect(effects: Sequence[str], seed: int, folder: Union[str, os.PathLike]) -> bool:
    """Prints the table effect by effect as it comes; whether MuJoCo's error is the report's throughout."""
    print(catalogue.HEAD, flush=True)
    holds = True
    for effect in catalogue.measured(effects or list(catalogue.all_effects()), seed, folder):
        print(catalogue.line(effect), flush=True)
        holds &= effect.holds
    if not holds:
        print(f"error: off by more than {100 * catalogue.CLOSE:.0f} %", file=sys.stderr)
    return holds


def names(text: str) -> list[str]:
    """Names between commas."""
    return [name for name in text.split(",") if name]


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m residyn.verify", description=__doc__.splitlines()[0])
    parser.add_argument("--robot", help="MJCF or URDF; of a URDF, what it cannot hold (rotor inertia) is set in MuJoCo")
    parser.add_argument("--joints", default="", help="joints of the arm, base first, where a scene holds more: a,b,c")
    parser.add_argument("--data", nargs="+", help="recordings that effects are fitted on")
    parser.add_argument("--heldout", help="recording that is scored")
    parser.add_argument("--patch", help="corrected model to write, beside the given one")
    parser.add_argument("--fast", action="store_true", help="skip what takes surrogates")
    parser.add_argument("--table", action="store_true", help="effect by effect on simulated robots instead; status 1 where MuJoCo's error is not the report's")
    parser.add_argument("--effects", default="", help="of --table: effects instead of all: a,b,c")
    parser.add_argument("--seed", type=int, default=1, help="of --table: seed of the simulated robots")
    parser.add_argument("--replay", action="store_true", help="replay the commands of --data in MuJoCo: --robot is the corrected MJCF")
    parser.add_argument("--given", help="of --replay: MJCF as it was, for comparison")
    parser.add_argument("--drive", help="drive file: of the recordings' columns and units; of --replay, its block [controller] stands in place of the model's actuators")
    parser.add_argument("--report", help="of --replay: JSON of `replay`, whose figures stand beside MuJoCo's and whose delays shift the commands")
    parser.add_argument("--step", type=float, default=1e-3, help="of --replay: time step beside the file's own, s")
    given = parser.parse_args(arguments)
    if given.replay and (given.robot is None or given.data is None):
        parser.error("--replay needs --robot and --data")
    if not 0.0 < given.step < 1.0:
        parser.error("--step: a time in s is needed, such as 0.001")
    needed = {"--robot": given.robot, "--data": given.data, "--heldout": given.heldout, "--patch": given.patch}
    missing = [name for name, value in needed.items() if value is None]
    if missing and not given.table and not given.replay:
        parser.error(f"{', '.join(missing)}, --table or --replay: needed")
    if given.table and given.drive is not None:
        parser.error("--table has simulated robots, without a drive file: leave --drive out")
    try:
        if given.replay:
            return verify_replay.main(given)
        if given.table:
            with tempfile.TemporaryDirectory() as folder:
                return 0 if by_effect(names(given.effects), given.seed, folder) else 1
        robot = Robot(given.robot, joints=names(given.joints), drive=given.drive)
        report = diagnose(robot, given.data, given.heldout, fast=given.fast)
        print(report)
        written = report.patch(given.patch)
        print(table(verify(report, given.robot, written)))
    except InputError as error:
        message, _, hint = str(error).partition("\n")
        print(f"error: {message}", file=sys.stderr)
        if hint:
            print(f"hint: {hint}", file=sys.stderr)
        return 2
    except ImportError as error:
        print(f"error: {error}\nhint: pip install mujoco", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
