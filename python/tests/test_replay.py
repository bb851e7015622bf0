"""`residyn.replay` against the program: the same numbers, the same words."""

import dataclasses
import importlib.util
import json
import subprocess
from html import unescape

import numpy as np
import pytest

import residyn
from residyn import in_mujoco, plots, verify_replay
from test_verify_replay import JOINTS, SERVOS, model, recording


@pytest.fixture(scope="module")
def case(program, tmp_path_factory):
    """A sealed case of motion, with a gain that is off: folder with robot.urdf, drive.toml, train.parquet, test.parquet."""
    out = tmp_path_factory.mktemp("motion")
    program("replay", "prove", "--cases", 2, "--seed", 1, "--joints", 3, "--out", out)
    return sorted(p.parent for p in out.rglob("robot.urdf"))[1]


@pytest.fixture(scope="module")
def report(case):
    robot = residyn.Robot(str(case / "robot.urdf"), drive=case / "drive.toml")
    return residyn.replay(robot, case / "train.parquet", case / "test.parquet", fast=True)


def test_an_output_that_cannot_be_written_is_refused_before_work_begins(program, case, tmp_path):
    with pytest.raises(subprocess.CalledProcessError) as refused:
        program("replay", "--robot", case / "robot.urdf", "--drive", case / "drive.toml", "--data", case / "train.parquet", "--heldout",
                case / "test.parquet", "--html", tmp_path / "none/page.html")
    assert refused.value.returncode == 2 and "none/page.html" in refused.value.stderr and not refused.value.stdout


def test_replay_is_the_program(program, case, report, tmp_path):
    said = program("replay", "--robot", case / "robot.urdf", "--drive", case / "drive.toml", "--data", case / "train.parquet", "--heldout",
                   case / "test.parquet", "--fast", "--json", "-", "--html", tmp_path / "page.html", "--patch", tmp_path / "cli.urdf")
    # The report alone on standard output, words on standard error.
    assert report.raw == json.loads(said.stdout)
    assert f"Written: {tmp_path / 'page.html'}" in said.stderr
    assert "--patch OUT" in report.to_html()
    report.patch(tmp_path / "cli.urdf")
    assert str(tmp_path / "cli.urdf") in unescape(report.to_html())
    assert report.to_html(tmp_path / "own.html") == (tmp_path / "page.html").read_text() == (tmp_path / "own.html").read_text()
    page = report.to_html()
    assert "What to do next" in page and 'class="jt jg"' in page and f"{report.causes[0].joints[0]}: " in page
    assert report._repr_html_().startswith("<iframe srcdoc=")
    assert report.ladder[0].step == "as_given" and len(report.causes) == len(report.raw["causes"])
    if importlib.util.find_spec("matplotlib"):
        (axis,) = report.plot(report.joints[-1:]).axes
        drawn = np.concatenate([line.get_ydata() for line in axis.lines if line.get_color() == plots.COLOURS["corrected"]])
        assert np.array_equal(drawn, np.concatenate([t["corrected"][:, -1] for t in report.motion()]))
    written, left_out = report.patch(tmp_path / "py.urdf")
    assert len(written) >= 4 and all(isinstance(line, str) for line in left_out)
    for path in written:
        assert path.read_bytes() == (tmp_path / path.name.replace("py.", "cli.", 1)).read_bytes()


def test_the_scored_motion_has_the_reports_figures(report):
    tracks = report.motion()
    assert report.causes
    for step, name in ((report.ladder[0], "given"), (report.ladder[-1], "corrected")):
        off = np.concatenate([t[name] - t["q"] for t in tracks])
        asked = np.concatenate([t["q_ref"] - t["q"] for t in tracks])
        of = lambda table: np.sqrt((table**2).mean(axis=0))
        np.testing.assert_allclose(of(off), step.rmse, rtol=1e-9)
        np.testing.assert_allclose(of(asked), step.tracking, rtol=1e-9)
        np.testing.assert_allclose(of(off) / of(asked), step.unexplained, rtol=1e-9)


def test_verification_of_torque_refuses_a_report_of_motion(case, report):
    with pytest.raises(residyn.InputError, match=r"one of replay(?s:.)*verify_replay\.verify"):
        in_mujoco.verify(report, case / "robot.urdf", [case / "robot.urdf"])


def test_arrays_are_as_good_as_files(case, report):
    robot = residyn.Robot(str(case / "robot.urdf"))
    train, test = (residyn.Recording.read(case / f"{name}.parquet") for name in ("train", "test"))
    arrays = [dataclasses.replace(r) for r in (train, test)]
    assert all(a.source is None for a in arrays)
    by_arrays = residyn.replay(robot, arrays[0], arrays[1], drive=case / "drive.toml", fast=True)
    assert by_arrays.raw == report.raw


def test_wrong_input_has_the_words_of_the_program(case, tmp_path):
    urdf, drive, data, test = (case / name for name in ("robot.urdf", "drive.toml", "train.parquet", "test.parquet"))
    with pytest.raises(residyn.InputError, match=r"write it into a drive file(?s:.)*\[controller\]"):
        residyn.replay(urdf, data, test)
    with pytest.raises(residyn.InputError, match="is among `data`"):
        residyn.replay(urdf, data, data, drive=drive)
    one = residyn.Recording.read(data)
    with pytest.raises(residyn.InputError, match="rows stand in the recordings"):
        residyn.replay(urdf, data, dataclasses.replace(one), drive=drive)
    with pytest.raises(residyn.InputError, match="no commanded positions"):
        residyn.replay(urdf, dataclasses.replace(one, q_ref=None), test, drive=drive)
    with pytest.raises(residyn.InputError, match="equal its positions"):
        residyn.replay(urdf, dataclasses.replace(one, q_ref=one.q), test, drive=drive)
    with pytest.raises(residyn.InputError, match="missing.csv"):
        residyn.replay(urdf, tmp_path / "missing.csv", test, drive=drive)
    with pytest.raises(TypeError):
        residyn.replay(urdf, data, drive=drive)


def day(path, seed, delay=0.02):
    """Three runs of 12 s at 50 Hz of one motion by MuJoCo's servos: each command held and `delay` s late, positions with noise, in encoder steps."""
    mujoco = pytest.importorskip("mujoco", reason="PyPI mujoco is not installed: no robot has two days")
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.timestep = 5e-4
    noise, step = np.random.default_rng(seed), 2.0 * np.pi / 4096
    tables = {name: [] for name in ("time", "q", "q_ref")}
    for run in range(3):
        time = np.arange(600) / 50.0
        angle = 2.0 * np.pi * np.array([[0.31, 0.53]]) * time[:, None] + run
        q_ref = 0.4 * np.sin(angle) + 0.2 * np.sign(np.sin(2.0 * np.pi * 0.4 * time + run))[:, None]
        data = mujoco.MjData(model)
        data.qpos[:2] = q_ref[0]
        q = np.empty_like(q_ref)
        for i in range(len(time)):
            q[i] = data.qpos[:2]
            for k in range(40):
                data.ctrl[:] = q_ref[max(int(np.floor((i / 50.0 + (k + 0.5) * 5e-4 - delay) * 50.0)), 0)]
                mujoco.mj_step(model, data)
                data.qpos[2], data.qvel[2] = 0.0, 0.0
        q = np.round((q + noise.normal(0.0, 3e-4, q.shape)) / step) * step
        for name, table in (("time", time + 20.0 * run), ("q", q), ("q_ref", q_ref)):
            tables[name].append(table)
    return residyn.Recording(**{name: np.concatenate(parts) for name, parts in tables.items()}, starts=[0, 600, 1200])


def test_a_torque_that_the_controller_adds_is_replayed(tmp_path):
    """With `tau_ff` the simulator as given is right, and without it is not; a measured torque beside it changes nothing."""
    given = model(tmp_path / "given.xml", SERVOS.format(25, 1))
    added = lambda time: np.stack([3.0 * np.sin(2.0 * time), 1.5 * np.sign(np.cos(3.0 * time))], axis=1)
    whole = recording(given, 0.0, added=added)
    # Rows of a second source, as no diagnosis of torque would take them.
    whole = dataclasses.replace(whole, tau=np.where(np.arange(len(whole))[:, None] % 2, 0.0, 5.0) * np.ones((1, 2)))
    robot = residyn.Robot(str(given), joints=JOINTS)
    halves = [residyn.Recording(**{k: getattr(whole, k)[part] for k in ("time", "q", "q_ref", "tau", "tau_ff")}) for part in (slice(0, 300), slice(300, 600))]
    known = residyn.replay(robot, *halves, fast=True)
    assert known.verdict == "no_gap" and known.ladder[0].mean_unexplained < 0.03
    bare = [dataclasses.replace(half, tau_ff=None) for half in halves]
    assert residyn.replay(robot, *bare, fast=True).ladder[0].mean_unexplained > 0.3
    mixed = residyn.replay(robot, halves[0], bare[1], fast=True)
    assert any("tau_ff is in some recordings only" in note for note in mixed.notes)


def test_a_delay_is_part_of_the_corrected_file(tmp_path):
    """MuJoCo delays by itself, and comes to the report's figure without shifted commands."""
    mujoco = pytest.importorskip("mujoco", reason="PyPI mujoco is not installed: nothing can be loaded in it")
    given = model(tmp_path / "given.xml", SERVOS.format(40, 1))
    # Encoders so noisy that what is left is theirs, but for the starts of the roll-outs: MuJoCo's friction creeps by a tenth of it otherwise.
    heldout = day(given, 2, 0.047)
    noise = np.random.default_rng(4).normal(0.0, 0.005, heldout.q.shape)
    noise[np.arange(1800) % 600 < 10] = 0.0
    heldout = dataclasses.replace(heldout, q=heldout.q + noise)
    report = residyn.replay(residyn.Robot(str(given), joints=JOINTS), day(given, 1, 0.047), heldout, fast=True)
    assert [c.effect for c in report.causes] == ["command_delay"]
    written, left_out = report.patch(tmp_path / "corrected.xml")
    assert not any("delay" in line for line in left_out), left_out
    corrected = mujoco.MjModel.from_xml_path(str(written[0]))
    np.testing.assert_allclose(corrected.actuator_delay, 0.047, atol=0.001)
    _, (row,) = verify_replay.verify(written[0], heldout, report=report)
    said = report.raw["file_alone"]["mean_unexplained"]
    for column in row.columns:
        assert abs(column.unexplained.mean() / said - 1.0) < 0.05, (column, said)


def test_executions_of_one_motion_are_the_floor(tmp_path):
    """Two runs under the same commands: the last step of the ladder is how far they differ, and no simulator."""
    given = model(tmp_path / "given.xml", SERVOS.format(40, 1))
    noisy = np.random.default_rng(5).normal(0.0, 0.01, (600, 2))
    # Roll-outs start from the recorded state.
    noisy[np.arange(600) % 300 < 10] = 0.0
    once = recording(given, 0.0)
    rows = np.r_[0:300, 0:300]
    twice = residyn.Recording(
        time=np.r_[once.time[:300], once.time[:300] + 10.0], q=once.q[rows] + noisy, q_ref=once.q_ref[rows], starts=[0, 300]
    )
    fitted = residyn.Recording(time=once.time[300:], q=once.q[300:], q_ref=once.q_ref[300:])
    report = residyn.replay(residyn.Robot(str(given), joints=JOINTS), fitted, twice, fast=True)
    assert [step.step for step in report.ladder] == ["as_given", "repeatability"]
    floor = report.ladder[-1]
    np.testing.assert_allclose(floor.rmse, np.sqrt(0.5 * ((noisy[:300] - noisy[300:]) ** 2).mean(axis=0)), rtol=1e-9)
    np.testing.assert_allclose(floor.unexplained, np.divide(floor.rmse, floor.tracking), rtol=1e-9)
    # The simulator as given is as near as one execution is to another.
    assert report.verdict == "no_gap" and report.ladder[0].mean_unexplained < 1.5 * floor.mean_unexplained
    assert "Executions of one motion differ by" in str(report) and "repeatability" in report.to_html()


def test_what_has_changed_between_two_days(tmp_path):
    """By commands and encoders alone, from a simulator that is wrong itself."""
    given = model(tmp_path / "given.xml", SERVOS.format(60, 2), friction=0.1)
    monday = model(tmp_path / "monday.xml", SERVOS.format(40, 1))
    weaker = model(tmp_path / "weaker.xml", SERVOS.format(28, 1))
    robot = residyn.Robot(str(given), joints=JOINTS)
    before = day(monday, 1)

    def since(path, delay=0.02):
        return residyn.replay(robot, day(path, 2, delay), day(path, 3, delay), before=before, fast=True)

    same = since(monday)
    assert same.verdict == "no_gap" and same.causes == []
    assert "nothing has changed" in str(same) and len(same.raw["compared"]["before"]) == 1
    gain = since(weaker)
    # A confidence of 0.874 is the surest that is said: odds of a million to one, tempered.
    assert [c.effect for c in gain.causes] == ["servo_gain"] and gain.causes[0].confidence > 0.87
    assert gain.causes[0].gap_closed > 0.9
    for name in JOINTS:
        value, std, unit = gain.causes[0].parameters[f"kp[{name}]"]
        assert abs(value - 28.0) < 2.0 * std and unit == "N·m/rad"
    late = since(monday, delay=0.05)
    assert [c.effect for c in late.causes] == ["command_delay"]
    assert late.causes[0].parameters["delay"][0] == pytest.approx(0.05, abs=0.002)
    assert late.ladder[-1].mean_unexplained < 0.1 * late.ladder[0].mean_unexplained
