"""Many robots on many machines: identification, and where asked for diagnosis, of a fleet, on Ray.

    from residyn import fleet

    members = [fleet.Member("cell-1", "arm.urdf", ["cell-1/monday.parquet", "cell-1/tuesday.parquet"]), …]
    found = fleet.run(members, "fleet")
    print(found.outliers())

or `python -m residyn.fleet FOLDER --robot arm.urdf --out fleet`. Each recording is a task, which adds it to an accumulator of its own
([`residyn.Accumulator`]); a tree of merges follows for each robot. What a task makes is stored under a digest of what it was
made from: after an interruption the same call goes on, and a task whose machine died is run again elsewhere. Needs the PyPI
packages `ray` and `pyarrow`; the recordings, the robots' descriptions and the output folder have to be at the same paths on every machine.
"""

from .members import Member, in_folder
from .run import Fleet, run

__all__ = ["Fleet", "Member", "in_folder", "run"]
