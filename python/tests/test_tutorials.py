"""Every tutorial's blocks run as they stand, one after the other in one shell, and print what the page shows.

A page's indented blocks and those of `sh` are commands; one of `cpp` is the file that the words before it name; one of `text` is what
the commands so far have printed, with … for what is left out. They run in a folder laid out as a clone with everything built: `cargo`
there looks whether the packages and features that it is asked for exist.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import residyn

ROOT = Path(__file__).resolve().parents[2]
PAGES = {page.stem: page for page in (ROOT / "docs/tutorials").glob("*.md")}
CARGO = """#!/bin/sh
[ "$1 $2" = "build --release" ] || {{ echo "cargo $*: a tutorial builds with cargo build --release" >&2; exit 1; }}
shift 2
HOME='{home}' exec '{cargo}' tree --quiet --offline --locked --depth 0 --manifest-path '{root}/Cargo.toml' "$@" >&2
"""


def blocks(page):
    """Kind (`run`, `show`, or a file's name), first line's number and text of a page's blocks."""
    found, words, lines = [], "", iter(enumerate(page.splitlines(), 1))
    for number, line in lines:
        if line.startswith("```"):
            taken = []
            for _, inner in lines:
                if inner == "```":
                    break
                taken.append(inner)
            language = line[3:]
            named = re.findall(r"`(\w+\.%s)`" % (language or "none"), words)
            kind = {"sh": "run", "text": "show"}.get(language) or (named[-1] if named else None)
            assert kind, f"line {number}: the words before this block name no file of the kind {language!r}"
            found.append((kind, number, taken))
            words = ""
        elif line.startswith("    "):
            if found and found[-1][0] == "run" and not words:
                found[-1][2].append(line[4:])
            else:
                found.append(("run", number, [line[4:]]))
            words = ""
        else:
            words += line + "\n"
    return found


def commands(lines):
    """Whole commands: lines that end in a backslash go on."""
    return re.findall(r"(?:.*\\\n)*.*[^\\\n](?:\n|$)", "\n".join(lines))


def words(line):
    return re.sub(r"[–(),;:]", " ", line).split()


def alike(shown, printed):
    """Whether a line was printed: words as they are, numbers to 3 %, since processors round differently; … stands for any more."""
    shown = words(shown)
    cut = shown[-1:] == ["…"]
    shown, printed = shown[: len(shown) - cut], words(printed)
    if len(printed) < len(shown) or (len(printed) > len(shown) and not cut):
        return False

    def same(a, b):
        try:
            return abs(float(a) - float(b)) <= 0.03 * max(abs(float(a)), abs(float(b)))
        except ValueError:
            return a == b

    return all(map(same, shown, printed))


def missing(shown, printed):
    """The first line that a page shows and that was not printed after those before it; None where all were."""
    rest = iter(printed)
    wanted = (line for line in shown if line.strip() not in ("", "…"))
    return next((line for line in wanted if not any(alike(line, p) for p in rest)), None)


def script(page, folder):
    """Writes the page's files, and returns its commands as one script, with a mark before each block that shows or runs something."""
    lines = ["fail() { echo \"line $1: status $2\"; exit 1; }"]
    for kind, number, text in blocks(page):
        if kind == "run":
            for command in commands(text):
                lines += [command.strip(), f"status=$?; [ $status = 0 ] || fail {number} $status"]
        elif kind == "show":
            lines.append(f"printf '\\n<<<{number}>>>\\n'")
        else:
            (folder / kind).write_text("\n".join(text) + "\n")
    return "\n".join(lines) + "\n"


@pytest.fixture
def clone(program, tmp_path):
    """A folder as a clone is after `cargo build`, with a home of its own; runs a page in it and returns what is printed."""
    folder, home, tools = (tmp_path / name for name in ("clone", "home", "tools"))
    for made in (folder / "target", home, tools):
        made.mkdir(parents=True)
    (folder / "target/release").symlink_to(Path(os.environ["RESIDYN_BIN"]).resolve())
    for part in ("capi", "recipes"):
        shutil.copytree(ROOT / part, folder / part)
    shutil.copy(ROOT / "Cargo.toml", folder)
    cargo = shutil.which("cargo")
    if cargo is None:
        pytest.skip("there is no cargo: the packages that a tutorial builds cannot be looked up")
    (tools / "cargo").write_text(CARGO.format(home=os.environ.get("HOME", "/"), cargo=cargo, root=ROOT))
    (tools / "cargo").chmod(0o755)
    path = os.pathsep.join([str(tools), str(Path(sys.executable).parent), os.environ["PATH"]])
    environment = {**os.environ, "HOME": str(home), "PATH": path}
    environment.pop("PKG_CONFIG_PATH", None)

    def run(page):
        ran = subprocess.run(["bash"], input=script(page, folder), cwd=folder, env=environment, text=True, stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT)
        assert ran.returncode == 0, ran.stdout[-3000:]
        return ran.stdout

    run.folder = folder
    return run


def recordings_of_a_desktop_arm(folder):
    """MJCF and two real recordings of an SO-101, as tables in degrees."""
    shared = ROOT.parent / "shared/data/so101"
    if not shared.is_dir() and os.environ.get("RESIDYN_REQUIRE_SHARED") != "1":
        pytest.skip(f"{shared} is not there")
    shutil.copy(shared / "so101.xml", folder)
    motors = ["shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll"]
    header = ",".join(["timestamp", *(f"{m}.{what}" for m in motors for what in ("pos", "goal"))])
    for name, motion in (("monday", "multisine"), ("friday", "friction_gravity")):
        read = residyn.Recording.read(shared / f"{motion}.parquet")
        both = np.degrees(np.stack([read.q, read.q_ref], axis=2)).reshape(len(read), -1)
        np.savetxt(folder / f"{name}.csv", np.column_stack([read.time, both]), delimiter=",", header=header, comments="", fmt="%.17g")


def bags_of_a_ur5e(folder):
    """URDF and recordings of the demo as its driver publishes them, and one of the same motion with 2 kg at the flange."""
    pytest.importorskip("mcap", reason="PyPI mcap is not installed: no bag can be written")
    pytest.importorskip("rosbags", reason="PyPI rosbags is not installed: no bag can be written")
    from bags import ur5e

    subprocess.run([folder / "target/release/residyn", "demo", "--out", folder / "demo"], check=True, capture_output=True)
    shutil.copy(folder / "demo/robot.urdf", folder / "ur5e.urdf")
    robot = residyn.Robot(str(folder / "ur5e.urdf"))
    for name in ("monday", "friday"):
        ur5e(folder / f"{name}.mcap", residyn.Recording.read(folder / f"demo/{name}.parquet"), robot.joints)
    shutil.copy(folder / "friday.mcap", folder / "empty.mcap")
    read = residyn.Recording.read(folder / "demo/friday.parquet")
    qdd = np.gradient(read.qd, read.time, axis=0)
    mass = robot.parameter_names.index("m6")
    added = 2.0 * robot.regressor(read.q, read.qd, qdd)[:, :, mass]
    ur5e(folder / "loaded.mcap", residyn.Recording(read.time, read.q, read.tau + added, qd=read.qd, starts=read.starts), robot.joints)


#: What a reader has, by tutorial.
HAS = {
    "first-diagnosis": lambda folder: None,
    "feedforward-cpp": lambda folder: None,
    "so101-without-torque": recordings_of_a_desktop_arm,
    "ur5e-ros2-bag": bags_of_a_ur5e,
}


@pytest.mark.parametrize("name", sorted(PAGES))
def test_a_tutorial_runs_as_written(name, clone):
    text = PAGES[name].read_text()
    HAS[name](clone.folder)
    said = re.split(r"\n<<<(\d+)>>>\n", clone(text))
    printed = dict(zip(map(int, said[1::2]), said[0::2]))
    shown = {number: lines for kind, number, lines in blocks(text) if kind == "show"}
    assert shown and shown.keys() == printed.keys()
    for number, lines in shown.items():
        lost = missing(lines, printed[number].splitlines())
        assert lost is None, f"{PAGES[name]}:{number} shows\n{lost}\nof\n{printed[number][-3000:]}"


def test_a_failing_block_and_a_line_that_is_not_printed_are_told(clone):
    with pytest.raises(AssertionError, match="line 3: status 1"):
        clone("# Page\n\n    true && false\n\n    echo later\n")
    with pytest.raises(AssertionError, match="no-such-package|did not match"):
        clone("# Page\n\n```sh\ncargo build --release -p no-such-package && echo built\n```\n")
    assert missing(["mass 1.20 ± 0.05 kg …", "…"], ["mass 1.21 ± 0.05 kg on link"]) is None
    for shown, printed in (("mass 1.20 ± 0.05 kg", "mass 1.21 ± 0.05 kg on link"), ("mass 1.20 kg", "mass 1.30 kg"), ("a", "b")):
        assert missing([shown], [printed]) == shown
    assert missing(["b", "a"], ["a", "b"]) == "a"
