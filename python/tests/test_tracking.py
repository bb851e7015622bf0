"""An arm in MuJoCo under a C++ loop with the model: the identified physics tracks better than the description, and Python's torques are
those of the loop. The table of docs/embedding.md comes from trials/mujoco/tracking.py."""
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco")
pytest.importorskip("residyn")
ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "trials" / "mujoco"))
import loop  # noqa: E402

BIN = os.environ.get("RESIDYN_BIN")
pytestmark = [
    pytest.mark.skipif(BIN is None, reason="RESIDYN_BIN names no folder of programs"),
    pytest.mark.skipif(shutil.which("c++") is None, reason="no C++ compiler"),
]

# An arm of two links, as described and as it is: a payload, and three times the friction.
ARM = """<mujoco><compiler angle="radian"/><option timestep="0.0005" integrator="implicitfast"/><worldbody><body name="upper">
<joint name="shoulder" axis="0 1 0" range="-2 2" armature="0.05" damping="{damping}" frictionloss="{friction}"/>
<inertial pos="0.15 0 0" mass="2" diaginertia="0.003 0.02 0.02"/><body name="fore" pos="0.3 0 0">
<joint name="elbow" axis="0 1 0" range="-2 2" armature="0.03" damping="{damping}" frictionloss="{friction}"/>
<inertial pos="0.1 0 0" mass="1" diaginertia="0.002 0.006 0.006"/>{payload}</body></body></worldbody></mujoco>"""
PAYLOAD = '<body name="payload" pos="0.22 0 0"><inertial pos="0 0 0" mass="0.5" diaginertia="0.001 0.001 0.001"/></body>'


def motion(seed, t):
    """Rows of q, qd, qdd: four harmonics per joint."""
    rng = np.random.default_rng(seed)
    omega = 2 * np.pi * rng.uniform(0.15, 0.25) * np.arange(1, 5)
    a = rng.normal(size=(4, 2)) * 0.7 / omega[:, None]
    phase = np.outer(t, omega)
    return np.hstack([np.sin(phase) @ a, (np.cos(phase) * omega) @ a, -(np.sin(phase) * omega**2) @ a])


def recorded(model, rows, seed):
    """The torque of the arm on a motion, with 0.5 % of noise."""
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data = mujoco.MjData(model)
    tau = np.empty((len(rows), 2))
    for k, row in enumerate(rows):
        data.qpos[:], data.qvel[:], data.qacc[:] = np.split(row, 3)
        mujoco.mj_inverse(model, data)
        tau[k] = data.qfrc_inverse + model.dof_frictionloss * np.tanh(row[2:4] / 1e-3)
    return tau + 0.005 * tau.std(axis=0) * np.random.default_rng(seed).normal(size=tau.shape)


def test_the_model_in_the_loop_tracks_better_than_the_description(tmp_path):
    given, true = tmp_path / "given.xml", tmp_path / "true.xml"
    given.write_text(ARM.format(damping=0.2, friction=0.1, payload=""))
    true.write_text(ARM.format(damping=0.6, friction=0.3, payload=PAYLOAD))
    model = mujoco.MjModel.from_xml_path(str(true))
    mujoco.mj_saveModel(model, str(tmp_path / "plant.mjb"), None)
    t = np.arange(0, 20, 0.004)
    for name, seeds in (("train.csv", (1, 2, 3)), ("test.csv", (4,))):
        parts = []
        for k, seed in enumerate(seeds):
            rows = motion(seed, t)
            parts.append(np.column_stack([np.full(len(t), k), t + 25 * k, rows[:, :4], recorded(model, rows, seed)]))
        header = "trajectory,time,q1,q2,qd1,qd2,tau1,tau2"
        np.savetxt(tmp_path / name, np.vstack(parts), delimiter=",", header=header, comments="", fmt="%.10g")
    directory = tmp_path / "model"
    command = [f"{BIN}/train", "--robot", given, "--data", tmp_path / "train.csv", "--heldout", tmp_path / "test.csv", "--out", directory,
               "--epochs", "2"]  # fmt: skip
    subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([sys.executable, str(ROOT / "capi/install.py"), "--prefix", str(tmp_path / "prefix"), "--build", BIN], check=True)
    program = loop.compiled(tmp_path / "prefix", tmp_path)
    motions = [motion(seed, np.arange(0, 10, loop.PERIOD)) for seed in (4, 5)]
    errors, torques = loop.run(program, tmp_path / "plant.mjb", given, directory, np.zeros(2), motions, tmp_path)
    rms = {name: np.array(values)[:, 0] for name, values in errors.items()}
    assert list(rms) == ["none", "gravity", "rigid", "given", "physics", "model"]
    for better, worse, factor in (("rigid", "gravity", 1.0), ("physics", "given", 0.5), ("model", "given", 0.5)):
        assert (rms[better].mean(axis=0) < factor * rms[worse].mean(axis=0)).all(), (better, rms)
    assert loop.differs(directory, motions, torques) <= 1e-12
