"""The gap, seen and closed in MuJoCo: recordings by MuJoCo's own dynamics of a changed model, corrected, and computed again."""

from pathlib import Path

import numpy as np
import pytest

import residyn
from residyn import in_mujoco, verify

mujoco = pytest.importorskip("mujoco", reason="PyPI mujoco is not installed: nothing can be verified in it")

MODEL = Path(__file__).resolve().parents[2] / "physics/tests/fixtures/mjcf/six_axis.xml"
JOINTS = ["pan", "lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]


def recording(change, seed):
    """Four runs of 12 s at 250 Hz, the torque MuJoCo's of the changed model with 1 % of noise."""
    rng = np.random.default_rng(seed)
    time = np.arange(3000) / 250.0
    loaded = mujoco.MjModel.from_xml_path(str(MODEL))
    loaded.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    change(loaded)
    data = mujoco.MjData(loaded)
    tables = {name: [] for name in ("time", "q", "tau")}
    for run in range(4):
        phase, size = rng.uniform(0, 2 * np.pi, (5, 6)), rng.normal(size=(5, 6)) * 0.25
        # A point of standstill in the middle of each period would be no motion: five incommensurate harmonics.
        omega = 2 * np.pi * np.array([0.11, 0.23, 0.37, 0.53, 0.71])[:, None, None]
        angle = omega * time[None, :, None] + phase[:, None, :]
        q, qd = (size[:, None] * np.sin(angle)).sum(0), (size[:, None] * omega * np.cos(angle)).sum(0)
        qdd = -(size[:, None] * omega**2 * np.sin(angle)).sum(0)
        tau = np.empty_like(q)
        for i in range(len(time)):
            data.qpos[:], data.qvel[:], data.qacc[:] = q[i], qd[i], qdd[i]
            mujoco.mj_inverse(loaded, data)
            tau[i] = data.qfrc_inverse
        tau[:, 1] += getattr(change, "extra", lambda q: 0.0)(q[:, 1])
        tau += rng.normal(size=tau.shape) * 0.01 * tau.std(0)
        tables["time"].append(time + 20.0 * run)
        tables["q"].append(q + rng.normal(size=q.shape) * 1e-5)
        tables["tau"].append(tau)
    starts = [len(time) * run for run in range(4)]
    return residyn.Recording(**{name: np.concatenate(parts) for name, parts in tables.items()}, starts=starts)


def friction(model):
    model.dof_damping[:] *= 1.6
    model.dof_frictionloss[:] = [9.0, 12.0, 6.0, 2.0, 1.5, 1.0]


def payload(model):
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, "flange")
    model.body_mass[body] += 3.0


def rotors(model):
    model.dof_armature[:3] += 0.8


def rippled(model):
    """Nothing of MuJoCo's parameters."""


rippled.extra = lambda q: 6.0 * np.sin(24.0 * q + 0.4)


@pytest.mark.parametrize("change, effect", [(friction, "friction_parameters"), (payload, "payload"), (rotors, "rotor_inertia")])
def test_the_gap_closes_in_mujoco(change, effect, tmp_path):
    robot = residyn.Robot(str(MODEL))
    assert robot.joints == JOINTS
    report = residyn.diagnose(robot, recording(change, 1), recording(change, 2), fast=True)
    assert effect in [c.effect for c in report.causes], str(report)
    written = report.patch(tmp_path / "corrected.xml")
    given, corrected = verify.verify(report, MODEL, written)
    print(f"\n{effect}\n{verify.table([given, corrected])}")
    assert given.mujoco == pytest.approx(given.report, rel=0.05)
    if effect == "friction_parameters":
        # MuJoCo's friction turns round some milliseconds before the motion: no delay, and nothing but friction.
        assert [c.effect for c in report.causes] == [effect], str(report)
        found = report.causes[0].parameters
        for joint, size in zip(JOINTS, [9.0, 12.0, 6.0, 2.0, 1.5, 1.0]):
            assert found[f"coulomb[{joint}]"][0] == pytest.approx(size, rel=0.01)
        assert corrected.mujoco < 1.1 * 0.01
    else:
        assert corrected.mujoco == pytest.approx(corrected.report, rel=0.05)
    assert corrected.mujoco < 0.2 * given.mujoco
    assert corrected.drift < 0.2 * given.drift


def test_generated_code_closes_what_no_parameter_does(tmp_path):
    """Cogging of the second joint, by NumPy and not by the callback; then in MuJoCo, and the same law by PyTorch."""
    data, heldout = recording(rippled, 1), recording(rippled, 2)
    report = residyn.diagnose(residyn.Robot(str(MODEL)), data, heldout, fast=True)
    assert [(c.effect, c.joints) for c in report.causes] == [("torque_ripple", ["lift"])], str(report)
    written = report.patch(tmp_path / "corrected.xml")
    given, patched, coded = verify.verify(report, MODEL, written)
    print(f"\n{verify.table([given, patched, coded])}")
    assert coded.mujoco == pytest.approx(coded.report, rel=0.05)
    assert coded.mujoco < 0.3 * patched.mujoco
    assert coded.drift < 0.3 * patched.drift
    torch = pytest.importorskip("torch", reason="PyTorch is not installed: the actuator's law is not compared")
    callback, actuator = (in_mujoco._module(tmp_path / f"corrected_{s}.py") for s in ("mujoco", "isaaclab"))
    q, dq, qd, qdd, load = np.random.default_rng(3).normal(size=(5, 40, len(callback.JOINTS)))
    z = np.zeros((40, callback.MEMORY))
    ours = callback.law(q, dq, qd, qdd, load, 0.01, None, z)
    theirs = actuator.law(*map(torch.from_numpy, (q, dq, qd, qdd, load)), 0.01, None, torch.from_numpy(z))
    assert np.abs(ours[1]).max() > 0.0
    for a, b in zip(ours, theirs):
        np.testing.assert_allclose(a, b.numpy(), atol=1e-12)


def test_a_urdf_is_verified_with_its_rotor_inertia(tmp_path):
    """A URDF cannot hold what was found: MuJoCo gets it from the table of values, and its solver constants that go by it."""
    case = residyn._residyn.simulate_case("rotor_inertia", 1, tmp_path)
    report = residyn.diagnose(str(case / "robot.urdf"), case / "train.parquet", case / "test.parquet", fast=True)
    assert "rotor_inertia" in [c.effect for c in report.causes], str(report)
    written = report.patch(tmp_path / "fixed.urdf")
    before, after = in_mujoco.rotor_inertias(tmp_path / "fixed.values.tsv")
    assert list(after) == report.joints and after != before
    loaded = in_mujoco.Simulated(written[0], report.joints, rotors=after).model
    again = mujoco.MjModel.from_xml_path(str(written[0]))
    assert np.array_equal(loaded.dof_armature, list(after.values()))
    assert (loaded.dof_invweight0 < again.dof_invweight0).any()
    given, patched, *_ = rows = verify.verify(report, case / "robot.urdf", written)
    print(f"\nURDF\n{verify.table(rows)}")
    assert given.mujoco == pytest.approx(given.report, rel=0.05)
    assert patched.mujoco == pytest.approx(patched.report, rel=0.05)
    assert "left out" not in verify.table(rows)
    # Without the table nobody knows the rotors.
    with pytest.raises(residyn.InputError, match="table of values"):
        verify.verify(report, case / "robot.urdf", written[:1])
    with pytest.raises(residyn.InputError, match="MuJoCo cannot load"):
        (tmp_path / "bad.xml").write_text("<mujoco><worldbody><geom/></mujoco>")
        in_mujoco.Simulated(tmp_path / "bad.xml", report.joints)


def test_a_joint_without_a_figure_is_named():
    row = in_mujoco.Row("as given", 0.1, 0.1, 0.0, (0.1, float("nan")), 0.5, ("wrist",))
    assert verify.table([row]).splitlines()[-1].endswith("never changes: wrist")
    assert np.isnan(in_mujoco._mean(np.array([np.nan]))) and in_mujoco._mean(np.array([0.5, np.nan])) == 0.5


def test_a_drive_file_is_read_in_every_mode_that_has_recordings(tmp_path, capsys):
    missing = str(tmp_path / "none.toml")
    given = ["--robot", str(MODEL), "--data", "a.csv", "--heldout", "b.csv", "--patch", "c.xml", "--drive", missing]
    assert verify.main(given) == 2
    assert "none.toml" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        verify.main(["--table", "--drive", missing])


def test_wrong_joints_are_named():
    with pytest.raises(residyn.InputError, match="no joint named elbow_2"):
        in_mujoco.Simulated(MODEL, ["elbow_2"])


def test_effect_by_effect(capsys):
    """A robot with an effect, its diagnosis, and MuJoCo's error with the corrected model; what no simulator holds is said."""
    assert verify.main(["--table", "--effects", "payload,time_delay"]) == 0
    head, payload, delay = capsys.readouterr().out.splitlines()
    assert head.split()[:1] == ["effect"] and payload.split()[-1].startswith("payload"), payload
    assert "not a simulator's matter" in delay
    assert verify.main(["--table", "--effects", "ripples"]) == 2
    assert "no such effect" in capsys.readouterr().err


def test_what_lies_beside_a_patched_urdf(tmp_path):
    """A layer that opens over a stage of the joints, angles in degrees; generated code of another diagnosis is removed."""
    case = residyn._residyn.simulate_case("payload", 1, tmp_path)
    report = residyn.diagnose(str(case / "robot.urdf"), case / "train.parquet", case / "test.parquet", fast=True)
    (tmp_path / "fixed_mujoco.py").write_text('"""What `diagnose` found and no parameter of MuJoCo holds, of last week."""\n')
    (tmp_path / "fixed_isaaclab.py").write_text("mine = 1\n")
    # Both recordings are of one clock, trajectory by trajectory in turn: so does friction remember.
    session, motion = report.session(), report.motion()
    own = np.flatnonzero(session["row"] >= 0)
    assert np.all(np.diff(session["time"]) > 0) and len(own) < len(session["row"])
    order = own[np.argsort(session["row"][own])]
    for name in ("time", "q", "qd", "qdd"):
        np.testing.assert_array_equal(session[name][order], motion[name])
    written = {p.name for p in report.patch(tmp_path / "fixed.urdf")}
    assert written == {"fixed.urdf", "fixed.sdf", "fixed.usda", "fixed.mjcf.xml", "fixed.values.tsv"}
    assert not (tmp_path / "fixed_mujoco.py").exists()
    assert (tmp_path / "fixed_isaaclab.py").exists()
    Usd = pytest.importorskip("pxr.Usd", reason="PyPI usd-core is not installed: nobody opens the layer")
    stage = Usd.Stage.Open(str(tmp_path / "fixed.usda"))
    rows = [line.split("\t") for line in (tmp_path / "fixed.values.tsv").read_text().splitlines()]
    settings = [row for row in rows if len(row) == 8 and row[0] in report.joints]
    assert len(settings) == 3 * len(report.joints)
    for joint, what, _, value, unit, *_ in settings:
        name = {"viscous friction": "damping", "Coulomb friction": "friction", "rotor inertia": "armature"}[what]
        prim = next(p for p in Usd.PrimRange.AllPrims(stage.GetPseudoRoot()) if p.GetName() == joint)
        assert str(prim.GetPath().GetParentPath()).endswith("/Physics")
        scale = np.pi / 180.0 if name == "damping" and "rad" in unit else 1.0
        assert prim.GetAttribute(f"newton:{name}").Get() == pytest.approx(scale * float(value), rel=1e-6, abs=1e-12)
