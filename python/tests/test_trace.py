"""`diagnose --trace`: torque over time in the two formats that plotters read, and the report's own errors in it."""

import json

import numpy as np
import pytest

parquet = pytest.importorskip("pyarrow.parquet", reason="PyPI pyarrow is not installed: traces are not read")
reader = pytest.importorskip("mcap.reader", reason="PyPI mcap is not installed: traces are not read")


@pytest.fixture(scope="module")
def traced(program, tmp_path_factory):
    """Folder with the recordings of `residyn demo`, its report, and its trace in both formats."""
    folder = tmp_path_factory.mktemp("demo")
    program("residyn", "demo", "--out", folder)
    given = ("diagnose", "--robot", folder / "robot.urdf", "--data", folder / "monday.parquet", "--heldout", folder / "friday.parquet", "--fast")
    for name in ("trace.parquet", "trace.mcap"):
        said = program(*given, "--json", folder / "report.json", "--trace", folder / name)
        assert f"Written: {folder / name}" in said.stdout
    return folder


def test_columns_are_the_recording_and_the_report(traced):
    trace = parquet.read_table(traced / "trace.parquet").to_pandas()
    held = parquet.read_table(traced / "friday.parquet").to_pandas()
    report = json.loads((traced / "report.json").read_text())
    assert list(trace.columns[:2]) == ["time", "trajectory"]
    assert (np.diff(trace["time"]) >= 0).all() and trace["time"].iloc[0] == 0
    assert trace["trajectory"].nunique() == held["trajectory"].nunique()
    for j, joint in enumerate(report["joints"]):
        measured, corrected = trace[f"{joint}/measured"], trace[f"{joint}/corrected"]
        assert np.array_equal(measured, held[f"tau{j + 1}"])
        left = trace[f"{joint}/residual"]
        assert np.allclose(measured - corrected, left, atol=1e-9)
        assert np.sqrt(np.mean(left**2)) == pytest.approx(report["ladder"][-1]["rmse"][j], rel=1e-9)
        # The sign of the velocity is softened a little less in the report's first step.
        given = np.sqrt(np.mean((measured - trace[f"{joint}/as_given"]) ** 2))
        assert given == pytest.approx(report["ladder"][0]["rmse"][j], rel=0.05)


def test_messages_are_the_columns(traced):
    trace = parquet.read_table(traced / "trace.parquet").to_pandas()
    with open(traced / "trace.mcap", "rb") as file:
        made = reader.make_reader(file)
        summary = made.get_summary()
        (channel,) = summary.channels.values()
        assert channel.topic == "/torque" and channel.message_encoding == "json"
        assert summary.statistics.message_count == len(trace)
        rows = [(message.log_time, json.loads(message.data)) for _, _, message in made.iter_messages()]
    assert len(rows) == len(trace)
    joint = next(name.split("/")[0] for name in trace.columns if "/" in name)
    for row in (0, len(rows) // 2, len(rows) - 1):
        logged, message = rows[row]
        assert logged == pytest.approx(1e9 * trace["time"][row], abs=1)
        for name in ("measured", "as_given", "corrected", "residual"):
            assert message[joint][name] == trace[f"{joint}/{name}"][row]
