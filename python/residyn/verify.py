"""Whether the gap has closed in MuJoCo itself: its own inverse dynamics along the held-out motion, before and after.

    python -m residyn.verify --robot scene.xml --data monday.csv --heldout tuesday.csv --patch corrected.xml

Diagnoses, writes the corrected model, and lets MuJoCo (PyPI `mujoco`) compute the torque of both models along the held-out
motion. Beside MuJoCo's figures stand the report's, which come from this project's own dynamics.
"""

from __future__ import annotations

import argparse
import os
import sys
from dataclasses import dataclass
from typing import Optional, Sequence, Union

import numpy as np

from . import InputError, Report, Robot, diagnose

#: A joint is away from reversals where it is faster than this, rad/s (m/s): nearer, every simulator has its own idea of friction.
AWAY = 0.05


@dataclass(frozen=True)
class Row:
    """One model: mean over joints of the NRMSE away from reversals, by MuJoCo and by the report's own dynamics."""

    model: str
    mujoco: float
    report: float
    #: By joint, by MuJoCo.
    joints: tuple[float, ...]


def inverse_dynamics(
    model: Union[str, os.PathLike], joints: Sequence[str], q: np.ndarray, qd: np.ndarray, qdd: np.ndarray
) -> np.ndarray:
    """Torque of an MJCF's named joints as MuJoCo computes it, shape (samples, joints); the rest of the scene stands still
    at its reference."""
    import mujoco

    loaded = mujoco.MjModel.from_xml_path(os.fspath(model))
    # What touches in a scene without its environment is no torque of the arm's own.
    loaded.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    data = mujoco.MjData(loaded)
    found = [mujoco.mj_name2id(loaded, mujoco.mjtObj.mjOBJ_JOINT, name) for name in joints]
    missing = [name for name, i in zip(joints, found) if i < 0]
    if missing:
        raise InputError(f"{os.fspath(model)} has no joint named {', '.join(missing)}")
    positions, velocities = loaded.jnt_qposadr[found], loaded.jnt_dofadr[found]
    torque = np.empty_like(q)
    for i in range(len(q)):
        mujoco.mj_resetData(loaded, data)
        data.qpos[positions], data.qvel[velocities], data.qacc[velocities] = q[i], qd[i], qdd[i]
        mujoco.mj_inverse(loaded, data)
        torque[i] = data.qfrc_inverse[velocities]
    return torque


def nrmse(tau: np.ndarray, predicted: np.ndarray, qd: np.ndarray) -> np.ndarray:
    """Error away from reversals over the torque's standard deviation, by joint; NaN where a joint never is."""
    out = np.full(tau.shape[1], np.nan)
    for j in range(tau.shape[1]):
        away = np.abs(qd[:, j]) > AWAY
        if away.any() and tau[:, j].std() > 0:
            out[j] = np.sqrt(np.mean((tau - predicted)[away, j] ** 2)) / tau[:, j].std()
    return out


def verify(report: Report, given: Union[str, os.PathLike], patched: Union[str, os.PathLike]) -> list[Row]:
    """Both models along the report's held-out motion."""
    motion = report.motion()
    rows = []
    for name, path, own in (("as given", given, "given"), ("patched", patched, "explained")):
        torque = inverse_dynamics(path, report.joints, motion["q"], motion["qd"], motion["qdd"])
        joints = nrmse(motion["tau"], torque, motion["qd"])
        said = nrmse(motion["tau"], motion[own], motion["qd"])
        rows.append(Row(name, float(np.nanmean(joints)), float(np.nanmean(said)), tuple(joints)))
    return rows


def table(rows: Sequence[Row]) -> str:
    """The figures as text."""
    lines = [f"{'NRMSE off reversals':<22}{'MuJoCo':>10}{'report':>10}"]
    lines += [f"{row.model:<22}{row.mujoco:>10.4f}{row.report:>10.4f}" for row in rows]
    return "\n".join(lines)


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m residyn.verify", description=__doc__.splitlines()[0])
    parser.add_argument("--robot", required=True, help="MJCF")
    parser.add_argument("--joints", default="", help="joints of the arm, base first, where a scene holds more: a,b,c")
    parser.add_argument("--data", required=True, nargs="+", help="recordings that effects are fitted on")
    parser.add_argument("--heldout", required=True, help="recording that is scored")
    parser.add_argument("--patch", required=True, help="corrected model to write, beside the given one")
    parser.add_argument("--fast", action="store_true", help="skip what takes surrogates")
    given = parser.parse_args(arguments)
    try:
        robot = Robot(given.robot, joints=[j for j in given.joints.split(",") if j])
        report = diagnose(robot, given.data, given.heldout, fast=given.fast)
        print(report)
        report.patch(given.patch)
        print(table(verify(report, given.robot, given.patch)))
    except InputError as error:
        message, _, hint = str(error).partition("\n")
        print(f"error: {message}", file=sys.stderr)
        if hint:
            print(f"hint: {hint}", file=sys.stderr)
        return 2
    except ImportError as error:
        print(f"error: {error}\nhint: pip install mujoco", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
