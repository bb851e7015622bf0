"""The robots of a fleet and where their recordings are."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Optional, Sequence, Union

from .. import _residyn

#: Endings of recordings.
_RECORDINGS = {".csv", ".parquet", ".npz", ".mcap", ".db3"}
#: Descriptions that a robot's own folder may hold.
_DESCRIPTIONS = ("robot.urdf", "robot.xml")


@dataclass(frozen=True)
class Member:
    """One robot of a fleet."""

    #: Its own name, unlike any other's.
    name: str
    #: Built-in name, description, or both with drive file and gravity.
    robot: Union[_residyn.Robot, str, os.PathLike]
    #: Files, oldest first: the first decides on the cut-off where none is given, and with `diagnose` the last is held out.
    recordings: Sequence[Union[str, os.PathLike]]

    def loaded(self) -> _residyn.Robot:
        """The robot, whose files any process on this machine finds."""
        given = self.robot if isinstance(self.robot, _residyn.Robot) else _residyn.Robot(os.fspath(self.robot))
        source = Path(given.source)
        return _residyn.Robot(
            str(source.resolve()) if source.is_file() else given.source,
            joints=given.chosen,
            drive=None if given.drive is None else Path(given.drive).resolve(),
            gravity=given.gravity,
        )


def in_folder(
    folder: Union[str, os.PathLike],
    robot: Optional[str] = None,
    *,
    joints: Sequence[str] = (),
    drive: Union[str, os.PathLike, None] = None,
) -> list[Member]:
    """The members of a folder that holds one folder for each robot, called as the robot, with its recordings, which are taken in
    the order of their names. A `robot.urdf` or `robot.xml` beside them goes before `robot`."""
    members = []
    for own in sorted(p for p in Path(folder).iterdir() if p.is_dir()):
        recordings = sorted(p for p in own.iterdir() if p.suffix.lower() in _RECORDINGS)
        if not recordings:
            continue
        described = [own / name for name in _DESCRIPTIONS if (own / name).exists()]
        source = str(described[0]) if described else robot
        if source is None:
            raise _residyn.InputError(f"{own} holds no {' or '.join(_DESCRIPTIONS)}\nPut the description there, or name one for all robots.")
        members.append(Member(own.name, _residyn.Robot(source, joints=list(joints), drive=drive), recordings))
    if not members:
        endings = ", ".join(sorted(_RECORDINGS))
        raise _residyn.InputError(f"{folder} holds no folder with recordings\nOne folder for each robot is needed, with its {endings} files.")
    return members
