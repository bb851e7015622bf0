"""Form in which a loop keeps the weights: chosen by `eval --weights` on a recording that the model has not seen."""

import json
import struct

import numpy as np


def header(directory):
    """Header of a compensator, from its file."""
    content = (directory / "compensator.safetensors").read_bytes()
    (length,) = struct.unpack("<Q", content[:8])
    envelope = json.loads(content[8 : 8 + length])["__metadata__"]["residyn"]
    return json.loads(json.loads(envelope)["header"])


def predicted(program, model, data, out):
    program("eval", "--model", model, "--data", data, "--predict", out, "--quiet")
    table = np.genfromtxt(out, delimiter=",", names=True)
    names = [n for n in table.dtype.names if n.startswith("tau") and not n.endswith("_std")]
    return np.stack([table[n] for n in names], axis=1)


def test_a_form_is_written_where_the_error_hardly_grows(program, tmp_path):
    program("simulate", "cases", "--only", "stribeck_friction", "--cases", "1", "--seed", "3", "--out", tmp_path / "sim")
    (case,) = (tmp_path / "sim" / "cases").iterdir()
    plain = tmp_path / "plain"
    training = ["--robot", case / "robot.urdf", "--data", case / "train.parquet", "--members", "1", "--epochs", "5"]
    program("train", *training, "--out", plain, "--quiet")
    held_out = case / "test.parquet"
    whole = predicted(program, plain, held_out, tmp_path / "plain.csv")
    assert all("weights" not in unit for unit in header(plain)["units"])
    for form in ["bf16", "int8"]:
        narrow = tmp_path / form
        said = program("eval", "--model", plain, "--data", held_out, "--weights", form, "--out", narrow)
        assert "growth of the torque's error" in " ".join(said.stdout.split())
        assert all(unit["weights"] == form for unit in header(narrow)["units"])
        torque = predicted(program, narrow, held_out, tmp_path / f"{form}.csv")
        changed = np.sqrt(np.mean((torque - whole) ** 2))
        assert 0 < changed < 0.01 * np.sqrt(np.mean(whole**2))
        # Single precision is still there: the first model's file comes back byte for byte.
        back = tmp_path / f"{form}-back"
        program("eval", "--model", narrow, "--data", held_out, "--weights", "f32", "--out", back, "--quiet")
        again = (back / "compensator.safetensors").read_bytes()
        assert again == (plain / "compensator.safetensors").read_bytes()
