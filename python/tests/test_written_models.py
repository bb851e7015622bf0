"""Models that `diagnose --patch` writes, in MuJoCo: each loads, its bodies stay near the description's, and it moves as the real arm does.

`pytest -q -s` prints a row of docs/results.md for each case.
"""

import numpy as np
import pytest

mujoco = pytest.importorskip("mujoco", reason="PyPI mujoco is not installed: written models are not loaded")

from arms import CASES, waves  # noqa: E402

#: Parts of a described mass or principal inertia between which a written one lies.
NEAR = (0.3, 3.0)
#: Error under a command that was not fitted, over the given model's.
CLOSED_LOOP = 0.05
#: Standard deviations within which 90 % of a normal distribution lie.
NINETY = 1.645
FORMATS = {".xml": "MJCF", ".urdf": "URDF"}


def followed(model, n, command, stiffness, seconds=6.0):
    """Positions of the arm under position servos that follow a command; a jaw that is no joint of the chain is held by its rotor."""
    model.opt.timestep = 0.001
    model.dof_armature[n:] = 1e6
    data = mujoco.MjData(model)
    t = np.arange(int(seconds / model.opt.timestep)) * model.opt.timestep
    wanted, speed, _ = command(t)
    data.qpos[:n] = wanted[0]
    out = np.empty((len(t), n))
    for i in range(len(t)):
        data.qfrc_applied[:n] = stiffness * ((wanted[i] - data.qpos[:n]) + 0.1 * (speed[i] - data.qvel[:n]))
        mujoco.mj_step(model, data)
        out[i] = data.qpos[:n]
    return out


def stiffness(model, n):
    """Of the servos, N·m/rad (N/m): ten times the described weight, so that it bends the arm by a tenth of a radian."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return np.full(n, 10.0 * max(np.abs(data.qfrc_bias).max(), 1.0)) / 3.0 ** np.arange(n)


def size(model, link):
    """Mass and principal inertias of a link, the smallest first."""
    body = model.body(f"l{link}")
    return np.array([*body.mass, *np.sort(body.inertia)])


@pytest.mark.parametrize("arm, payload, gripper", CASES, ids=lambda v: str(v))
def test_a_written_model_loads_and_moves_as_the_real_arm(diagnosed, arm, payload, gripper):
    case = diagnosed(arm, payload, gripper)
    n, real, links = case.n, case.real, case.links
    # The file loads, its bodies are near the description's.
    given, model = case.models()
    parts = np.array([size(model, k) / size(given, k) for k in range(len(links))])
    assert (parts >= NEAR[0]).all() and (parts <= NEAR[1]).all(), parts
    # The payload is a body of its own within its interval.
    found = [p for c in case.report["causes"] if c["effect"] == "payload" for p in c["parameters"] if p["name"] == "mass"]
    assert found, [c["effect"] for c in case.report["causes"]]
    mass, std = found[0]["value"], found[0]["std"]
    unknown = f"mass not known ({mass:.4g}"
    assert ("mass not known" in case.said) == (std >= mass), (found, case.said)
    assert std < mass or unknown in case.said, (found, case.said)
    assert abs(mass - payload) <= NINETY * std, found
    assert model.body("payload").mass[0] == pytest.approx(found[0]["value"], rel=1e-9)
    # Under another command.
    command, stiff = waves(n, 7), stiffness(given, n)
    true = followed(real, n, command, stiff)
    error = [np.sqrt(((followed(m, n, command, stiff) - true) ** 2).mean()) for m in (given, model)]
    ratio = error[1] / error[0]
    print(
        f"\n| {arm}, {FORMATS[case.given.suffix]}, {n} joints, jaw {gripper} | {payload} | {found[0]['value']:.4f} ± {found[0]['std']:.4f} "
        f"| {parts.min():.2f}–{parts.max():.2f} | {1e3 * error[0]:.2f} | {1e3 * error[1]:.3f} | {ratio:.4f} |"
    )
    assert ratio <= CLOSED_LOOP, error
