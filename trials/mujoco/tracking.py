"""How well arms in MuJoCo are tracked with the model in the loop: python trials/mujoco/tracking.py --seed 1 --out DIR

The robots and recordings are those of `cases.py`: a description, a plant that differs from it by a few per cent, and one withheld effect.
`train` learns from the recording. `capi/examples/track.cpp`, compiled against libresidyn and libmujoco, then follows three held-out motions
under PD control with each feedforward in turn; gains are 5 Hz and damping 1 with the description's mass matrix at mid-range, the same in all
rows. Where the package `residyn` is installed, its torques are compared with those of the C++ loop.

Prints RMS tracking errors over that with the description's rigid body, the mean over joints and motions; writes tracking.json and
tracking.svg. Needs mujoco, numpy, pyarrow, a C++ compiler, the program `train` and an installed prefix of `capi/install.py`.
"""
import argparse
import json
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pyarrow.parquet

import effects
import loop
from arm import LENGTH, nominal_spec
from cases import HELD_OUT, session
from outside import CableTug

MOTIONS = HELD_OUT[:3]
KINDS = {
    "none": None,
    "friction": effects.FrictionParameters,
    "payload": effects.Payload,
    "elasticity": effects.JointElasticity,
    "cable": CableTug,
}
ROWS = {
    "none": "PD alone",
    "gravity": "PD + gravity as described",
    "rigid": "PD + rigid body as described",
    "given": "PD + rigid body and friction as described",
    "physics": "PD + identified physics",
    "model": "PD + physics and compensator",
}


def plant(case):
    """The robot with its effect, as it was simulated."""
    spec = nominal_spec(case.arm.robot)
    case.effect.build(spec, case.arm, case.size)
    return case.arm.true(spec, case.effect.step)


def track(kind, seed, index, out, program, train):
    """Errors by feedforward: lists of motions x joints, RMS and largest; and how far Python's torque is from that of the loop."""
    case = session(KINDS[kind], seed, index)
    folder = out / f"{kind}-{index}"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "robot.xml").write_text(case.arm.xml)
    files = case.recordings()[0]
    for name, table in files.items():
        pyarrow.parquet.write_table(table, folder / name)
    mujoco.mj_saveModel(plant(case), str(folder / "plant.mjb"), None)
    model = folder / "model"
    if not (model / "model.json").is_file():
        command = [train, "--robot", folder / "robot.xml", "--data", folder / "train.parquet", "--heldout", folder / "test.parquet",
                   "--out", model, "--seed", str(seed)]  # fmt: skip
        with open(folder / "train.txt", "w") as log:
            subprocess.run([str(part) for part in command], check=True, stdout=log, stderr=log)
    t = np.arange(0, LENGTH, loop.PERIOD)
    motions = [np.hstack(case.motions[i].at(t)) for i in MOTIONS]
    errors, torques = loop.run(program, folder / "plant.mjb", folder / "robot.xml", model, case.arm.middle, motions, folder)
    return {"kind": kind, "index": index, "robot": case.arm.robot, "joints": case.arm.n, "size": case.size, "errors": errors,
            "python": loop.differs(model, motions, torques)}  # fmt: skip


def ratio(case, row, base="rigid", which=0):
    """Mean over motions and joints of an error over that with another feedforward. `which`: 0 RMS, 1 the largest."""
    own, other = (np.array(case["errors"][name])[:, which] for name in (row, base))
    return float((own / other).mean())


def picture(table):
    """Bars of the table, an SVG."""
    colours = ("#999999", "#bbbbbb", "#4477aa", "#66ccee", "#ccbb44", "#228833")
    width, height, top = 760, 60 + 120 * len(table), max(max(row.values()) for row in table.values())
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">',
           '<text x="10" y="20">RMS tracking error over that with the rigid body as described</text>']  # fmt: skip
    for k, (kind, row) in enumerate(table.items()):
        y = 45 + 120 * k
        out.append(f'<text x="10" y="{y}" font-weight="bold">{kind}</text>')
        for i, (name, value) in enumerate(row.items()):
            length = 400 * value / top
            at = y + 10 + 16 * i
            out.append(f'<text x="10" y="{at + 10}">{ROWS[name]}</text><rect x="280" y="{at}" width="{length:.1f}" height="13" '
                       f'fill="{colours[i]}"/><text x="{285 + length:.1f}" y="{at + 10}">{value:.2f}</text>')  # fmt: skip
    return "\n".join([*out, "</svg>\n"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--cases", type=int, default=2, help="of each kind")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--out", type=Path, required=True, help="folder for the cases, the program and the results")
    parser.add_argument("--prefix", type=Path, required=True, help="where capi/install.py has put libresidyn")
    parser.add_argument("--train", type=Path, default=loop.ROOT / "target/release/train", help="the program")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    program = loop.compiled(options.prefix.resolve(), options.out)
    results, table = [], {}
    for kind in options.kinds:
        own = [track(kind, options.seed, index, options.out, program, options.train) for index in range(options.cases)]
        results += own
        table[kind] = {row: float(np.mean([ratio(case, row) for case in own])) for row in ROWS}
        print(f"{kind:12}" + "".join(f"  {row} {value:.3f}" for row, value in table[kind].items()), flush=True)
    (options.out / "tracking.json").write_text(json.dumps({"seed": options.seed, "cases": results, "ratios": table}, indent=1) + "\n")
    (options.out / "tracking.svg").write_text(picture(table))
    compared = [case["python"] for case in results if case["python"] is not None]
    if compared:
        print(f"Python's torque differs by at most {max(compared):.1e} of the largest torque")
    return 0


if __name__ == "__main__":
    sys.exit(main())
