"""Commands replayed in MuJoCo: a recording by MuJoCo's own servos of another model, and the figures as given and corrected."""

import dataclasses
import json

import numpy as np
import pytest

import residyn
from residyn import verify, verify_replay
from residyn.rollout import Replayed, unexplained

mujoco = pytest.importorskip("mujoco", reason="PyPI mujoco is not installed: nothing can be replayed in it")

JOINTS = ["lift", "bend"]
SERVOS = """<position name="l" joint="lift" kp="{0}" kv="{1}" forcerange="-30 30"/><position joint="bend" kp="{0}" kv="{1}"/>"""
MOTORS = """<motor name="l" joint="lift" ctrlrange="-4 4"/><motor name="b" joint="bend" gear="-2"/>"""


def model(path, actuators, friction=0.3, damping=0.4):
    """An arm of two joints under gravity, with a finger that is none of its joints."""
    path.write_text(
        f"""<mujoco><compiler angle="radian"/><option timestep="0.002"/>
        <default><joint axis="0 1 0" damping="{damping}" frictionloss="{friction}" armature="0.05"/></default>
        <worldbody><body><joint name="lift"/><inertial mass="1.5" pos="0.2 0 0" diaginertia="0.01 0.02 0.02"/>
        <body pos="0.4 0 0"><joint name="bend"/><inertial mass="0.8" pos="0.15 0 0" diaginertia="0.005 0.01 0.01"/>
        <body pos="0.3 0 0"><joint name="finger" axis="1 0 0"/><inertial mass="0.1" pos="0 0.02 0" diaginertia="0.001 0.001 0.001"/>
        </body></body></body></worldbody><actuator>{actuators}</actuator></mujoco>""",
        encoding="utf-8",
    )
    return path


def recording(path, delay, control=None, rates=False, added=None):
    """Two runs of 6 s at 50 Hz on one clock: the servos of `path` at 0.5 ms, each command held and `delay` s late, the finger in its place.
    `added` (N·m, a function of time) is the torque that the controller adds, as late."""
    loaded = mujoco.MjModel.from_xml_path(str(path))
    loaded.opt.timestep = 5e-4
    tables = {name: [] for name in ("time", "q", "qd", "q_ref", "qd_ref", "tau_ff")}
    for run in range(2):
        time = np.arange(300) / 50.0
        angle = 2.0 * np.pi * np.array([[0.31, 0.53]]) * time[:, None] + run
        tau_ff = np.zeros((300, 2)) if added is None else added(time)
        q_ref, qd_ref = 0.4 * np.sin(angle), 0.4 * 2.0 * np.pi * np.array([[0.31, 0.53]]) * np.cos(angle)
        # Steps, in which a delay is seen apart from damping.
        q_ref = q_ref + 0.2 * np.sign(np.sin(2.0 * np.pi * 0.4 * time))[:, None]
        data = mujoco.MjData(loaded)
        data.qpos[:2] = q_ref[0]
        q, qd = np.empty_like(q_ref), np.empty_like(q_ref)
        for i in range(len(time)):
            q[i], qd[i] = data.qpos[:2], data.qvel[:2]
            for k in range(40):
                row = max(int(np.floor((i / 50.0 + (k + 0.5) * 5e-4 - delay) * 50.0)), 0)
                data.ctrl[:] = q_ref[row] if control is None else control(q_ref[row], qd_ref[row], data)
                data.qfrc_applied[:2] = tau_ff[row]
                mujoco.mj_step(loaded, data)
                data.qpos[2], data.qvel[2] = 0.0, 0.0
        for name, table in (("time", time + 10.0 * run), ("q", q), ("qd", qd), ("q_ref", q_ref), ("qd_ref", qd_ref), ("tau_ff", tau_ff)):
            tables[name].append(table)
    if not rates:
        del tables["qd_ref"]
    if added is None:
        del tables["tau_ff"]
    return residyn.Recording(**{name: np.concatenate(parts) for name, parts in tables.items()}, starts=[0, 300])


def report(path, ladder, **controller):
    """A report as `replay --json` writes it, as far as it is read."""
    steps = [{"step": name, "unexplained": values} for name, values in ladder]
    path.write_text(json.dumps({"schema": "replay/1", "joints": JOINTS, "ladder": steps, "controller": controller}), encoding="utf-8")
    return path


def test_servos_as_given_and_corrected(tmp_path, capsys):
    given = model(tmp_path / "given.xml", SERVOS.format(400, 5), friction=0.0)
    corrected = model(tmp_path / "corrected.xml", SERVOS.format(25, 1))
    data = tmp_path / "data.parquet"
    recording(corrected, 0.03).write(data)
    found = dict(kind="pd", kp=[25.0, 25.0], kp_std=[None, 1.0], kd=[1.0, 1.0], delay=[0.03, 0.03], limit=[None, None])
    said = report(tmp_path / "replay.json", [("as_given", [0.9, 0.9]), ("servo_gain", [0.01, None]), ("learned", [0.0, 0.0])], **found)
    arguments = ["--replay", "--robot", str(corrected), "--given", str(given), "--data", str(data), "--report", str(said)]
    assert verify.main(arguments) == 0
    text = capsys.readouterr().out
    print(text)
    assert "at 1 ms" in text and "2 ms, its own" in text and "hard friction" in text
    names, (before, after) = verify_replay.verify(corrected, data, given, report=json.loads(said.read_text()))
    assert names == JOINTS
    assert [c.head for c in after.columns] == ["1 ms", "2 ms, its own", "1 ms, hard friction"]
    # The same model at other steps, and without its delay.
    assert after.columns[0].unexplained.max() < 0.02 and after.columns[1].unexplained.max() < 0.03
    assert before.columns[0].unexplained.min() > 0.5
    late = verify_replay.verify(corrected, data)[1][0].columns[0].unexplained
    assert late.min() > 3.0 * after.columns[0].unexplained.max()
    np.testing.assert_array_equal(after.report.unexplained, [0.01, np.nan])
    np.testing.assert_array_equal(before.report.unexplained, [0.9, 0.9])


def test_motors_follow_the_drive_file(tmp_path, capsys):
    """The law outside of the model, through gears and over a range of control that the motion contradicts."""
    motors = model(tmp_path / "motors.xml", MOTORS.replace("ctrlrange", 'ctrllimited="false" ctrlrange'))

    def control(q_ref, qd_ref, data):
        torque = np.array([60.0, 40.0]) * (q_ref - data.qpos[:2]) + 2.0 * (qd_ref - data.qvel[:2])
        return torque * [1.0, -0.5]

    truth = recording(motors, 0.0, control, rates=True)
    drive = tmp_path / "drive.toml"
    drive.write_text('[controller]\nkind = "pd"\nkp = [60, 40]\nkd = 2\n', encoding="utf-8")
    limited = model(tmp_path / "limited.xml", MOTORS)
    _, (row,) = verify_replay.verify(limited, truth, drive=drive)
    assert row.columns[0].unexplained.max() < 0.02
    assert any("l: ctrlrange of 4 set free" in note for note in row.notes), row.notes
    # Of a report: gains of the corrected model, in place of the drive file's.
    drive.write_text('[controller]\nkind = "pd"\nkp = [30, 30]\nkd = 2\n', encoding="utf-8")
    said = {"joints": JOINTS, "controller": {"kind": "pd", "kp": [60.0, 40.0], "kd": [2.0, 2.0]}, "ladder": [{"step": "as_given", "unexplained": [1, 1]}]}
    _, (before, after) = verify_replay.verify(limited, truth, limited, drive=drive, report=said)
    assert before.columns[0].unexplained.min() > 10.0 * after.columns[0].unexplained.max()
    data = tmp_path / "data.csv"
    truth.write(data)
    assert verify.main(["--replay", "--robot", str(limited), "--data", str(data)]) == 2
    assert "no servo of position for lift, bend" in capsys.readouterr().err


def test_a_delay_of_the_file_acts_there_alone(tmp_path):
    """However many controls MuJoCo keeps: what the file does not delay, the commands are shifted by."""
    servos = SERVOS.format(25, 1)
    truth = recording(model(tmp_path / "truth.xml", servos), 0.0314)
    said = {"delay": [0.0314, 0.0314]}
    shifted = Replayed(tmp_path / "truth.xml", JOINTS, said, 1e-3)
    assert (shifted.delay == 0.0314).all()
    figure = unexplained(truth, shifted.errors(truth))
    for kept, left in ((33, 0.0), (17, 0.0), (5, 0.0264)):
        late = servos.replace("<position ", f'<position delay="0.0314" nsample="{kept}" interp="linear" ')
        file = model(tmp_path / f"late{kept}.xml", late)
        by_file = Replayed(file, JOINTS, said, 2e-3 if kept == 17 else 1e-3)
        np.testing.assert_allclose(by_file.delay, left, atol=1e-12)
        np.testing.assert_allclose(unexplained(truth, by_file.errors(truth)), figure, atol=0.004)
    assert figure.max() < 0.02
    # Without either of them the motion is another.
    assert unexplained(truth, Replayed(tmp_path / "truth.xml", JOINTS, {}, 1e-3).errors(truth)).min() > 0.1


def test_a_torque_that_the_controller_adds(tmp_path):
    """By servos of the model, and by a law outside of it, as late as the commands."""
    added = lambda time: np.stack([3.0 * np.sin(2.0 * time), 1.5 * np.sign(np.cos(3.0 * time))], axis=1)
    servos = model(tmp_path / "servos.xml", SERVOS.format(25, 1))
    truth = recording(servos, 0.02, added=added)
    without = dataclasses.replace(truth, tau_ff=None)
    motors = model(tmp_path / "motors.xml", MOTORS.replace("ctrlrange", 'ctrllimited="false" ctrlrange'))
    law = {"kind": "pd", "kp": [25.0, 25.0], "kd": [1.0, 1.0], "delay": [0.02, 0.02]}
    for path, controller in ((servos, {"delay": [0.02, 0.02]}), (motors, law)):
        figures = [unexplained(r, Replayed(path, JOINTS, controller, 1e-3).errors(r)) for r in (truth, without)]
        assert figures[0].max() < 0.03 and figures[1].min() > 0.2, figures


def test_friction_that_holds(tmp_path):
    """A light joint under a load below its friction creeps in MuJoCo, and stands with hard friction."""
    light = model(tmp_path / "light.xml", SERVOS.format(0.01, 0), friction=9.0, damping=0.0)
    time = np.arange(200) / 50.0
    still = np.zeros((200, 2))
    stands = residyn.Recording(time=time, q=still, qd=still, q_ref=still)
    soft, hard = (np.abs(Replayed(light, JOINTS, hard=h).errors(stands)).max() for h in (False, True))
    assert hard < 1e-4 and soft > 0.01


def test_a_file_is_held_to_what_it_leaves_by_itself(tmp_path):
    """Where a file does not hold all that was found, its own figures stand beside MuJoCo's."""
    truth = recording(model(tmp_path / "truth.xml", SERVOS.format(25, 1), friction=0.6), 0.0)
    half = model(tmp_path / "half.xml", SERVOS.format(25, 1))
    said = {
        "joints": JOINTS,
        "controller": {"kind": "pd", "kp": [25.0, 25.0], "kd": [1.0, 1.0], "delay": [0.0, 0.0]},
        "ladder": [{"step": "as_given", "unexplained": [0.5, 0.5]}, {"step": "stribeck_friction", "unexplained": [0.1, None]}],
        "file_alone": {"unexplained": [0.2, 0.3]},
        "causes": [],
    }
    _, (row,) = verify_replay.verify(half, truth, report=said)
    np.testing.assert_array_equal(row.report.unexplained, [0.2, 0.3])
    del said["file_alone"]
    _, (row,) = verify_replay.verify(half, truth, report=said)
    np.testing.assert_array_equal(row.report.unexplained, [0.1, np.nan])


def test_a_lost_simulation_is_said(tmp_path, capsys):
    """Gains that no step of 1 ms follows."""
    stiff = model(tmp_path / "stiff.xml", MOTORS)
    truth = recording(model(tmp_path / "servos.xml", SERVOS.format(25, 1)), 0.0)
    wild = {"kind": "pd", "kp": 1e7, "kd": 0.0}
    one = Replayed(stiff, JOINTS, wild, 1e-3)
    figures = unexplained(truth, one.errors(truth))
    assert not np.isfinite(figures).all() or figures.min() > 10.0
    law = {"kind": "pd", "kp": 0.0}
    with pytest.raises(residyn.InputError, match="the controller has no kp"):
        Replayed(stiff, JOINTS, law)
    with pytest.raises(residyn.InputError, match="no joint named wrist"):
        Replayed(stiff, ["wrist"])
    (tmp_path / "other.json").write_text("{}", encoding="utf-8")
    assert verify.main(["--replay", "--robot", str(stiff), "--data", "x.csv", "--report", str(tmp_path / "other.json")]) == 2
    assert "is no report of replay" in capsys.readouterr().err
