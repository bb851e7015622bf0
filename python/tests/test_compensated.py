"""A trained compensator inside MuJoCo, against the model in a control loop over the same motion."""

import numpy as np
import pytest

import residyn

mujoco = pytest.importorskip("mujoco")


@pytest.fixture(scope="module")
def trained(program, tmp_path_factory):
    """A case and a small model of it."""
    folder = tmp_path_factory.mktemp("trained")
    program("simulate", "cases", "--only", "stribeck_friction", "--cases", "1", "--seed", "3", "--out", folder)
    (case,) = (folder / "cases").iterdir()
    training = ["--robot", case / "robot.urdf", "--data", case / "train.parquet", "--members", "1", "--epochs", "5"]
    program("train", *training, "--out", folder / "model", "--quiet")
    program("train", *training, "--physics-only", "--out", folder / "physics", "--quiet")
    return case, folder


@pytest.fixture
def passive():
    yield mujoco.set_mjcb_passive
    mujoco.set_mjcb_passive(None)


def simulated(case, step):
    model = mujoco.MjModel.from_xml_path(str(case / "robot.urdf"))
    model.opt.timestep, model.opt.integrator = step, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    return model


def test_its_torque_is_that_of_a_control_loop_over_the_same_motion(trained, passive):
    case, folder = trained
    period = residyn.Model(folder / "model").period
    model = simulated(case, period)
    learned = residyn.Compensated(folder / "model", model)
    recorded = residyn.Recording.read(case / "test.parquet", residyn.Robot(str(case / "robot.urdf")))
    rows = 1000
    q_ref, data, seen = recorded.q[:rows], mujoco.MjData(model), []

    def callback(m, d):
        learned(m, d)
        seen.append((d.time, d.qpos.copy(), d.qvel.copy(), d.qacc.copy(), learned.torque.copy()))

    data.qpos[:] = q_ref[0]
    kp, kd = 900.0 * model.dof_M0, 50.0 * model.dof_M0
    passive(callback)
    for k in range(rows):
        data.qfrc_applied[:] = kp * (q_ref[k] - data.qpos) - kd * data.qvel
        mujoco.mj_step(model, data)
    passive(None)
    time, q, qd, qdd, torque = (np.array(column) for column in zip(*seen))
    assert len(time) == rows and np.allclose(np.diff(time), period)
    loop = residyn.Model(folder / "model")
    for row in range(rows):
        loop.torque(q[row], qd[row], qdd[row])
        assert np.array_equal(torque[row], -loop.compensation)
    assert np.sqrt(np.mean(torque**2)) > 1e-3
    # Set back, it has forgotten the motion; within a step it computes nothing anew.
    mujoco.mj_resetData(model, data)
    data.qpos[:] = q_ref[0]
    passive(learned)
    for _ in range(2):
        mujoco.mj_forward(model, data)
        assert np.array_equal(learned.torque, torque[0])


def test_each_copy_of_an_arm_has_a_memory_of_its_own(trained, passive):
    case, folder = trained
    model = simulated(case, residyn.Model(folder / "model").period)
    learned, alone = (residyn.Compensated(folder / "model", model) for _ in range(2))

    def copies():
        made = [mujoco.MjData(model) for _ in range(2)]
        made[0].qvel[:], made[1].qvel[:] = 0.4, -0.2
        return made

    # Both in turn by one callback, then each by one that sees no other.
    pair, apart = copies(), copies()
    passive(learned)
    for _ in range(50):
        for data in pair:
            mujoco.mj_step(model, data)
    for data in apart:
        alone.reset()
        passive(alone)
        for _ in range(50):
            mujoco.mj_step(model, data)
    assert np.array_equal(pair[0].qpos, apart[0].qpos) and np.array_equal(pair[1].qpos, apart[1].qpos)
    assert not np.array_equal(pair[0].qpos, pair[1].qpos)
    # One that is forgotten starts anew, the other goes on.
    passive(learned)
    mujoco.mj_forward(model, pair[1])
    before = learned.torque.copy()
    learned.reset(pair[0])
    mujoco.mj_forward(model, pair[0])
    fresh = residyn.Model(folder / "model")
    fresh.torque(pair[0].qpos, pair[0].qvel, apart[0].qacc)
    assert np.array_equal(learned.torque, -fresh.compensation)
    mujoco.mj_forward(model, pair[1])
    assert np.array_equal(learned.torque, before)


def test_what_it_cannot_do_is_refused(trained):
    case, folder = trained
    model = simulated(case, 0.004)
    with pytest.raises(residyn.InputError, match="no compensator"):
        residyn.Compensated(folder / "physics", model)
    with pytest.raises(residyn.InputError, match="no joint named elbow"):
        residyn.Compensated(folder / "model", model, ["elbow", *residyn.Model(folder / "model").joints[1:]])
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    with pytest.raises(residyn.InputError, match="RK4"):
        residyn.Compensated(folder / "model", model)
