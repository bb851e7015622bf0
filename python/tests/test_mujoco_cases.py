"""Cases with MuJoCo as the plant (`trials/mujoco/cases.py`): the same seed writes the same bytes, and `diagnose` names what is withheld."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import residyn

pytest.importorskip("mujoco", reason="PyPI mujoco is not installed: no cases are made with it")
pytest.importorskip("pyarrow", reason="PyPI pyarrow is not installed: cases cannot be written")

SCRIPT = Path(__file__).resolve().parents[2] / "trials/mujoco/cases.py"


def made(folder, *arguments):
    """The answer to the one case that the script writes into `folder`, and its files' bytes by name."""
    command = [sys.executable, str(SCRIPT), "--cases", "1", "--out", str(folder), *arguments]
    ran = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
    assert ran.returncode == 0, ran.stderr
    files = {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}
    truth = next(json.loads(text) for name, text in files.items() if name.startswith("truth"))
    return truth, files


def test_the_same_seed_writes_the_same_bytes_and_the_effect_is_named(tmp_path):
    arguments = ("--seed", "3", "--only", "torque_gain")
    truth, files = made(tmp_path / "a", *arguments)
    assert made(tmp_path / "b", *arguments)[1] == files
    withheld = truth["effects"][0]
    assert withheld["effect"] == "torque_gain" and 0.05 <= withheld["share"] <= 0.35
    case = tmp_path / "a" / "cases" / truth["case"]
    found = residyn.diagnose(case / "robot.xml", case / "train.parquet", case / "test.parquet", fast=True)
    causes = [c for c in found.raw["causes"] if c["kind"] == "structure"]
    assert [c["effect"] for c in causes] == ["torque_gain"], causes
    assert causes[0]["joints"] == withheld["joints"]
    value = {p["name"]: p for p in causes[0]["parameters"]}["gain"]
    assert value["value"] == pytest.approx(withheld["parameters"]["gain"], abs=3 * value["std"])
