"""Identification from recordings that are never in one place."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Optional, Union

from . import _residyn
from .recording import RecordingLike, paths


@dataclass(frozen=True)
class Parameter:
    """One identified parameter."""

    #: Of the rigid body that of the standard parameter that stands for it (`m3`, `Izz2`); else term and joint
    #: (`viscous elbow_joint`).
    name: str
    unit: str
    value: float
    #: Standard deviation: from leaving stretches of time out.
    std: float
    #: What the number is of: the standard parameters that form it, or the term.
    formula: str


@dataclass(frozen=True)
class Identified:
    """What an accumulator tells: base parameters, then offset, friction and rotor inertia joint by joint."""

    parameters: list[Parameter]
    joints: list[str]
    #: Deviation of each joint's residual, N·m (N).
    residual_std: list[float]
    #: Root mean square of each joint's torque, N·m (N).
    torque_rms: list[float]
    #: Parameters that the recordings tell apart; the others are held near zero.
    rank: int

    def __getitem__(self, name: str) -> Parameter:
        """The parameter of this name."""
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(name)


class Accumulator:
    """Sums over the recordings of one robot from which its parameters follow: what `train --basic` identifies, without
    having the recordings together.

        total = residyn.Accumulator("arm.urdf", cutoff_hz=8).add("monday.csv").add("tuesday.csv")
        print(total.finish()["m3"])

    Sums are triangular factors: they add up exactly, so that recordings shared out among processes and merged in any tree give
    the parameters of one process, to rounding (1e-9). Its size (some MB) does not depend on how many recordings there are.
    It can be pickled; the robot's description has to be readable where it is unpickled.

    **All workers have to prepare recordings alike.** The cut-off of the motion's low-pass is `cutoff_hz`, or is chosen from the first
    recording added, as `train` chooses it, and then kept: give every worker the same `cutoff_hz`, or add one recording first and
    give the workers `emptied()` copies. Merging sums of different preparations raises `InputError`. A delay of the torque is not
    looked for, and a low-pass of the torque counts where the drive file or the built-in robot declares it. Friction has no memory
    here: each recording stands alone. Nothing notices that a recording is added twice.
    """

    def __init__(
        self,
        robot: Union[_residyn.Robot, str, os.PathLike],
        *,
        cutoff_hz: Optional[float] = None,
    ) -> None:
        if not isinstance(robot, _residyn.Robot):
            robot = _residyn.Robot(os.fspath(robot))
        self._inner = _residyn.Sums(robot, cutoff_hz)

    @property
    def robot(self) -> _residyn.Robot:
        """The robot."""
        return self._inner.robot

    @property
    def recordings(self) -> int:
        """Number of recordings."""
        return self._inner.recordings

    @property
    def samples(self) -> int:
        """Number of samples."""
        return self._inner.samples

    @property
    def preparation(self) -> Optional[tuple[Optional[float], bool]]:
        """Cut-off of the motion in Hz (None: no low-pass) and whether recorded velocity is left aside; None before it is decided."""
        return self._inner.preparation

    def add(self, recording: RecordingLike) -> "Accumulator":
        """Adds a recording with torque; where it cannot be used that is raised and nothing changes."""
        with paths(recording=recording) as (path,):
            self._inner.add(path)
        return self

    def merge(self, other: "Accumulator") -> "Accumulator":
        """Adds the recordings behind another accumulator of this robot."""
        if other is self:
            raise _residyn.InputError("an accumulator cannot be merged with itself: its recordings would count twice")
        self._inner.merge(other._inner)
        return self

    def emptied(self) -> "Accumulator":
        """One without recordings, with the same robot and preparation: what workers start from."""
        return self._around(self._inner.emptied())

    def finish(self) -> Identified:
        """The parameters; the accumulator can be added to afterwards."""
        found: dict[str, Any] = self._inner.finish()
        parameters = [Parameter(*one) for one in found.pop("parameters")]
        return Identified(parameters=parameters, **found)

    @classmethod
    def _around(cls, inner: Any) -> "Accumulator":
        new = cls.__new__(cls)
        new._inner = inner
        return new

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self.robot, self._inner.to_bytes())

    def __repr__(self) -> str:
        return f"Accumulator({self.robot.name!r}, {self.recordings} recordings, {self.samples} samples)"


def _restored(robot: _residyn.Robot, stored: bytes) -> Accumulator:
    return Accumulator._around(_residyn.Sums.from_bytes(robot, stored))
