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
    with pytest.raises(TypeError, match="'cutof_hz' is no option: there are seed, "):
        residyn.identify("ur5", [], "never", cutof_hz=8)
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
    with pytest.raises(residyn.InputError, match="q1"):
        missing = fitted.drop(columns="q1") if library == "pandas" else fitted.drop("q1")
        residyn.identify(raw / "robot.urdf", missing, tmp_path / "bad", basic=True)


def test_a_named_index_of_pandas_is_a_column(raw, tmp_path):
    pandas = pytest.importorskip("pandas", reason="PyPI pandas is not installed: frames are not read")
    frame = pandas.read_csv(raw / "train.csv")
    model = residyn.identify(raw / "robot.urdf", frame, tmp_path / "m", basic=True)
    assert np.array_equal(model.predict(frame.set_index("time")).torque, model.predict(raw / "train.csv").torque)


def test_curves_of_a_prediction(raw, tmp_path):
    pytest.importorskip("matplotlib", reason="PyPI matplotlib is not installed: nothing is drawn")
    model = residyn.identify(raw / "robot.urdf", raw / "train.csv", tmp_path / "m", basic=True)
    found = model.predict(raw / "test.csv")
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
