"""ROS 2 bags of simulated recordings, as robots' drivers write them. Needs PyPI mcap and rosbags."""

import tomllib
from pathlib import Path

import numpy as np
from mcap.writer import Writer
from rosbags import typesys

RECIPES = Path(__file__).resolve().parents[2] / "recipes"
JOINT_STATE = "sensor_msgs/msg/JointState"
START = 1_790_000_000_000_000_000

store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
T = store.types


def stamps(recording):
    """Of each sample, ns; trajectories lie apart on one clock."""
    return [START + round(t * 1e9) for t in recording.time]


def header(ns):
    return T["std_msgs/msg/Header"](stamp=T["builtin_interfaces/msg/Time"](sec=ns // 10**9, nanosec=ns % 10**9), frame_id="base")


def state(ns, names, order, *columns):
    return T[JOINT_STATE](header(ns), [names[i] for i in order], *(np.ascontiguousarray(c[order]) for c in columns))


def bag(path, topic, kind, messages):
    """Writes pairs of time stamp in ns and message to one topic."""
    with open(path, "wb") as file:
        writer = Writer(file)
        writer.start("ros2", "bags.py")
        schema = writer.register_schema(kind, "ros2msg", store.generate_msgdef(kind, ros_version=2)[0].encode())
        channel = writer.register_channel(topic, "cdr", schema)
        for ns, message in messages:
            writer.add_message(channel, ns, bytes(store.serialize_cdr(message, kind)), ns)
        writer.finish()


def drive(robot):
    return tomllib.loads((RECIPES / f"{robot}.toml").read_text())


def current(robot, tau):
    """What a drive with the recipe's constants records of a joint's torque."""
    said = drive(robot)
    return tau / (np.array(said["gear_ratio"]) * np.array(said["torque_constant"]))


def ur5e(path, recording, names):
    order = [2, 1, 0, 3, 4, 5]  # as the driver publishes them
    effort = current("ur5e", recording.tau)
    rows = zip(stamps(recording), recording.q, recording.qd, effort)
    bag(path, "/joint_states", JOINT_STATE, ((ns, state(ns, names, order, q, qd, e)) for ns, q, qd, e in rows))
