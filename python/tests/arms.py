"""Small arms as text, each beside the real one that differs from it: with a payload, other friction, a jaw that is welded."""

import json

import mujoco
import numpy as np

#: Recorded motion: s, Hz; torque noise, part of its deviation.
LENGTH, RATE, NOISE = 24.0, 100.0, 0.01

#: Arms by name: format, and by joint the axis, place in the link before (m), mass (kg), centre of mass (m), size (m) and rotor inertia (kg·m²).
#: The last joint is the gripper's jaw.
ARMS = {
    "desk": ("mjcf", [("0 0 1", (0, 0, 0.1), 0.5, (0.0, 0.01, 0.04), 0.05, 0.02), ("0 1 0", (0, 0, 0.06), 0.3, (0.06, 0, 0.01), 0.05, 0.02),
                      ("0 1 0", (0.14, 0, 0), 0.2, (0.05, 0.005, 0), 0.04, 0.01), ("1 0 0", (0.13, 0, 0), 0.05, (0.03, 0, 0.01), 0.03, 0.005)]),
    "lab": ("mjcf", [("0 0 1", (0, 0, 0.2), 4.0, (0.01, 0, 0.06), 0.1, 0.2), ("0 1 0", (0, 0, 0.15), 3.0, (0.15, 0.02, 0), 0.1, 0.2),
                     ("0 1 0", (0.35, 0, 0), 2.0, (0.14, 0, 0.02), 0.08, 0.1), ("1 0 0", (0.3, 0, 0), 0.4, (0.05, 0, 0.02), 0.05, 0.02)]),
    "crane": ("mjcf", [("0 1 0", (0, 0, 0.8), 12.0, (0.25, 0, 0.03), 0.2, 1.0), ("0 1 0", (0.6, 0, 0), 7.0, (0.2, 0.03, 0), 0.15, 0.5),
                       ("0 0 1", (0.5, 0, 0), 1.5, (0.1, 0.04, 0), 0.08, 0.1)]),
    "slider": ("mjcf", [("slide 1 0 1", (0, 0, 0.3), 3.0, (0.0, 0.02, 0), 0.1, 1.0), ("0 1 0", (0.1, 0, 0), 2.0, (0.15, 0, 0.03), 0.1, 0.1),
                        ("1 0 0", (0.35, 0, 0), 0.3, (0.04, 0.02, 0.02), 0.05, 0.01)]),
    "bench": ("urdf", [("0 0 1", (0, 0, 0.1), 1.0, (0.0, 0.01, 0.05), 0.06, 0), ("0 1 0", (0, 0, 0.08), 0.8, (0.1, 0, 0.01), 0.06, 0),
                       ("0 1 0", (0.2, 0, 0), 0.5, (0.08, 0.01, 0), 0.05, 0), ("1 0 0", (0.18, 0, 0), 0.1, (0.03, 0, 0.015), 0.04, 0)]),
    "shop": ("urdf", [("0 0 1", (0, 0, 0.3), 8.0, (0.02, 0, 0.08), 0.15, 0), ("0 1 0", (0, 0, 0.2), 6.0, (0.2, 0, 0.05), 0.12, 0),
                      ("0 1 0", (0.45, 0, 0), 3.5, (0.15, 0.02, 0), 0.1, 0), ("1 0 0", (0.4, 0, 0), 0.8, (0.06, 0, 0.03), 0.06, 0)]),
    "wrist": ("urdf", [("0 1 0", (0, 0, 0.4), 2.0, (0.1, 0, 0.02), 0.08, 0), ("1 0 0", (0.25, 0, 0), 1.0, (0.03, 0.03, 0), 0.06, 0),
                       ("0 1 0", (0.1, 0, 0), 0.4, (0.05, 0.01, 0), 0.05, 0)]),
    "boom": ("urdf", [("0 0 1", (0, 0, 0.5), 10.0, (0.1, 0.02, 0.1), 0.2, 0), ("0 1 0", (0.1, 0, 0.2), 9.0, (0.3, 0, 0), 0.15, 0),
                      ("0 1 0", (0.7, 0, 0), 4.0, (0.2, 0, 0.02), 0.1, 0)]),
}

#: Arm, payload in kg, and whether the jaw is a joint of the chain or fixed at its reference.
CASES = [
    ("desk", 0.05, "fixed"),
    ("desk", 0.15, "free"),
    ("lab", 0.5, "fixed"),
    ("lab", 2.0, "free"),
    ("crane", 5.0, "fixed"),
    ("crane", 2.0, "free"),
    ("slider", 0.5, "fixed"),
    ("slider", 1.0, "free"),
    ("bench", 0.1, "fixed"),
    ("bench", 0.3, "free"),
    ("shop", 3.0, "fixed"),
    ("shop", 1.0, "free"),
    ("wrist", 0.2, "fixed"),
    ("wrist", 0.5, "free"),
    ("boom", 5.0, "fixed"),
    ("boom", 1.5, "free"),
]


def friction(mass):
    """Damping and dry friction of a joint that moves a link of this mass, N·m·s/rad and N·m (N·s/m and N)."""
    return 0.3 * mass, 0.2 * mass


def text(arm, payload=0.0, rubbing=1.0, fixed=False):
    """A description, with a ball of `payload` kg in the jaw and all friction `rubbing` times what it is; `fixed`: the real jaw is welded."""
    form, links = ARMS[arm]
    mjcf, body, tail = form == "mjcf", "", ""
    for k, (axis, at, mass, com, size, rotor) in enumerate(links):
        kind, axis = ("slide", axis[6:]) if axis.startswith("slide") else ("hinge", axis)
        damping, loss = (rubbing * f for f in friction(mass))
        moment = [0.4 * mass * size**2 * f for f in (1.0, 1.2, 0.8)]
        place, centre = (" ".join(map(str, v)) for v in (at, com))
        joint = not (fixed and k == len(links) - 1)
        last = payload and k == len(links) - 1
        ball, radius = (f"{com[0] + 0.04} {com[1]} {com[2]}", (3 * payload / (4000 * np.pi)) ** (1 / 3))
        inertia = 0.4 * payload * radius**2
        if mjcf:
            body += f'<body name="l{k}" pos="{place}"><inertial pos="{centre}" mass="{mass}" diaginertia="{moment[0]} {moment[1]} {moment[2]}"/>'
            if joint:
                body += f'<joint name="j{k}" type="{kind}" axis="{axis}" range="-3 3" damping="{damping}" frictionloss="{loss}" armature="{rotor}"/>'
            if last:
                body += f'<body name="ball" pos="{ball}"><inertial pos="0 0 0" mass="{payload}" diaginertia="{inertia} {inertia} {inertia}"/></body>'
            tail += "</body>"
        else:
            inertial = '<link name="{}"><inertial><origin xyz="{}"/><mass value="{}"/><inertia ixx="{}" iyy="{}" izz="{}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            of = '<parent link="{}"/><child link="{}"/><origin xyz="{}"/>'
            body += inertial.format(f"l{k}", centre, mass, *moment)
            ends = of.format("base" if k == 0 else f"l{k - 1}", f"l{k}", place)
            if joint:
                body += f'<joint name="j{k}" type="revolute">{ends}<axis xyz="{axis}"/><limit lower="-3" upper="3" effort="900" velocity="5"/>'
                body += f'<dynamics damping="{damping}" friction="{loss}"/></joint>'
            else:
                body += f'<joint name="j{k}" type="fixed">{ends}</joint>'
            if last:
                body += inertial.format("ball", "0 0 0", payload, *3 * [inertia])
                body += f'<joint name="held" type="fixed">{of.format(f"l{k}", "ball", ball)}</joint>'
    if mjcf:
        return f'<mujoco model="{arm}"><compiler angle="radian"/><worldbody>{body}{tail}</worldbody></mujoco>'
    return f'<robot name="{arm}"><mujoco><compiler fusestatic="false"/></mujoco><link name="base"/>{body}</robot>'


def waves(n, seed):
    """A sum of sines per joint: positions, velocities and accelerations at times."""
    rng = np.random.default_rng(seed)
    w = 2 * np.pi * np.array([0.13, 0.29, 0.47, 0.71]) * rng.uniform(0.9, 1.1, (n, 4))
    size, phase = 0.35 * rng.uniform(0.6, 1.0, (n, 4)) / (1 + 2 * w / 6.3), rng.uniform(0, 6.28, (n, 4))

    def at(t):
        a = w * np.asarray(t)[:, None, None] + phase
        return (size * np.sin(a)).sum(2), (size * w * np.cos(a)).sum(2), -(size * w * w * np.sin(a)).sum(2)

    return at


def recording(model, n, seed):
    """A table of the arm's motion and its torque, as CSV."""
    data = mujoco.MjData(model)
    t = np.arange(int(LENGTH * RATE)) / RATE
    q, qd, qdd = waves(n, seed)(t)
    tau, inertial = np.empty_like(q), np.zeros(model.nv)
    for i in range(len(t)):
        data.qpos[:n], data.qvel[:n] = q[i], qd[i]
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_mulM(model, data, inertial, qdd[i])
        rubs = model.dof_damping[:n].ravel() * qd[i] + model.dof_frictionloss[:n] * np.tanh(qd[i] / 1e-3)
        tau[i] = inertial + data.qfrc_bias + rubs
    tau += NOISE * tau.std(0) * np.random.default_rng(seed + 100).normal(size=tau.shape)
    head = ",".join(["time", *(f"q{j + 1}" for j in range(n)), *(f"tau{j + 1}" for j in range(n))])
    rows = np.column_stack([t, q, tau])
    return head + "\n" + "\n".join(",".join(f"{v:.9g}" for v in row) for row in rows) + "\n"


class Diagnosed:
    """What `diagnose` said and wrote of one case, in a folder of its own."""

    def __init__(self, program, folder, arm, payload, gripper):
        fixed = gripper == "fixed"
        form, links = ARMS[arm]
        ending = ".xml" if form == "mjcf" else ".urdf"
        self.folder, self.links, self.n = folder, links, len(links) - fixed
        self.given, self.written = folder / f"robot{ending}", folder / f"fixed{ending}"
        self.given.write_text(text(arm))
        self.real = mujoco.MjModel.from_xml_string(text(arm, payload, 1.4, fixed))
        for name, seed in (("train", 1), ("test", 2)):
            (folder / f"{name}.csv").write_text(recording(self.real, self.n, seed))
        joints = ",".join(f"j{k}" for k in range(self.n))
        before = {p.name for p in folder.rglob("*")}
        ended = program(
            "diagnose", "--robot", self.given, "--joints", joints, "--data", folder / "train.csv", "--heldout", folder / "test.csv",
            "--fast", "--json", folder / "r.json", "--html", folder / "r.html", "--patch", self.written,
        )
        self.said = ended.stdout
        self.made = {p.name for p in folder.rglob("*")} - before
        self.report = json.loads((folder / "r.json").read_text())

    def models(self):
        """The given and the written model in MuJoCo."""
        return tuple(mujoco.MjModel.from_xml_path(str(p)) for p in (self.given, self.written))
