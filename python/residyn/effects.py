"""Effect by effect: a simulated robot that has it, its diagnosis, and what MuJoCo makes of the corrected model.

The table of `python -m residyn.verify --table`. Recordings are those of `simulate cases --only EFFECT`; MuJoCo converts their URDF.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Iterator, Sequence, Union

from . import InputError, Report, Robot, _residyn, diagnose
from .in_mujoco import Row, verify

#: How far MuJoCo's error may be from the report's, relative.
CLOSE = 0.05


@dataclass(frozen=True)
class Effect:
    """An effect in MuJoCo: mean over joints of the NRMSE away from reversals."""

    effect: str
    #: Where the patch holds it; `generated code`, or why nothing does.
    held: str
    #: What the diagnosis named; empty where none was made.
    causes: tuple[str, ...] = ()
    #: As given, patched and, where there is generated code, patched with it.
    rows: tuple[Row, ...] = ()

    @property
    def off(self) -> float:
        """How far MuJoCo's error with everything in place is from the report's, relative."""
        last = self.rows[-1]
        return last.mujoco / last.report - 1.0

    @property
    def holds(self) -> bool:
        """Whether MuJoCo's error is the report's, or nothing was asked of it."""
        return not self.rows or abs(self.off) <= CLOSE


def all_effects() -> dict[str, str]:
    """Every effect of the catalogue with where a patched MJCF holds it, or why nothing does."""
    return dict(_residyn.effects())


def measured(effects: Sequence[str], seed: int, folder: Union[str, os.PathLike]) -> Iterator[Effect]:
    """Each effect on the first case that the seed deals of it; those that nothing holds, without one. Files go into `folder`."""
    held = all_effects()
    unknown = [name for name in effects if name not in held]
    if unknown:
        raise InputError(f"{', '.join(unknown)}: no such effect\nThere are {', '.join(held)}.")
    for name in effects:
        if held[name] not in ("MJCF", "generated code"):
            yield Effect(name, held[name])
            continue
        place = Path(folder) / name
        case = _residyn.simulate_case(name, seed, place)
        scene = place / "robot.xml"
        converted(case / "robot.urdf", scene)
        report = diagnose(Robot(str(scene)), case / "train.parquet", case / "test.parquet", fast=True)
        yield _of(name, held[name], report, scene)


def _of(name: str, held: str, report: Report, scene: Path) -> Effect:
    written = report.patch(scene.with_name("corrected.xml"))
    rows = verify(report, scene, written, rollouts=False)
    causes = tuple(dict.fromkeys(cause.effect for cause in report.causes))
    return Effect(name, held, causes, tuple(rows))


def converted(urdf: Path, scene: Path) -> None:
    """A URDF as the MJCF that MuJoCo itself makes of it."""
    import mujoco

    mujoco.mj_saveLastXML(str(scene), mujoco.MjModel.from_xml_path(str(urdf)))


HEAD = f"{'effect':<28}{'as given':>10}{'report':>10}{'patched':>10}{'with code':>11}{'off':>9}{'samples':>9}  named"


def line(effect: Effect) -> str:
    """A line of the table."""
    if not effect.rows:
        return f"{effect.effect:<28}{effect.held}"
    given, patched, *coded = (f"{row.mujoco:.4f}" for row in effect.rows)
    report, code = f"{effect.rows[-1].report:.4f}", coded[0] if coded else "-"
    off = f"{100 * effect.off:+.1f} %"
    return f"{effect.effect:<28}{given:>10}{report:>10}{patched:>10}{code:>11}{off:>9}{effect.rows[0].share:>9.0%}  {', '.join(effect.causes)}"
