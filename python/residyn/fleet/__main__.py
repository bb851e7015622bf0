"""`python -m residyn.fleet FOLDER --robot arm.urdf --out fleet`: one folder for each robot, with its recordings."""

from __future__ import annotations

import argparse
import sys

from .. import _residyn
from . import in_folder, run


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m residyn.fleet", description=__doc__)
    parser.add_argument("folder", help="holds one folder for each robot, with its recordings, oldest first by name")
    parser.add_argument("--robot", help="description of robots whose folder holds none: built-in name, URDF or MJCF")
    parser.add_argument("--joints", default="", help="joints that make the robot where an MJCF holds more, base first")
    parser.add_argument("--drive", help="drive file of all robots")
    parser.add_argument("--out", default="fleet", help="folder of tables, page, and parts to go on from [default: fleet]")
    parser.add_argument("--cutoff-hz", type=float, help="cut-off of the motion [default: by each robot's first recording]")
    parser.add_argument("--diagnose", action="store_true", help="diagnose each robot, its last recording held out")
    parser.add_argument("--fast", action="store_true", help="with --diagnose: without surrogates, as `diagnose --fast`")
    parser.add_argument("--in-flight", type=int, help="tasks on their way at once [default: two for each core]")
    parser.add_argument("--address", help="a Ray cluster that runs already [default: this machine]")
    a = parser.parse_args()
    try:
        members = in_folder(a.folder, a.robot, joints=[j for j in a.joints.split(",") if j], drive=a.drive)
        options = dict(diagnose=a.diagnose, fast=a.fast, in_flight=a.in_flight, address=a.address)
        found = run(members, a.out, cutoff_hz=a.cutoff_hz, **options)
    except (_residyn.InputError, ImportError, OSError) as error:
        first, *hint = str(error).split("\n", 1)
        print(f"error: {first}", *(f"hint: {h}" for h in hint), sep="\n", file=sys.stderr)
        return 2
    robots = found.table("robots")
    recordings = found.table("recordings")
    refused = [r for r in recordings if r["problem"]]
    print(f"{len(robots)} robots, {len(recordings)} recordings, {len(refused)} of them not usable")
    for row in found.outliers()[:10]:
        print(f"  {row['robot']}: {row['parameter']} {row['value']:.4g} {row['unit']}, {row['median']:.4g} in the median, z {row['z']:.1f}")
    for row in found.table("causes")[:10]:
        print(f"  {row['effect']} on {row['robots']} of {row['of']} robots")
    print(f"Tables and page: {found.page}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
