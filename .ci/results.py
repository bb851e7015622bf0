#!/usr/bin/env python3
"""Tables of docs/results.md and of the README, from the result files in docs/results/.

Between `<!-- results: NAME -->` and `<!-- end -->` a page holds what is made here: the table and commands of docs/results/NAME.json, or
the table `provenance`, or `summary`. All else on the pages is written by hand.

usage: results.py                                   writes the tables
       results.py --check                           exit 1 where a page is not what the files say
       results.py --record NAME [--bin FOLDER] [--commit HASH]
                                                    measures docs/results/NAME.json again with the programs of FOLDER (target/release):
                                                    real_arms, real_motion, written_models (with the Python package, as .ci/run leaves it)
       results.py --record NAME --leaderboard FILE  takes ur5.json or kr300.json from what `eval --leaderboard … --json FILE` wrote
The commit is what `residyn --version` says; --commit where it says none.
"""

import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs/results"
SHARED = ROOT.parent / "shared/data"
PAGES = ["docs/results.md", "README.md"]
SCHEMA = "results/1"
#: Files in the order of the table of provenance.
ORDER = ["ur5", "kr300", "real_arms", "causes", "written_models", "real_motion", "fit_speed"]
SO101 = "shoulder_pan,shoulder_lift,elbow_flex,wrist_flex,wrist_roll"


def stored(name):
    """A result file."""
    found = json.loads((FOLDER / f"{name}.json").read_text())
    if found["schema"] != SCHEMA:
        raise SystemExit(f"docs/results/{name}.json: schema {found['schema']}, not {SCHEMA}")
    return found


def interval(value, digits):
    """A value with its interval, of one to three numbers."""
    if value is None:
        return "–"
    number, *ends = (f"{x:.{digits}f}" for x in value)
    return f"{number} [{', '.join(ends)}]" if ends else number


def leaderboard(rows):
    """Columns of a leaderboard; the least error of each is bold."""

    def best(key):
        return min(row[key][0] for row in rows if row[key])

    def cell(row, key):
        text = interval(row[key], 4)
        return f"**{text}**" if row[key] and row[key][0] == best(key) else text

    return {
        "model": lambda r: r["model"],
        "from": lambda r: r["of"],
        "mean NRMSE:": lambda r: cell(r, "all"),
        "in motion:": lambda r: cell(r, "moving"),
        "parameters:": lambda r: r["parameters"] or "–",
    }


#: Heading and cell of each column, by file; a heading that ends in a colon has its figures on the right.
TABLES = {
    "ur5": leaderboard,
    "kr300": leaderboard,
    "real_arms": lambda rows: {
        "recording": lambda r: r["recording"],
        "plain least squares": lambda r: f"{r['plain']:.3f}",
        "`train --physics-only`": lambda r: f"{r['physics']:.4f}",
    },
    "causes": lambda rows: {
        "cases": lambda r: r["cases"],
        "single effects named first": lambda r: f"{interval(r['first'], 2)} of {r['of']}",
        "leniently": lambda r: interval(r["lenient"], 2),
        "a false cause beside": lambda r: interval(r["extra"], 2),
        "false alarm where nothing is wrong": lambda r: r["alarm"],
        "unknown effect told": lambda r: r["unknown"],
    },
    "written_models": lambda rows: {
        "arm": lambda r: r["arm"],
        "payload, kg:": lambda r: str(r["payload"]),
        "found, kg:": lambda r: f"{r['mass']:.4f} ± {r['std']:.4f}",
        "mass and principal inertias of a link over the description's:": lambda r: "–".join(f"{x:.2f}" for x in r["size"]),
        "error as given, mrad:": lambda r: f"{r['given']:.2f}",
        "corrected:": lambda r: f"{r['corrected']:.3f}",
        "ratio:": lambda r: f"{r['ratio']:.4f}",
    },
    "real_motion": lambda rows: {
        "robot, held-out motion": lambda r: f"{r['robot']}, `{r['motion']}`",
        "as given:": lambda r: f"{r['given']:.3f}",
        "corrected:": lambda r: f"{r['corrected']:.3f}",
    },
    "fit_speed": lambda rows: {
        "fit": lambda r: r["fit"],
        "best cost:": lambda r: f"{r['cost']:.1f}",
        "time:": lambda r: f"{r['seconds']:.2f} s",
        "processor time:": lambda r: f"{r['cpu']:.2f} s",
    },
}


def table(columns, rows):
    """A Markdown table."""
    names = [name.rstrip(":") for name in columns]
    rules = ["---:" if name.endswith(":") else "---" for name in columns]
    cells = [[cell(row) for cell in columns.values()] for row in rows]
    return "\n".join([f"| {' | '.join(names)} |", f"|{'|'.join(rules)}|", *(f"| {' | '.join(line)} |" for line in cells)])


def summary():
    """The README's table: at most ten rows, real robots first."""
    row = {name: stored(name)["rows"] for name in ORDER}
    kr300 = {(r["model"], r["of"]): r["all"][0] for r in row["kr300"]}
    arms = {r["robot"]: r for r in row["real_arms"]}
    moved = {(r["robot"], r["motion"]): r for r in row["real_motion"]}
    z1, so101 = moved["Unitree Z1", "test"], moved["SO-101", "friction_gravity"]
    written = row["written_models"]
    names = len({r["arm"].split(",")[0] for r in written})
    worst = max(r["ratio"] for r in written)
    numbers = {2: "two", 4: "four", 6: "six", 8: "eight", 10: "ten"}
    lines = [
        ("KUKA KR300, benchmark", "torque, mean NRMSE; published linear model", f"{kr300['linear matrix A', 'published, test']:.2f}",
         f"{kr300['physics+compensator', 'kr300-model']:.3f}"),
        *((name, what, f"{arms[key]['plain']:.3f}", f"{arms[key]['physics']:.3f}") for key, name, what in (
            ("panda", "Franka Panda, 1 kHz", "torque by the physics alone; plain least squares"),
            ("ur10", "UR10, 125 Hz", "the same"),
            ("xmate", "Rokae xMate, 1 kHz", "the same"))),
        ("Unitree Z1", "motion left unexplained; vendor's model", f"{z1['given']:.2f}", f"{z1['corrected']:.2f}"),
        ("SO-101, `friction_gravity`", "the same; makers' model", f"{so101['given']:.2f}", f"{so101['corrected']:.2f}"),
        (f"{numbers.get(names, names)} simulated arms", "motion in MuJoCo under another command, error over the given model's", "1",
         f"≤ {math.ceil(1e3 * worst) / 1e3:.3f}"),
        *((f"simulated, {r['cases'].split(', ')[1]} {r['cases'].split(',')[0]} cases", f"right cause named first, of {r['of']}", "–",
           f"{r['first'][0]:.2f}") for r in row["causes"][1:]),
    ]
    heads = ("robot", "measure", "as given, or baseline:", "residyn:")
    return table({head: lambda r, i=i: r[i] for i, head in enumerate(heads)}, lines)


def provenance():
    """Commit, seed and what was looked at, of every table."""
    rows = [line for name in ORDER for line in stored(name)["provenance"]]
    keys = {"table": "table", "commit": "commit", "seed": "seed", "what was looked at": "looked_at"}
    return table({head: lambda r, key=key: r[key] for head, key in keys.items()}, rows)


def made(name):
    """What stands between a page's markers."""
    if name in ("summary", "provenance"):
        return {"summary": summary, "provenance": provenance}[name]()
    found = stored(name)
    return table(TABLES[name](found["rows"]), found["rows"]) + "\n\n" + "\n".join(f"    {line}" for line in found["commands"])


def filled(text):
    """A page with its tables made again."""
    return re.sub(r"(<!-- results: (\w+) -->\n+).*?(\n<!-- end -->)", lambda m: m[1] + made(m[2]) + m[3], text, flags=re.S)


def check():
    """Faults of pages and files."""
    texts = {page: (ROOT / page).read_text() for page in PAGES}
    faults = [f"{page} is not what docs/results/ says: python3 .ci/results.py" for page, text in texts.items() if filled(text) != text]
    shown = [name for text in texts.values() for name in re.findall(r"<!-- results: (\w+) -->", text)]
    wanted = [*ORDER, "provenance", "summary"]
    faults += [f"{name} stands {shown.count(name)} times on the pages, not once" for name in wanted if shown.count(name) != 1]
    return faults + [f"docs/results/{f.name} is on no page" for f in FOLDER.glob("*.json") if f.stem not in ORDER]


def run(*command, **more):
    """What a program writes to standard output."""
    return subprocess.run(list(map(str, command)), check=True, stdout=subprocess.PIPE, text=True, **more).stdout


def real_arms(programs, rows):
    """Error of the identified physics on each arm's held-out recording."""
    for row in rows:
        data = SHARED / row["robot"]
        with tempfile.TemporaryDirectory() as out:
            run(programs / "residyn", "train", "--robot", data / "robot.urdf", "--data", data / "train.csv", "--heldout", data / "test.csv", "--out", out,
                "--physics-only", "--quiet")
            scores = json.loads((Path(out) / "metrics.json").read_text())
        physics = [r for r in scores["heldout"] if r["name"] == "physics" and r["scope"] == "all"]
        yield {**row, "physics": physics[0]["mean_nrmse"]}


def real_motion(programs, rows):
    """Unexplained part of each held-out motion, as given and corrected."""
    for row in rows:
        if row["robot"] == "SO-101":
            data = SHARED / "so101"
            fitted = ["--fast", "--robot", data / "so101.xml", "--joints", SO101, "--data", data / "multisine.parquet", data / "prbs_excitation.parquet"]
        else:
            data = SHARED / "z1"
            fitted = ["--robot", data / "z1.xml", "--drive", data / "drive.toml", "--data", data / "train.parquet"]
        with tempfile.TemporaryDirectory() as out:
            report = Path(out) / "gap.json"
            run(programs / "residyn", "replay", *fitted, "--heldout", data / f"{row['motion']}.parquet", "--json", report)
            ladder = json.loads(report.read_text())["ladder"]
        yield {**row, "given": ladder[0]["mean_unexplained"], "corrected": ladder[-1]["mean_unexplained"]}


def written_models(programs, rows):
    """What python/tests/test_written_models.py prints."""
    said = run(sys.executable, "-m", "pytest", "-q", "-s", ROOT / "python/tests/test_written_models.py",
               env={**os.environ, "RESIDYN_BIN": str(programs.resolve())})
    for line in re.findall(r"^\| (.*) \|$", said, re.M):
        arm, payload, found, size, *errors = line.split(" | ")
        mass, std = map(float, found.split(" ± "))
        given, corrected, ratio = map(float, errors)
        yield {"arm": arm, "payload": float(payload), "mass": mass, "std": std, "size": [float(x) for x in size.split("–")],
               "given": given, "corrected": corrected, "ratio": ratio}


def ranked(path):
    """Rows of a leaderboard that `eval` wrote, the least error first."""
    rows = json.loads(Path(path).read_text())["rows"]
    for row in sorted(rows, key=lambda r: r["all"]["mean_nrmse"]):
        scores = {key: [round(x, 4) for x in (row[key]["mean_nrmse"], *(row[key]["mean_nrmse_interval"] or []))]
                  for key in ("all", "moving") if row[key]}  # fmt: skip
        sizes = [str(n) for n in (row["parameters"], row["network_parameters"]) if n is not None]
        origin = f"published, {row['published']['part']}" if row["published"] else ", ".join(Path(d).name for d in row["directories"])
        yield {"model": row["model"], "of": origin, "all": scores["all"], "moving": scores.get("moving"), "parameters": " + ".join(sizes) or None}


RECORDED = {"real_arms": real_arms, "real_motion": real_motion, "written_models": written_models}


def record(given):
    """Measures a file again."""
    found = stored(given.record)
    programs = Path(given.bin)
    said = re.search(r"\((\w+)\)", run(programs / "residyn", "--version"))
    commit = given.commit or (said and said[1][:8])
    if not commit:
        raise SystemExit(f"{programs}/residyn says no commit: --commit")
    if given.leaderboard:
        rows = list(ranked(given.leaderboard))
    elif given.record in RECORDED:
        rows = list(RECORDED[given.record](programs, found["rows"]))
    else:
        raise SystemExit(f"docs/results/{given.record}.json is measured by its own commands: {'; '.join(found['commands'])}")
    found["rows"] = rows
    for line in found["provenance"]:
        line["commit"] = commit
    (FOLDER / f"{given.record}.json").write_text(laid_out(found))


def laid_out(found):
    """A file with a row in each line."""

    def value(v):
        if not isinstance(v, list):
            return json.dumps(v, ensure_ascii=False)
        return "[\n" + ",\n".join(f"    {json.dumps(x, ensure_ascii=False)}" for x in v) + "\n  ]"

    return "{\n" + ",\n".join(f"  {json.dumps(k)}: {value(v)}" for k, v in found.items()) + "\n}\n"


def main(arguments):
    parser = argparse.ArgumentParser(usage=__doc__.partition("usage: ")[2])
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--record")
    parser.add_argument("--leaderboard")
    parser.add_argument("--bin", default=str(ROOT / "target/release"))
    parser.add_argument("--commit")
    given = parser.parse_args(arguments)
    if given.check:
        faults = check()
        print("\n".join(faults) or f"results: {len(ORDER)} files, all tables are what they say")
        return 1 if faults else 0
    if given.record:
        record(given)
    for page in PAGES:
        path = ROOT / page
        path.write_text(filled(path.read_text()))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
