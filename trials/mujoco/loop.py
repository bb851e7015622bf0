"""The loop of `capi/examples/track.cpp`: compiled, run on motions, and its torques beside those of the Python package."""
import subprocess
from pathlib import Path

import mujoco
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
PERIOD = 1e-3  # of the loop, s
SETTLE = 1.0  # at the first row of a motion before it begins, s


def compiled(prefix, out):
    """The program of the loop, linked with both libraries by their full names."""
    package = Path(mujoco.__file__).parent
    library = next(package.glob("libmujoco.so.*"))
    program = out / "track"
    command = ["c++", "-std=c++17", "-O2", "-Wall", "-Wextra", ROOT / "capi/examples/track.cpp", f"-I{package / 'include'}",
               f"-I{prefix / 'include'}", library, f"-L{prefix / 'lib'}", "-lresidyn", f"-Wl,-rpath,{package}:{prefix / 'lib'}",
               "-o", program]  # fmt: skip
    subprocess.run([str(part) for part in command], check=True)
    return program


def text(middle, motions):
    """What the program reads: mid-range, and rows of q, qd, qdd."""
    lines = [str(len(middle)), " ".join(map(repr, middle.tolist())), str(len(motions))]
    for rows in motions:
        lines.append(str(len(rows)))
        lines += [" ".join(map(repr, row)) for row in rows.tolist()]
    return "\n".join(lines) + "\n"


def run(program, plant, given, model, middle, motions, folder):
    """Errors by feedforward, arrays of motions x (RMS, largest) x joints as lists; and the model's torques, a row for each period.

    `motions`: arrays of rows x (q, qd, qdd), 1 ms apart.
    """
    (folder / "reference.txt").write_text(text(middle, motions))
    command = [program, plant, given, model, folder / "reference.txt", folder / "torques.txt"]
    printed = subprocess.run([str(part) for part in command], check=True, stdout=subprocess.PIPE, text=True).stdout
    errors = {}
    for line in printed.splitlines():
        name, _, *values = line.split()
        errors.setdefault(name, []).append(np.array(values, dtype=float).reshape(-1, 2).T.tolist())
    return errors, np.loadtxt(folder / "torques.txt").reshape(-1, len(middle))


def differs(model, motions, torques):
    """Largest difference of the Python package's torque from the loop's, over the largest torque; None without the package."""
    try:
        import residyn
    except ImportError:
        return None
    loaded = residyn.Model(model, period=PERIOD)
    n = torques.shape[1]
    expected = iter(torques)
    worst = 0.0
    for motion in motions:
        loaded.reset()
        rest = np.zeros((round(SETTLE / PERIOD), 3 * n))
        rest[:, :n] = motion[0, :n]
        for row in np.vstack([rest, motion]):
            worst = max(worst, abs(loaded.torque(*np.split(row, 3)) - next(expected)).max())
    return worst / abs(torques).max()
