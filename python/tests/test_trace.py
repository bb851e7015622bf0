"""`diagnose --trace`: torque over time in the two formats that plotters read, and the report's own errors in it."""

import json
import re
import xml.etree.ElementTree as ElementTree

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
    for name, beside in (("trace.parquet", []), ("trace.mcap", ["trace.plotjuggler.xml", "trace.foxglove.json"])):
        said = program(*given, "--json", folder / "report.json", "--trace", folder / name)
        written = re.findall(r"^Written: (.*)$", said.stdout, re.M)
        assert set(written) == {str(folder / n) for n in ["report.json", name, *beside]}
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


def test_layouts_name_the_curves_of_the_messages(traced):
    with open(traced / "trace.mcap", "rb") as file:
        _, channel, message = next(reader.make_reader(file).iter_messages())
    first = json.loads(message.data)
    joints = [name for name, value in first.items() if isinstance(value, dict)]
    wanted = {(joint, curve) for joint in joints for curve in first[joint]}

    # PlotJuggler joins topic and fields with slashes; opened in this folder it finds the file.
    root = ElementTree.parse(traced / "trace.plotjuggler.xml").getroot()
    assert root.find("previouslyLoaded_Datafiles/fileInfo").get("filename") == "trace.mcap"
    assert root.find("previouslyLoaded_Datafiles/fileInfo/selected_datasources").get("value") == channel.topic
    named = [curve.get("name") for curve in root.iter("curve")]
    assert set(named) == {f"{channel.topic}/{joint}/{curve}" for joint, curve in wanted} and len(named) == len(wanted)
    for splitter in root.iter("DockSplitter"):
        assert int(splitter.get("count")) == len(splitter.findall("DockArea")) == len(splitter.get("sizes").split(";")) == len(joints)

    # Foxglove: every panel of a tab is configured, every path leads to a number.
    layout = json.loads((traced / "trace.foxglove.json").read_text())
    panels = layout["configById"]
    placed = re.findall(r'"(Plot![^"]+)"', json.dumps(panels[layout["layout"]]["tabs"]))
    assert sorted(placed) == sorted(name for name in panels if name.startswith("Plot!"))
    paths = [path["value"].removeprefix(channel.topic + ".") for name in placed for path in panels[name]["paths"]]
    assert {tuple(path.split(".")) for path in paths} == wanted and len(paths) == len(wanted)
