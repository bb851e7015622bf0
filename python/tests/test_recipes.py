"""Every recipe reads its robot's own log as what it is: the same figures as of the same recording in SI units, and a corrected model.

The recordings are of simulated arms with as many joints, written as the robot's driver does.
"""

import json
import math
import subprocess

import numpy as np
import pytest
import residyn

pa = pytest.importorskip("pyarrow", reason="PyPI pyarrow is not installed: recipes are not run")
pytest.importorskip("mcap", reason="PyPI mcap is not installed: recipes are not run")
typesys = pytest.importorskip("rosbags.typesys", reason="PyPI rosbags is not installed: recipes are not run")
from bags import JOINT_STATE, RECIPES, T, bag, current, header, stamps, state, store, ur5e  # noqa: E402

FRANKA = "franka_msgs/msg/FrankaRobotState"
LBR = "lbr_fri_idl/msg/LBRState"
#: Seed of `simulate cases` whose first case is an arm with so many joints.
SEEDS = {5: 1, 6: 11, 7: 8}

store.register(typesys.get_types_from_msg("std_msgs/Header header\nsensor_msgs/JointState measured_joint_state\nfloat64[7] ddq_d\n", FRANKA))
store.register(
    typesys.get_types_from_msg(
        "float64 sample_time\nint8 session_state\nuint32 time_stamp_sec\nuint32 time_stamp_nano_sec\n"
        "float64[7] measured_joint_position\nfloat64[7] measured_torque\nfloat64[7] external_torque\n",
        LBR,
    )
)


@pytest.fixture(scope="session")
def arm(program, tmp_path_factory):
    """URDF, and recordings to fit and to hold out, of an arm with so many joints."""

    def make(joints):
        out = tmp_path_factory.mktemp("arm")
        program("simulate", "cases", "--cases", 1, "--seed", SEEDS[joints], "--out", out, "--quiet")
        folder = next((out / "cases").iterdir())
        both = []
        for name, count in (("train", 3), ("test", 2)):
            whole = residyn.Recording.read(folder / f"{name}.parquet")
            end = whole.starts[count] if count < len(whole.starts) else len(whole)
            part = {n: getattr(whole, n)[:end] for n in ("time", "q", "qd", "tau")}
            both.append(residyn.Recording(**part, starts=whole.starts[:count]))
        assert both[0].dof == joints
        return folder / "robot.urdf", both

    return make


def xarm(path, recording, names):
    rows = zip(stamps(recording), recording.q, recording.qd, recording.tau)
    order = list(range(len(names)))
    bag(path, "/xarm/joint_states", JOINT_STATE, ((ns, state(ns, names, order, *row)) for ns, *row in rows))


def fr3(path, recording, names):
    def messages():
        for ns, *row in zip(stamps(recording), recording.q, recording.qd, recording.tau):
            inner = state(ns, names, list(range(7)), *row)
            yield ns, T[FRANKA](header=header(ns), measured_joint_state=inner, ddq_d=np.zeros(7))

    bag(path, "/franka_robot_state_broadcaster/robot_state", FRANKA, messages())


def iiwa(path, recording, names):
    def messages():
        for ns, q, tau in zip(stamps(recording), recording.q, recording.tau):
            yield ns, T[LBR](
                sample_time=0.005, session_state=4, time_stamp_sec=ns // 10**9, time_stamp_nano_sec=ns % 10**9,
                measured_joint_position=q.copy(), measured_torque=tau.copy(), external_torque=np.zeros(7),
            )  # fmt: skip

    bag(path, "/lbr/state", LBR, messages())


def so101(path, recording, names):
    import pyarrow.parquet as pq

    motors = ["shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper"]
    labels = [f"{m}.{what}" for m in motors for what in ("pos", "current")]
    position = np.degrees(recording.q)
    ampere = current("so101", recording.tau)
    both = np.zeros((len(recording), 12))
    both[:, 0:10:2], both[:, 1:10:2] = position, ampere
    starts = np.array(recording.starts)
    episode = np.searchsorted(starts, np.arange(len(recording)), side="right") - 1
    table = pa.table(
        {
            "observation.state": pa.array(list(both), pa.list_(pa.float64(), 12)),
            "timestamp": recording.time - recording.time[starts[episode]],
            "episode_index": episode,
        }
    )
    (path / "meta").mkdir(parents=True)
    (path / "data/chunk-000").mkdir(parents=True)
    info = {"codebase_version": "v3.0", "features": {"observation.state": {"dtype": "float32", "shape": [12], "names": labels}}}
    (path / "meta/info.json").write_text(json.dumps(info))
    pq.write_table(table, path / "data/chunk-000/file-000.parquet")


#: Robot, joints, how its log is written, ending of the log.
ROBOTS = [(ur5e, 6, ".mcap"), (fr3, 7, ".mcap"), (xarm, 7, ".mcap"), (so101, 5, ""), (iiwa, 7, ".mcap")]


@pytest.mark.parametrize("write, joints, ending", ROBOTS, ids=[r[0].__name__ for r in ROBOTS])
def test_a_recipe_reads_the_robots_own_log(write, joints, ending, arm, program, tmp_path):
    robot, recordings = arm(joints)
    names = residyn.Robot(str(robot)).joints
    logs = []
    for name, recording in zip(("train", "test"), recordings):
        logs.append(tmp_path / f"{name}{ending}")
        write(logs[-1], recording, names)
    out = tmp_path / "out"
    command = [RECIPES / "diagnose.sh", write.__name__, robot, *logs, out, "--fast"]
    said = subprocess.run(list(map(str, command)), capture_output=True, text=True, env=program.environment)
    assert said.returncode == 0, said.stderr + said.stdout
    assert (out / "gap.html").stat().st_size > 10_000
    assert "<robot" in (out / "corrected.urdf").read_text()
    # The same recording in SI units, with velocity only where the robot's log has it.
    plain = []
    for name, recording in zip(("train", "test"), recordings):
        plain.append(tmp_path / f"{name}.parquet")
        qd = recording.qd if write in (ur5e, fr3, xarm) else None
        residyn.Recording(recording.time, recording.q, recording.tau, qd=qd, starts=recording.starts).write(plain[-1])
    program("diagnose", "--robot", robot, "--data", plain[0], "--heldout", plain[1], "--fast", "--json", tmp_path / "plain.json")
    own, si = (json.loads(p.read_text()) for p in (out / "gap.json", tmp_path / "plain.json"))
    assert own["verdict"] == si["verdict"]
    assert [c["effect"] for c in own["causes"]] == [c["effect"] for c in si["causes"]]
    for a, b in zip(own["ladder"], si["ladder"]):
        assert a["step"] == b["step"]
        assert math.isclose(a["mean_nrmse"], b["mean_nrmse"], rel_tol=1e-3), (a["step"], a["mean_nrmse"], b["mean_nrmse"])


def test_an_unknown_robot_is_refused(tmp_path):
    said = subprocess.run([str(RECIPES / "diagnose.sh"), "r2d2", "a", "b", "c", str(tmp_path)], capture_output=True, text=True)
    assert said.returncode == 2
    assert "ur5e.toml" in said.stderr
    said = subprocess.run([str(RECIPES / "diagnose.sh")], capture_output=True, text=True)
    assert said.returncode == 2
    assert "usage" in said.stderr
