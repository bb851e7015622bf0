"""The compensator of a model directory over many arms."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Optional, Sequence, Union

import numpy as np

from .. import InputError, _residyn
from .arrays import Array, Arrays
from .chain import Chain
from .terms import column
from .unit import Unit


class Learned:
    """Torque that a compensator adds to the identified physics, for many arms at once, one sample after the other.

    Weights, friction states, windows and fade are those of the model in a control loop; states and rigid-body torque are computed in
    double precision, networks in single precision. Each arm has a memory of its own.

        learned = Learned("model", arms=4096, period=0.005, device="cuda:0")
        torque = learned.torque(q, qd)      # (arms, joints), rad and rad/s in, N·m out
        learned.reset(done)                 # arms that start anew
    """

    def __init__(
        self,
        directory: Union[str, os.PathLike],
        arms: int,
        *,
        period: Optional[float] = None,
        device: Optional[Any] = None,
    ) -> None:
        """`directory`: of a trained model. `period`: time between two samples, s (default: that of training). `device`: of torch, such as
        "cuda:0" or "cpu"; None: NumPy."""
        parts = json.loads(_residyn.Model(Path(directory), period=period).parts())
        if parts["inputs"] is None:
            raise InputError(f"{os.fspath(directory)} has no compensator: its physics are all that it knows")
        self._arrays = Arrays(device)
        #: Joint names, base first: the order of all columns.
        self.joints: list[str] = [joint["name"] for joint in parts["chain"]]
        #: Number of arms.
        self.arms = arms
        #: Time between two samples, s.
        self.period: float = parts["period"]
        header, tensors = _read(Path(directory) / "compensator.safetensors")
        self._units = [
            Unit(self._arrays, unit, {name[len(f"units.{i}.") :]: t for name, t in tensors.items() if name.startswith(f"units.{i}.")})
            for i, unit in enumerate(header["units"])
            if unit["enabled"]
        ]
        self._chain = Chain(self._arrays, parts["chain"], parts["gravity"])
        self._inputs = [_input(given) for given in parts["inputs"]]
        n, turns = len(self.joints), parts["turns"]
        zeros = self._arrays.zeros
        self._states = [zeros(arms) if remembers else None for *_, remembers in self._inputs]
        self._last_q, self._last_qd = zeros(arms, n), zeros(arms, n)
        self._moved = zeros(arms) > 0
        # One memory for each sample within the period of training, taking turns.
        self._memory = [[unit.start(arms) for unit in self._units] for _ in range(turns)]
        self._begun = [zeros(arms) > 0 for _ in range(turns)]
        self._turn = 0
        #: How far outside its training each joint of each arm was at the last sample, in parts of the training range: below zero inside,
        #: from where the unit's fade ends its torque is zero; minus infinity for a joint without a unit. Shape (arms, joints).
        self.excess: Array = zeros(arms, n) - np.inf

    def reset(self, arms: Optional[Any] = None) -> None:
        """Forgets the motion of these arms: indices or a mask, None for all."""
        mask = self._arrays.zeros(self.arms) > 0
        mask[slice(None) if arms is None else arms] = True
        self._moved = self._moved & ~mask
        self._begun = [begun & ~mask for begun in self._begun]

    def torque(self, q: Array, qd: Array, qdd: Optional[Array] = None) -> Array:
        """Torque of the compensator at the next sample, N·m (N), shape (arms, joints), for positions and velocities of the same shape, and
        in the type of the positions.

        `qdd`: accelerations (default: by difference of the velocities, zero at the first sample of an arm). An arm with a value that is not
        finite gets zero, and its memory stays as it was.
        """
        with self._arrays.untracked():
            return self._arrays.like(self._torque(q, qd, qdd), q)

    def _torque(self, q: Array, qd: Array, qdd: Optional[Array]) -> Array:
        xp, of = self._arrays.xp, self._arrays.of
        q, qd = of(q), of(qd)
        shape = (self.arms, len(self.joints))
        given = [q, qd] if qdd is None else [q, qd, of(qdd)]
        if any(tuple(x.shape) != shape for x in given):
            raise InputError(f"q, qd and qdd need the shape {shape}: arms and joints")
        live = (xp.isfinite(sum(given))).all(-1)
        every = live[:, None]
        q, qd = xp.where(every, q, self._last_q), xp.where(every, qd, self._last_qd)
        moved = self._moved[:, None]
        if qdd is None:
            qdd = xp.where(moved, (qd - self._last_qd) / self.period, 0.0 * qd)
        else:
            qdd = xp.where(every, given[2], 0.0 * qd)
        columns = self._columns(q, qd, qdd, live)
        self._last_q, self._last_qd = q, qd
        self._moved = self._moved | live
        torque = self._sum(columns, live)
        self._turn = (self._turn + 1) % len(self._memory)
        return torque

    def _columns(self, q: Array, qd: Array, qdd: Array, live: Array) -> Array:
        """Inputs of the units, shape (arms, inputs)."""
        xp = self._arrays.xp
        dq = xp.where(self._moved[:, None], q - self._last_q, 0.0 * q)
        dt = xp.where(self._moved, self.period + 0.0 * q[:, 0], 0.0 * q[:, 0])
        load = xp.abs(self._chain.torque(q, qd, qdd)) if any(kind == "load" for _, kind, *_ in self._inputs) else None
        signals = {"position": q, "velocity": qd, "acceleration": qdd, "load": load}
        columns = []
        for i, (joint, kind, value, remembers) in enumerate(self._inputs):
            if value is None:
                columns.append(signals[kind][:, joint])
                continue
            before = xp.where(self._moved, self._states[i], 0.0 * dt) if remembers else None
            now = value(xp, before, dq[:, joint], q[:, joint], qd[:, joint], dt)
            if remembers:
                self._states[i] = xp.where(live, now, before)
            columns.append(now)
        return self._arrays.cast(xp.stack(columns, -1), "float32")

    def _sum(self, columns: Array, live: Array) -> Array:
        """Torque of all units by joint."""
        xp, begun, memory = self._arrays.xp, self._begun[self._turn], self._memory[self._turn]
        torque: list[list[Array]] = [[] for _ in self.joints]
        excess: list[list[Array]] = [[] for _ in self.joints]
        for i, unit in enumerate(self._units):
            before = [xp.where(_wide(begun, value), value, 0.0 * value) for value in memory[i]]
            own, beyond, after = unit.step(columns, before, begun)
            memory[i] = [xp.where(_wide(live, new), new, old) for new, old in zip(after, before)]
            torque[unit.joint].append(self._arrays.cast(own, "float64"))
            excess[unit.joint].append(self._arrays.cast(beyond, "float64"))
        self._begun[self._turn] = begun | live
        nothing = self._arrays.zeros(self.arms)
        summed = xp.stack([sum(parts, nothing) for parts in torque], -1)
        worst = [nothing - np.inf if not parts else xp.amax(xp.stack(parts, -1), -1) for parts in excess]
        self.excess = xp.where(live[:, None], xp.stack(worst, -1), np.inf)
        return xp.where(live[:, None], summed, 0.0 * summed)


def _wide(mask: Array, value: Array) -> Array:
    """A mask of arms with the axes of `value`."""
    return mask.reshape(-1, *[1] * (len(value.shape) - 1))


def _input(given: dict[str, Any]) -> tuple[int, str, Any, bool]:
    """Joint, kind of the signal and, of a term, its function and whether it remembers."""
    signal = given["signal"]
    if isinstance(signal, str):
        return given["joint"], signal, None, False
    return (given["joint"], "term", *column(signal["term"]))


def _read(path: Path) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Header and tensors of a compensator's file. The model's control loop has checked it."""
    content = path.read_bytes()
    length = int.from_bytes(content[:8], "little")
    entries = json.loads(content[8 : 8 + length])
    header = json.loads(json.loads(entries.pop("__metadata__")["residyn"])["header"])
    data, tensors = content[8 + length :], {}
    for name, entry in entries.items():
        start, end = entry["data_offsets"]
        tensors[name] = np.frombuffer(data[start:end], "<f4").reshape(entry["shape"])
    return header, tensors
