"""The package against the programs: the same numbers, the same words."""

import _thread
import dataclasses
import importlib.util
import json
import threading
import time
from html import unescape

import numpy as np
import pytest

import residyn
from residyn import plots
from residyn.in_mujoco import ROLLOUT, _starts


def test_dynamics_agree_with_each_other():
    with pytest.raises(residyn.InputError, match="finite"):
        residyn.Robot("ur5", gravity=(float("nan"), 0.0, 0.0))
    robot = residyn.Robot("ur5")
    q, qd, qdd = np.random.default_rng(1).normal(size=(3, 20, robot.dof))
    tau = robot.inverse_dynamics(q, qd, qdd)
    by_regressor = robot.regressor(q, qd, qdd) @ np.array(robot.parameters)
    assert np.allclose(tau, by_regressor, rtol=0, atol=1e-10)
    still = np.zeros_like(q)
    moved = robot.inverse_dynamics(q, still, qdd) - robot.inverse_dynamics(q, still, still)
    assert np.allclose(np.einsum("nij,nj->ni", robot.mass_matrix(q), qdd), moved, atol=1e-10)


def test_identify_is_train_to_the_last_bit(program, raw, tmp_path):
    model = residyn.identify(raw / "robot.urdf", raw / "train.csv", tmp_path / "py", heldout=raw / "test.csv")
    arguments = ["--robot", raw / "robot.urdf", "--data", raw / "train.csv", "--heldout", raw / "test.csv"]
    program("train", *arguments, "--physics-only", "--quiet", "--out", tmp_path / "cli")
    for name in ("model.json", "metrics.json"):
        assert (tmp_path / "py" / name).read_bytes() == (tmp_path / "cli" / name).read_bytes(), name

    found = model.predict(raw / "test.csv")
    said = program("eval", "--model", tmp_path / "cli", "--data", raw / "test.csv", "--json", tmp_path / "eval.json",
                   "--predict", tmp_path / "torque.csv").stdout
    assert all(f"Written: {tmp_path / name}" in said for name in ("eval.json", "torque.csv"))
    assert found.report == json.loads((tmp_path / "eval.json").read_text())
    printed = np.genfromtxt(tmp_path / "torque.csv", delimiter=",", names=True)
    for j in range(found.torque.shape[1]):
        assert np.array_equal(found.torque[:, j], printed[f"tau{j + 1}"])
        assert np.array_equal(found.std[:, j], printed[f"tau{j + 1}_std"])
    assert len(found.nrmse()) == len(model.joints)
    with pytest.raises(KeyError, match="linear"):
        found.nrmse("linear")


def test_a_changed_recording_is_not_read_again_from_its_file(raw, tmp_path):
    read = residyn.Recording.read(raw / "train.csv")
    changed = dataclasses.replace(read, tau=2.0 * read.tau)
    assert read.source == raw / "train.csv" and changed.source is None
    once, twice = (residyn.identify(raw / "robot.urdf", r, tmp_path / n).predict(read).torque for r, n in ((read, "once"), (changed, "twice")))
    assert np.vdot(once, twice) / np.vdot(once, once) == pytest.approx(2.0, abs=0.1)


def test_rollouts_end_in_their_own_trajectory():
    time = np.tile(np.arange(10_001) * 1e-3, 2)
    starts = _starts(time)
    assert {last for _, last in starts} == {10_000, 20_001}
    assert all(time[last] - time[start] >= ROLLOUT and start < last for start, last in starts)
    assert starts[0] == (500, 10_000)


def test_arrays_are_as_good_as_files(raw, tmp_path):
    read = residyn.Recording.read(raw / "train.csv")
    arrays = residyn.Recording(read.time, read.q, read.tau, read.qd, read.qdd, starts=read.starts, labels=read.labels)
    assert arrays.source is None and len(arrays) == len(read)
    by_file = residyn.identify(raw / "robot.urdf", read, tmp_path / "file")
    by_array = residyn.identify(raw / "robot.urdf", arrays, tmp_path / "array")
    a, b = (m.predict(arrays).torque for m in (by_file, by_array))
    assert np.array_equal(a, b)


def test_a_loop_is_what_eval_predicts_for_memoryless_physics(raw, tmp_path):
    model = residyn.identify(raw / "robot.urdf", raw / "train.csv", tmp_path / "m", basic=True)
    tau = model.torque(np.zeros(len(model.joints)), np.zeros(len(model.joints)), np.zeros(len(model.joints)))
    assert tau.shape == (len(model.joints),) and np.isfinite(tau).all()
    with pytest.raises(residyn.InputError, match="have the shape"):
        model.torque(np.zeros(2), np.zeros(2), np.zeros(2))


def test_training_reports_progress_and_stops(raw, tmp_path):
    seen = []
    options = dict(epochs=1, members=1, basic=True)
    residyn.train(raw / "robot.urdf", raw / "train.csv", tmp_path / "whole", progress=lambda *p: seen.append(p), **options)
    assert seen and all(1 <= epoch <= epochs for _, _, epoch, epochs, _ in seen)

    # Ctrl-C arrives while networks train; the same call goes on from there.
    def interrupt(*_):
        if not interrupt.done:
            interrupt.done = True
            _thread.interrupt_main()

    interrupt.done = False
    options["epochs"] = 6
    with pytest.raises(KeyboardInterrupt):
        residyn.train(raw / "robot.urdf", raw / "train.csv", tmp_path / "stopped", progress=interrupt, **options)
    assert not (tmp_path / "stopped" / "model.json").exists()
    residyn.train(raw / "robot.urdf", raw / "train.csv", tmp_path / "stopped", resume=True, **options)
    residyn.train(raw / "robot.urdf", raw / "train.csv", tmp_path / "again", **options)
    name = "compensator.safetensors"
    assert (tmp_path / "stopped" / name).read_bytes() == (tmp_path / "again" / name).read_bytes()


def test_diagnose_is_the_program(program, case, tmp_path):
    files = dict(data=case / "train.parquet", heldout=case / "test.parquet")
    report = residyn.diagnose(residyn.Robot(str(case / "robot.urdf")), **files, fast=True)
    program("diagnose", "--robot", case / "robot.urdf", "--data", files["data"], "--heldout", files["heldout"], "--fast",
            "--json", tmp_path / "report.json", "--html", tmp_path / "page.html", "--patch", tmp_path / "cli.urdf")
    assert report.raw == json.loads((tmp_path / "report.json").read_text())
    page = (tmp_path / "page.html").read_text()
    assert str(tmp_path / "cli.urdf") in unescape(page) and "--patch OUT" in report.to_html()
    report.patch(tmp_path / "cli.urdf")
    assert report.to_html() == page
    assert report._repr_html_().startswith("<iframe srcdoc=")
    assert report.verdict in str(report) or str(report)
    assert report.ladder[0].step == "as_given" and len(report.causes) == len(report.raw["causes"])
    if importlib.util.find_spec("matplotlib"):
        figure = report.plot(report.joints[:2])
        for j, axis in enumerate(figure.axes):
            measured = np.concatenate([line.get_ydata() for line in axis.lines if line.get_color() == plots.COLOURS["measured"]])
            assert np.array_equal(measured, report.motion()["tau"][:, j])
    for written in report.patch(tmp_path / "py.urdf"):
        twin = tmp_path / written.name.replace("py.", "cli.")
        assert written.read_bytes() == twin.read_bytes()
    model = report.write_model(tmp_path / "model")
    assert model.predict(files["heldout"]).torque.shape[1] == len(report.joints)


def test_the_interpreter_is_free_meanwhile_and_ctrl_c_returns(brief):
    ticks = []
    stop = threading.Event()

    def tick():
        while not stop.wait(0.01):
            ticks.append(time.monotonic())
            if len(ticks) == 20:
                _thread.interrupt_main()

    thread = threading.Thread(target=tick)
    thread.start()
    began = time.monotonic()
    try:
        with pytest.raises(KeyboardInterrupt):
            residyn.diagnose(str(brief / "robot.urdf"), brief / "train.parquet", brief / "test.parquet")
    finally:
        stop.set()
        thread.join()
    assert len(ticks) >= 20, "other threads did not run"
    assert time.monotonic() - began < 30


def test_wrong_input_has_the_words_of_the_programs(raw, tmp_path):
    with pytest.raises(residyn.InputError, match="See the built-in names"):
        residyn.Robot("ur55")
    with pytest.raises(residyn.InputError, match="missing.csv"):
        residyn.identify(raw / "robot.urdf", tmp_path / "missing.csv", tmp_path / "m")
    with pytest.raises(residyn.InputError, match="invalid value 'soft' for `weight`(?s:.)*tukey\\]$"):
        residyn.identify(raw / "robot.urdf", raw / "train.csv", tmp_path / "m", weight="soft")
    with pytest.raises(TypeError, match="cutof"):
        residyn.identify(raw / "robot.urdf", raw / "train.csv", tmp_path / "m", cutof=8)
    with pytest.raises(residyn.InputError, match="dimensions"):
        residyn.Recording(np.arange(3.0), np.zeros(3))
    with pytest.raises(residyn.InputError, match=r"tau has the shape \(9, 5\) and q \(9, 6\)"):
        residyn.Recording(np.arange(9.0), np.zeros((9, 6)), np.zeros((9, 5)))
    with pytest.raises(residyn.InputError, match=r"q has the shape \(8, 6\) and time \(9,\)"):
        residyn.Recording(np.arange(9.0), np.zeros((8, 6)))
    with pytest.raises(residyn.InputError, match=r"(?s)one row per sample.*transpose it: q\.T"):
        residyn.Recording(np.arange(9.0), np.zeros((6, 9)))
    for starts in [(0, 9), (0, 4, 4), (1,), ()]:
        with pytest.raises(residyn.InputError, match="starts are"):
            residyn.Recording(np.arange(9.0), np.zeros((9, 6)), starts=starts)
    for none in ([], (), None, {"a": 1}):
        for call in (residyn.diagnose, residyn.replay, residyn.identify, residyn.train):
            with pytest.raises(residyn.InputError, match="^data is "):
                call("ur5", none, tmp_path / "m")
    with pytest.raises(residyn.InputError, match=r"data\[1\] is of type ndarray"):
        residyn.identify("ur5", [raw / "train.csv", np.zeros((9, 6))], tmp_path / "m")
    with pytest.raises(residyn.InputError, match="not finite"):
        one = residyn.Recording(np.arange(9.0), np.full((9, 6), np.nan), np.zeros((9, 6)))
        residyn.identify("ur5", one, tmp_path / "m")
    with pytest.raises(residyn.InputError, match="shape"):
        residyn.Robot("ur5").inverse_dynamics(*np.zeros((3, 4, 5)))
