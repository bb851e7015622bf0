"""What functions of the package take: options as the programs have them, recordings as frames, and what comes out as curves."""

import inspect
import re

import numpy as np
import pytest

import residyn
from residyn import plots

#: Options of `train` that are not its function's: of the robot, of what is printed, of another build.
ELSEWHERE = {"robot", "joints", "drive", "gravity", "quiet", "verbose", "json", "check_only", "list", "config", "gpu", "help", "version"}
NETWORKS = {"progress", "preset", "members", "epochs", "yardsticks", "resume", "physics_only"}


def keywords(function):
    return dict(inspect.signature(function).parameters)


def test_train_has_the_options_of_the_program(program):
    said = program("train", "--help").stdout
    options = {name.replace("-", "_") for name in re.findall(r"^\s+(?:-\w, )?--([\w-]+)", said, re.M)}
    own = set(keywords(residyn.train)) - {"progress", "robot"}
    assert own == options - ELSEWHERE
    assert set(keywords(residyn.identify)) == set(keywords(residyn.train)) - NETWORKS
    for name, parameter in keywords(residyn.identify).items():
        assert keywords(residyn.train)[name].default == parameter.default, name
    for function in (residyn.train, residyn.identify, residyn.diagnose, residyn.replay):
        named = keywords(function).values()
        assert all(p.annotation is not p.empty and p.kind is not p.VAR_KEYWORD for p in named), function
    with pytest.raises(TypeError, match="'cutof_hz' is no option: did you mean 'cutoff_hz'"):
        residyn.identify("ur5", [], "never", cutof_hz=8)
    with pytest.raises(TypeError, match="'physic_only' is no option: did you mean 'physics_only'"):
        residyn.train("ur5", [], "never", physic_only=True)
    with pytest.raises(TypeError, match="'xyz' is no option: there are heldout, progress, preset, .*, seed, "):
        residyn.train("ur5", [], "never", xyz=True)
    # Words that an option takes, as the help lists them.
    for option, of in (("estimator", "Estimator"), ("weight", "Weight"), ("lmi", "Lmi"), ("preset", "Preset")):
        listed = re.search(rf"--{option} <.*?(?=\n      --)", said, re.S)[0]
        assert set(re.findall(r"^\s+- ([\w-]+):", listed, re.M)) == set(getattr(residyn.model, of).__args__), option


@pytest.mark.parametrize("library", ["pandas", "polars"])
def test_a_frame_is_as_good_as_its_file(library, raw, tmp_path):
    frames = pytest.importorskip(library, reason=f"PyPI {library} is not installed: frames are not read")
    fitted, held = (frames.read_csv(raw / f"{name}.csv") for name in ("train", "test"))
    by_frame = residyn.identify(raw / "robot.urdf", fitted, tmp_path / "frame", basic=True)
    by_file = residyn.identify(raw / "robot.urdf", raw / "train.csv", tmp_path / "file", basic=True)
    a, b = by_frame.predict(held).torque, by_file.predict(raw / "test.csv").torque
    assert np.array_equal(a, b)
    # One frame is one recording, a list of them several.
    twice = residyn.identify(raw / "robot.urdf", [fitted, held], tmp_path / "both", basic=True)
    assert not np.array_equal(twice.predict(held).torque, b)
    # What is wrong is said of the argument, not of a file that is gone.
    with pytest.raises(residyn.InputError, match=r"^data\[1\]: column `q1`"):
        missing = fitted.drop(columns="q1") if library == "pandas" else fitted.drop("q1")
        residyn.identify(raw / "robot.urdf", [fitted, missing], tmp_path / "bad", basic=True)
    with pytest.raises(residyn.InputError, match=r"^recording, row 8 \(index 7\), column `q2`"):
        gap = held["q2"].to_numpy().copy()
        gap[7] = np.nan
        by_frame.predict(held.assign(q2=gap) if library == "pandas" else held.with_columns(frames.Series("q2", gap)))


def test_a_report_speaks_of_arguments(brief):
    frames = pytest.importorskip("pandas", reason="PyPI pandas is not installed: frames are not read")
    read = {name: residyn.Recording.read(brief / f"{name}.parquet") for name in ("train", "test")}
    tables = {}
    for name, one in read.items():
        columns = {f"{key}{j + 1}": getattr(one, key)[:, j] for key in ("q", "tau") for j in range(one.dof)}
        columns["tau2"] = -columns["tau2"]
        tables[name] = frames.DataFrame({"time": one.time, **columns})
    report = residyn.diagnose(brief / "robot.urdf", tables["train"], tables["test"], fast=True)
    assert [r["source"] for r in report.raw["recordings"]] == ["data", "heldout"]
    for text in (str(report), report.to_html(), report._repr_html_()):
        assert re.findall(r"residyn-\w{8}.{9}", text) == []
    assert "In data: " in str(report) and "In heldout: " in str(report)


def test_a_model_predicts_by_the_drive_file_that_it_was_trained_with(raw, tmp_path):
    frames = pytest.importorskip("pandas", reason="PyPI pandas is not installed: frames are not read")
    fitted, held = (frames.read_csv(raw / f"{name}.csv") for name in ("train", "test"))
    joints = [name for name in fitted.columns if re.fullmatch(r"tau\d+", name)]
    drive = tmp_path / "drive.toml"
    names = "\n".join(f'{name} = "current_{name[3:]}"' for name in joints)
    drive.write_text(f"torque_scale = {[2.0] * len(joints)}\n[columns]\n{names}\n")
    renamed = [table.rename(columns={n: f"current_{n[3:]}" for n in joints}) for table in (fitted, held)]
    for table in renamed:
        table[[f"current_{n[3:]}" for n in joints]] /= 2.0
    robot = residyn.Robot(str(raw / "robot.urdf"), drive=drive)
    model = residyn.identify(robot, renamed[0], tmp_path / "m", basic=True)
    own, plain = model.predict(renamed[1]), residyn.identify(raw / "robot.urdf", fitted, tmp_path / "p", basic=True).predict(held)
    np.testing.assert_allclose(own.nrmse(), plain.nrmse(), rtol=1e-9)
    # Opened anew it does not know the file, and says what is missing; arrays are N·m.
    again = residyn.Model(tmp_path / "m")
    with pytest.raises(KeyError, match="drive="):
        again.predict(renamed[1]).nrmse()
    assert again.predict(renamed[1], drive=drive).nrmse() == own.nrmse()
    arrays = residyn.Recording(held["time"], *(held[[f"{k}{j + 1}" for j in range(len(joints))]] for k in ("q", "tau")))
    assert model.predict(arrays).nrmse()[0] == pytest.approx(own.nrmse()[0], rel=0.5)
    with pytest.raises(KeyError, match="'foo' over 'all': there are .*physics.*, over all, moving"):
        own.nrmse("foo")


def test_words_of_the_command_line_become_keywords():
    said = residyn.said.in_python
    assert said("give gear ratios by --drive FILE.toml, or another --cutoff-hz.") == "give gear ratios by `drive`, or another `cutoff_hz`."
    assert said("Run without --resume; see train --check-only") == "Run without `resume=True`; see `residyn.check`"
    assert said("train with --lmi last; leave --lmi out") == 'train with `lmi="last"`; leave `lmi` out'
    assert said("`train --check-only` gives them; leave --gpu out") == "`residyn.check` gives them; leave --gpu out"
    assert said("/t/a.csv, row 3 (line 4): x; /t/a.csv", {"/t/a.csv": "data"}) == "data, row 3 (index 2): x; data"


def test_what_is_severe_is_a_warning(raw, tmp_path):
    frames = pytest.importorskip("pandas", reason="PyPI pandas is not installed: frames are not read")
    turned = frames.read_csv(raw / "train.csv")
    turned["tau2"] = -turned["tau2"]
    told = residyn.check(raw / "robot.urdf", turned)
    assert str(told).startswith(f"data: {len(turned)} samples") and "Severe" in str(told)
    assert [one["source"] for one in told.raw] == ["data"]
    with pytest.warns(UserWarning, match="^data: .* Do: ") as heard:
        residyn.identify(raw / "robot.urdf", turned, tmp_path / "m", basic=True)
    assert heard[0].filename == __file__
    with pytest.raises(residyn.InputError, match="^data has column|^data: column|q1"):
        residyn.check(raw / "robot.urdf", turned.drop(columns="q1"))


def test_a_robot_is_refused_in_keywords(tmp_path):
    scene = tmp_path / "two.xml"
    arm = """<body name="{0}" pos="0 {1} 0"><joint name="{0}1" axis="0 0 1"/><inertial pos="0.1 0 0" mass="1" diaginertia="0.01 0.01 0.01"/></body>"""
    scene.write_text("<mujoco><worldbody>" + arm.format("left", 0) + arm.format("right", 1) + "</worldbody></mujoco>")
    with pytest.raises(residyn.InputError, match="`joints`") as refused:
        residyn.Robot(str(scene))
    assert "--" not in str(refused.value)


def test_the_package_as_a_command(capsys):
    from residyn.__main__ import main

    assert main(["--version"]) == 0 and capsys.readouterr().out == f"residyn {residyn.__version__}\n"
    assert main([]) == 0 and "python -m residyn.verify" in capsys.readouterr().out
    assert main(["diagnose", "--robot", "x"]) == 2 and "does not take: diagnose" in capsys.readouterr().err


def test_a_named_index_of_pandas_is_a_column(raw, tmp_path):
    pandas = pytest.importorskip("pandas", reason="PyPI pandas is not installed: frames are not read")
    frame = pandas.read_csv(raw / "train.csv")
    model = residyn.identify(raw / "robot.urdf", frame, tmp_path / "m", basic=True)
    assert np.array_equal(model.predict(frame.set_index("time")).torque, model.predict(raw / "train.csv").torque)


def test_curves_of_a_prediction(raw, tmp_path):
    pytest.importorskip("matplotlib", reason="PyPI matplotlib is not installed: nothing is drawn")
    model = residyn.identify(raw / "robot.urdf", raw / "train.csv", tmp_path / "m", basic=True)
    found = model.predict(raw / "test.csv")
    assert len(repr(found)) < 200 and f"{len(found.time)} samples" in repr(found)
    with pytest.raises(residyn.InputError, match="a whole recording goes to `predict`"):
        model.torque(found.q, found.qd, found.qdd)
    figure = found.plot()
    assert [axis.get_ylabel().split("\n")[0] for axis in figure.axes] == model.joints
    parts = plots.trajectories(found.time)
    for j, axis in enumerate(figure.axes):
        drawn = np.concatenate([line.get_ydata() for line in axis.lines[len(parts) :]])
        assert np.array_equal(drawn, found.torque[:, j])
        clock = np.concatenate([line.get_xdata() for line in axis.lines[: len(parts)]])
        assert (np.diff(clock) > 0).all()
    assert len(found.plot([model.joints[0]]).axes) == 1
    with pytest.raises(residyn.InputError, match=f"there are: {model.joints[0]}"):
        found.plot(["elbow of another robot"])


def test_trajectories_are_told_by_their_time():
    time = np.concatenate([np.arange(5), np.arange(3), 100 + np.arange(4)]) * 0.01
    parts = plots.trajectories(time)
    assert [(p.start, p.stop) for p in parts] == [(0, 5), (5, 8), (8, 12)]
    assert (np.diff(plots.one_after_another(time, parts)) > 0).all()
    assert plots.trajectories(time[:1]) == [slice(0, 1)]
