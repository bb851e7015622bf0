"""Curves over time with matplotlib, which is imported when one is drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Mapping, Optional, Sequence

import numpy as np

from . import _residyn

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Colours as in the report: told apart by those who do not see red and green, too.
COLOURS = {"measured": "#1b1f24", "command": "#b7791f", "as given": "#9aa3ae", "corrected": "#0b6bcb", "physics": "#9aa3ae", "model": "#0b6bcb"}
#: Trajectories are drawn so far apart, s.
APART = 0.5


def trajectories(time: np.ndarray) -> list[slice]:
    """Rows of each trajectory of a recording: time goes back, or leaps."""
    steps = np.diff(time)
    if len(steps) == 0:
        return [slice(0, len(time))]
    breaks = np.flatnonzero((steps <= 0) | (steps > 10 * np.median(np.abs(steps)))) + 1
    return [slice(a, b) for a, b in zip([0, *breaks], [*breaks, len(time)])]


def one_after_another(time: np.ndarray, parts: Sequence[slice]) -> np.ndarray:
    """Time along one axis on which trajectories follow each other, s."""
    out = np.empty(len(time))
    end = -APART
    for part in parts:
        out[part] = time[part] - time[part.start] + end + APART
        end = out[part.stop - 1]
    return out


def chosen(joints: Sequence[str], wanted: Optional[Sequence[str]]) -> list[int]:
    """Indices of joints by their names; all where none is named."""
    if wanted is None:
        return list(range(len(joints)))
    wanted = [wanted] if isinstance(wanted, str) else list(wanted)
    missing = [name for name in wanted if name not in joints]
    if missing or not wanted:
        raise _residyn.InputError(f"there is no joint {missing[0] if missing else ''}; there are: {', '.join(joints)}")
    return [list(joints).index(name) for name in wanted]


def over_time(
    time: np.ndarray,
    parts: Sequence[slice],
    curves: Mapping[str, np.ndarray],
    joints: Sequence[str],
    wanted: Optional[Sequence[str]],
    unit: str,
    band: Optional[np.ndarray] = None,
) -> "Figure":
    """A figure with an axis for each joint. `curves` have the shape (samples, joints); `band` is the standard deviation of the last one."""
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError("plot() draws with matplotlib: pip install matplotlib") from error
    rows = chosen(joints, wanted)
    figure, grid = pyplot.subplots(len(rows), 1, sharex=True, squeeze=False, figsize=(9.0, 0.6 + 1.7 * len(rows)), layout="constrained")
    axes: Any = grid[:, 0]
    *_, last = curves
    clock = one_after_another(time, parts)
    for axis, j in zip(axes, rows):
        for name, values in curves.items():
            for number, part in enumerate(parts):
                axis.plot(clock[part], values[part, j], color=COLOURS[name], linewidth=0.9, label=name if number == 0 else None)
        if band is not None:
            low, high = (curves[last][:, j] + sign * band[:, j] for sign in (-1, 1))
            for part in parts:
                axis.fill_between(clock[part], low[part], high[part], color=COLOURS[last], alpha=0.2, linewidth=0)
        axis.set_ylabel(f"{joints[j]}\n{unit}")
        axis.margins(x=0)
        axis.grid(alpha=0.3)
    axes[-1].set_xlabel("time / s")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper right", ncols=len(curves), frameon=False)
    return figure
