"""A compensator over many arms at once, in NumPy and in torch, against the model in a control loop, `eval` and MuJoCo."""

import shutil

import numpy as np
import pytest
from learned_models import KINDS, rewrite

import residyn
from residyn.isaac_lab import resisting
from residyn.learned.arrays import Arrays
from residyn.learned.chain import Chain

mujoco = pytest.importorskip("mujoco")

#: Largest error over the RMS of the torque.
CLOSE = 1e-5


@pytest.fixture(scope="module")
def trained(program, tmp_path_factory):
    """A case and a small model of it."""
    folder = tmp_path_factory.mktemp("learned")
    program("simulate", "cases", "--only", "stribeck_friction", "--cases", "1", "--seed", "3", "--out", folder)
    (case,) = (folder / "cases").iterdir()
    training = ["--robot", case / "robot.urdf", "--data", case / "train.parquet", "--members", "2", "--epochs", "5"]
    program("train", *training, "--out", folder / "model", "--quiet")
    program("train", *training, "--physics-only", "--out", folder / "physics", "--quiet")
    return case, folder


@pytest.fixture(scope="module")
def motions(trained):
    """Positions, velocities and accelerations of three motions, shape (rows, arms, joints)."""
    case, _ = trained
    recorded = residyn.Recording.read(case / "test.parquet", residyn.Robot(str(case / "robot.urdf")))
    starts = [0, 700, 1900]
    q = np.stack([recorded.q[start : start + 300] for start in starts], 1)
    step = np.median(np.diff(recorded.time))
    qd = np.gradient(q, step, axis=0)
    return q, qd, np.gradient(qd, step, axis=0)


@pytest.fixture(params=["numpy", "torch"])
def device(request):
    """None for NumPy, a device of torch else."""
    if request.param == "torch":
        pytest.importorskip("torch", reason="torch is not installed: its half of the test does not run")
        return "cpu"
    return None


def in_loops(directory, motions, anew, period=None):
    """Compensator's and whole torque by the model's control loop, one for each arm, which starts anew before the rows of `anew`."""
    loops = [residyn.Model(directory, period=period) for _ in range(motions[0].shape[1])]
    parts, whole = np.empty_like(motions[0]), np.empty_like(motions[0])
    for row, rows in enumerate(zip(*motions)):
        for arm, loop in enumerate(loops):
            if (row, arm) in anew:
                loop.reset()
            whole[row, arm] = loop.torque(*(x[arm] for x in rows))
            parts[row, arm] = loop.compensation
    return parts, whole


def close(given, parts, whole):
    rms = min(np.sqrt(np.mean(whole**2)), np.abs(parts).max())
    worst = np.abs(given - parts).max()
    print(f"worst {worst:.1e} N·m, torque {np.sqrt(np.mean(whole**2)):.2f} RMS, largest learned {np.abs(parts).max():.3f}")
    assert np.abs(parts).max() > 0.01
    assert worst <= CLOSE * rms


@pytest.mark.parametrize("kind", ["trained", *KINDS])
@pytest.mark.parametrize("turns", [1, 2])
def test_its_torque_is_that_of_a_control_loop(trained, motions, device, kind, turns, tmp_path):
    directory = trained[1] / "model"
    if kind != "trained":
        directory = shutil.copytree(directory, tmp_path / "model")
        rewrite(directory, KINDS[kind], np.random.default_rng(5))
    # A loop twice as fast as in training takes two windows in turn.
    period = residyn.Model(directory).period / turns
    anew = [(100, 1), (101, 1), (180, 2)]
    parts, whole = in_loops(directory, motions, anew, period)
    learned = residyn.Learned(directory, 3, period=period, device=device)
    assert learned.joints == residyn.Model(directory).joints and learned.period == period
    given = np.empty_like(parts)
    for row, rows in enumerate(zip(*motions)):
        learned.reset([arm for at, arm in anew if at == row])
        given[row] = np.asarray(learned.torque(*(learned._arrays.of(x) for x in rows)))
    close(given, parts, whole)


def test_an_arm_whose_motion_is_not_finite_is_left_out(trained, motions, device):
    directory = trained[1] / "model"
    spoilt = [x[:40].copy() for x in motions]
    spoilt[1][20, 1, 2] = np.nan
    learned = residyn.Learned(directory, 3, device=device)
    given = np.array([np.asarray(learned.torque(*rows)) for rows in zip(*spoilt)])
    assert np.all(np.isfinite(given)) and np.all(given[20, 1] == 0.0)
    # The others notice nothing; this one goes on from where it was.
    parts, whole = in_loops(directory, [x[:, [0, 2]] for x in spoilt], [])
    close(given[:, [0, 2]], parts, whole)
    skipped = np.delete(np.arange(40), 20)
    parts, whole = in_loops(directory, [x[skipped, 1:2] for x in spoilt], [])
    assert np.abs(given[skipped, 1:2] - parts).max() <= CLOSE * np.sqrt(np.mean(whole**2))


def test_far_from_its_training_it_gives_nothing_and_says_so(trained, motions, device):
    learned = residyn.Learned(trained[1] / "model", 3, device=device)
    q, qd, qdd = (x[0].copy() for x in motions)
    learned.torque(q, qd, qdd)
    excess = np.asarray(learned.excess)
    assert np.all(excess[np.isfinite(excess)] < 0.1)
    qd[1] += 50.0
    torque = np.asarray(learned.torque(q, qd, qdd))
    assert np.all(torque[1] == 0.0) and np.any(torque[[0, 2]] != 0.0)
    assert np.max(np.asarray(learned.excess)[1]) > 0.6


def test_accelerations_that_are_not_given_are_differences(trained, motions):
    period = residyn.Model(trained[1] / "model").period
    q, qd, _ = motions
    qdd = np.concatenate([np.zeros_like(qd[:1]), np.diff(qd, axis=0) / period])
    one, other = (residyn.Learned(trained[1] / "model", 3) for _ in range(2))
    for row in range(50):
        assert np.array_equal(one.torque(q[row], qd[row]), other.torque(q[row], qd[row], qdd[row]))


SLIDING = """
<mujoco><option gravity="1 -2 -9"/><compiler angle="radian"/><worldbody>
  <body pos="0.1 0.2 0.3" euler="0.3 -0.2 0.5"><joint name="a" axis="0 0 1"/>
    <inertial pos="0.1 -0.05 0.2" mass="3" fullinertia="0.3 0.25 0.2 0.01 -0.02 0.03"/>
    <body pos="0.3 0 0.1" euler="-0.4 0.1 0.2"><joint name="b" type="slide" axis="0.6 0 0.8"/>
      <inertial pos="0.02 0.1 -0.1" mass="2" fullinertia="0.1 0.15 0.12 0.02 0.01 -0.01"/>
      <body pos="0 0.2 0.1" euler="0.7 0 -0.3"><joint name="c" axis="0 1 0"/>
        <inertial pos="0.1 0.1 0.05" mass="1" fullinertia="0.05 0.06 0.04 0.005 0 0.004"/>
</body></body></body></worldbody></mujoco>"""


def chain_of(model):
    """The chain of an MJCF without offsets of joints, as the extension module gives it."""
    for body in range(1, model.nbody):
        rotation, inner = np.empty(9), np.empty(9)
        mujoco.mju_quat2Mat(rotation, model.body_quat[body])
        mujoco.mju_quat2Mat(inner, model.body_iquat[body])
        inner, mass, com = inner.reshape(3, 3), model.body_mass[body], model.body_ipos[body]
        about = inner @ np.diag(model.body_inertia[body]) @ inner.T + mass * (com @ com * np.eye(3) - np.outer(com, com))
        yield {
            "name": model.joint(body - 1).name,
            "slides": bool(model.jnt_type[body - 1] == mujoco.mjtJoint.mjJNT_SLIDE),
            "axis": list(model.jnt_axis[body - 1]),
            "rotation": list(rotation),
            "translation": list(model.body_pos[body]),
            "parameters": [mass, *(mass * com), about[0, 0], about[0, 1], about[1, 1], about[0, 2], about[1, 2], about[2, 2]],
            "held": 0.0,
        }


def test_the_rigid_body_is_that_of_mujoco(device):
    model = mujoco.MjModel.from_xml_string(SLIDING)
    chain = Chain(Arrays(device), list(chain_of(model)), model.opt.gravity)
    rng, data = np.random.default_rng(1), mujoco.MjData(model)
    q, qd, qdd = (rng.uniform(-2.0, 2.0, (20, 3)) for _ in range(3))
    given = np.asarray(chain.torque(*(Arrays(device).of(x) for x in (q, qd, qdd))))
    for row in range(20):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[row], qd[row], qdd[row]
        mujoco.mj_inverse(model, data)
        assert np.allclose(given[row], data.qfrc_inverse, atol=1e-9)


class Action:
    """Stand-in for Isaac Lab's `ArticulationActions`."""

    def __init__(self, positions, velocities, efforts):
        self.joint_positions, self.joint_velocities, self.joint_efforts = positions, velocities, efforts


class PD:
    """Stand-in for Isaac Lab's `IdealPDActuator`: what `resisting` uses of it, and no more. Isaac Lab itself is not run here."""

    is_implicit_model = False

    def __init__(self, cfg, joint_names, joint_ids, num_envs, device):
        self.cfg, self._joint_names, self._num_envs, self._device = cfg, joint_names, num_envs, device

    @property
    def joint_names(self):
        return self._joint_names

    def reset(self, env_ids):
        pass

    def compute(self, control_action, joint_pos, joint_vel):
        wanted = self.cfg.stiffness * (control_action.joint_positions - joint_pos) - self.cfg.damping * joint_vel
        self.applied_effort = (wanted + control_action.joint_efforts).clip(-self.cfg.limit, self.cfg.limit)
        control_action.joint_efforts = self.applied_effort
        control_action.joint_positions = control_action.joint_velocities = None
        return control_action


class Config:
    """Stand-in for the configuration of an actuator."""

    def __init__(self, directory, period, stiffness=0.0, damping=0.0, limit=np.inf):
        self.model_directory, self.period = directory, period
        self.stiffness, self.damping, self.limit = stiffness, damping, limit


def arm(case, period):
    model = mujoco.MjModel.from_xml_path(str(case / "robot.urdf"))
    model.opt.timestep, model.opt.integrator = period, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    return model


def test_an_actuator_rolled_out_in_mujoco_resists_with_the_torque_of_eval(trained, device, tmp_path):
    case, folder = trained
    robot = residyn.Robot(str(case / "robot.urdf"))
    period = residyn.Model(folder / "model").period
    model = arm(case, period)
    recorded = residyn.Recording.read(case / "test.parquet", robot)
    rows, starts, n = 1000, [0, 1500], len(robot.joints)
    copies = [mujoco.MjData(model) for _ in starts]
    config = Config(folder / "model", period, 900.0 * model.dof_M0, 50.0 * model.dof_M0)
    arrays = Arrays(device)
    config.stiffness, config.damping = arrays.of(config.stiffness), arrays.of(config.damping)
    # The group holds the joints in another order, behind one of a gripper, and the gains with them.
    order = [2, 0, 1, *range(3, n)]
    names = ["finger", *(robot.joints[j] for j in order)]

    def grouped(rows):
        return arrays.of(np.concatenate([np.zeros((len(rows), 1)), np.asarray(rows)[:, order]], 1))

    config.stiffness, config.damping = (grouped(np.asarray(gain)[None])[0] for gain in (config.stiffness, config.damping))
    actuator = resisting(PD)(config, names, slice(None), len(starts), device)
    actuator.reset(None)
    motion, learned = [], []
    for copy, start in zip(copies, starts):
        copy.qpos[:] = recorded.q[start]
    for k in range(rows):
        q, qd = (np.stack([np.array(getattr(copy, name)) for copy in copies]) for name in ("qpos", "qvel"))
        wanted = grouped([recorded.q[start + k] for start in starts])
        action = actuator.compute(Action(wanted, 0.0 * wanted, 0.0 * wanted), grouped(q), grouped(qd))
        efforts, motor = np.asarray(action.joint_efforts), np.asarray(actuator.applied_effort)
        assert np.all(efforts[:, 0] == motor[:, 0])
        learned.append((motor - efforts)[:, 1:][:, np.argsort(order)])
        motion.append((q, qd))
        for copy, own in zip(copies, efforts[:, 1:][:, np.argsort(order)]):
            copy.qfrc_applied[:] = own
            mujoco.mj_step(model, copy)
    q, qd = (np.array(column) for column in zip(*motion))
    qdd = np.concatenate([np.zeros_like(qd[:1]), np.diff(qd, axis=0) / period])
    # The torque that acted is that of a control loop over the same motion.
    close(np.array(learned), *in_loops(folder / "model", (q, qd, qdd), []))
    # `eval` low-passes a recording first; over the motion that it sees, its torque and the physics' differ by what is learned.
    time = period * np.arange(rows)
    path = tmp_path / "rollout.npz"
    np.savez(path, time=time, q=q[:, 0], qd=qd[:, 0], qdd=qdd[:, 0])
    said = residyn.Model(folder / "model").predict(path)
    again = residyn.Learned(folder / "model", 1, device=device)
    seen = zip(said.q[:, None], said.qd[:, None], said.qdd[:, None])
    given = np.array([np.asarray(again.torque(*row))[0] for row in seen])
    close(given, said.torque - said.physics, said.torque)


def test_what_it_cannot_do_is_refused(trained):
    case, folder = trained
    with pytest.raises(residyn.InputError, match="no compensator"):
        residyn.Learned(folder / "physics", 1)
    with pytest.raises(residyn.InputError, match="shape"):
        residyn.Learned(folder / "model", 2).torque(np.zeros((1, 6)), np.zeros((1, 6)))
    names = residyn.Model(folder / "model").joints
    with pytest.raises(residyn.InputError, match=f"lacks {names[0]}"):
        resisting(PD)(Config(folder / "model", 0.004), names[1:], slice(None), 1, None)

    class Implicit(PD):
        is_implicit_model = True

    with pytest.raises(residyn.InputError, match="explicit"):
        resisting(Implicit)
