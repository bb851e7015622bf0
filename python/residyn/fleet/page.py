"""The page of a fleet: one file that stands alone."""

from __future__ import annotations

import html
from pathlib import Path
from typing import Any, Optional, Sized

import numpy as np
import pyarrow.compute as pc
import pyarrow.parquet as pq

from . import work
from .tables import FEWEST, LIMIT, robust

#: Rows of a list on the page, at most; the tables have all.
_MOST = 50

_STYLE = """
:root { color-scheme: light dark; --line: #8886; --mark: #c0392b; }
body { font: 15px/1.5 system-ui, sans-serif; max-width: 70em; margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.5em; } h2 { font-size: 1.15em; margin-top: 2em; }
table { border-collapse: collapse; } th, td { padding: .2em .8em; border-bottom: 1px solid var(--line); text-align: left; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; } td.path { font-size: .85em; }
svg { vertical-align: middle; } .scroll { overflow-x: auto; }
"""


def write(folder: Path) -> None:
    """Writes `fleet.html` from the tables beside it."""
    robots = pq.read_table(folder / "robots.parquet").to_pylist()
    parameters = pq.read_table(folder / "parameters.parquet")
    outliers = parameters.filter(pc.field("outlier")).to_pylist()
    outliers.sort(key=lambda row: -abs(row["z"]))
    causes = pq.read_table(folder / "causes.parquet").to_pylist()
    recordings = pq.read_table(folder / "recordings.parquet").to_pylist()
    refused = [row for row in recordings if row["problem"]]
    troubled = [row for row in robots if row["problem"]]
    marked = len({row["robot"] for row in outliers})
    body = [
        "<h1>Fleet</h1>",
        f"<p>{len(robots)} robots, {len(recordings)} recordings, {sum(row['samples'] or 0 for row in robots):,} samples. "
        f"{marked} robots have parameters more than {LIMIT:g} robust deviations from those of the other robots with their description "
        f"(from {FEWEST} robots on); {len(refused)} recordings and {len(troubled)} robots have problems.</p>",
        "<h2>Robots that stand out</h2>",
        _list(
            ["robot", "parameter", "value", "± std", "unit", "fleet's median", "z", "recording by recording"],
            [_outlier(folder, row) for row in outliers[:_MOST]],
            outliers,
            "No robot does.",
        ),
    ]
    if any(row["verdict"] for row in robots):
        body += [
            "<h2>Causes of the gap to the description</h2>",
            _list(
                ["cause", "robots", "of", "which"],
                [[c["effect"], c["robots"], c["of"], ", ".join(c["names"][:10]) + (" …" if len(c["names"]) > 10 else "")] for c in causes],
                causes,
                "None was found.",
            ),
        ]
    problems = [[row["robot"], "", row["problem"]] for row in troubled]
    problems += [[row["robot"], row["recording"], row["problem"]] for row in refused]
    spread = _spread(parameters)
    body += [
        "<h2>Problems</h2>",
        _list(["robot", "recording", "what"], problems[:_MOST], problems, "None."),
        "<h2>Parameters over the fleet</h2>",
        _list(["parameter", "unit", "robots", "median", "robust deviation", "lowest", "highest"], spread, spread, "None."),
    ]
    text = "\n".join(body)
    page = f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Fleet</title><style>{_STYLE}</style><body>{text}</body></html>\n'
    work.write(folder / "fleet.html", page.encode())


def _cell(value: Any) -> str:
    if isinstance(value, _Markup):
        return f"<td>{value}</td>"
    if isinstance(value, float):
        return f'<td class="n">{value:.4g}</td>'
    if isinstance(value, int):
        return f'<td class="n">{value}</td>'
    return f"<td>{html.escape(str(value))}</td>"


class _Markup(str):
    """Text that is markup already."""


def _list(head: list[str], rows: list[list[Any]], all_rows: Sized, none: str) -> str:
    if not rows:
        return f"<p>{none}</p>"
    lines = ["".join(f"<th>{html.escape(name)}</th>" for name in head)]
    lines += ["".join(map(_cell, row)) for row in rows]
    more = len(all_rows) - len(rows)
    rest = f"<p>… and {more} more in the tables.</p>" if more else ""
    return '<div class="scroll"><table>' + "".join(f"<tr>{line}</tr>" for line in lines) + f"</table></div>{rest}"


def _outlier(folder: Path, row: dict[str, Any]) -> list[Any]:
    wanted = (pc.field("robot") == row["robot"]) & (pc.field("parameter") == row["parameter"])
    over_time = pq.read_table(folder / "over_time.parquet", filters=wanted)
    values = over_time.column("value").to_numpy()
    names = ("robot", "parameter", "value", "std", "unit", "median", "z")
    return [*(row[name] for name in names), _Markup(_curve(values, row["median"]))]


def _curve(values: np.ndarray, median: Optional[float], width: int = 120, height: int = 24) -> str:
    """Values in order as a small line, with the fleet's median dashed."""
    if len(values) < 2 or median is None:
        return ""
    low, high = min(values.min(), median), max(values.max(), median)
    scale = (height - 4) / (high - low) if high > low else 0.0
    y = height - 2 - (values - low) * scale
    x = 2 + np.arange(len(values)) * (width - 4) / (len(values) - 1)
    line = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y))
    middle = height - 2 - (median - low) * scale
    return (
        f'<svg width="{width}" height="{height}" role="img" aria-label="{len(values)} recordings">'
        f'<line x1="0" x2="{width}" y1="{middle:.1f}" y2="{middle:.1f}" stroke="currentColor" stroke-dasharray="3" opacity=".5"/>'
        f'<polyline points="{line}" fill="none" stroke="var(--mark)"/></svg>'
    )


def _spread(parameters: Any) -> list[list[Any]]:
    """Of each parameter over all robots with one description."""
    keys = list(zip(parameters.column("description").to_pylist(), parameters.column("parameter").to_pylist()))
    values, units = parameters.column("value").to_numpy(), parameters.column("unit").to_pylist()
    several = len({description for description, _ in keys}) > 1
    places: dict[tuple[str, str], list[int]] = {}
    for k, key in enumerate(keys):
        places.setdefault(key, []).append(k)
    out = []
    for (description, name), rows in places.items():
        own = values[rows]
        median, deviation = robust(own)
        label = f"{name} ({description[:6]})" if several else name
        out.append([label, units[rows[0]], len(rows), median, deviation, float(own.min()), float(own.max())])
    return out
