"""Friction states and other columns that a compensator sees beside the motion, for many arms at once."""

from __future__ import annotations

import math
from typing import Any, Callable, Union

from .. import InputError
from .arrays import Array

#: Value from memory, displacement, position and velocity of the joint, and time since the last sample, rad (m), s, and the memory.
Column = Callable[[Any, Array, Array, Array, Array, Array], Array]


def column(term: Union[str, dict[str, Any]]) -> tuple[Column, bool]:
    """Function that computes a term's column, and whether it remembers: its value is then the memory of the next sample."""
    kind, shape = (term, None) if isinstance(term, str) else next(iter(term.items()))
    if kind == "sliding":
        return _sliding(shape), False
    if kind == "stop":
        width = shape["width"]
        return lambda xp, z, dq, q, qd, dt: xp.clip(z + dq / width, -1.0, 1.0), True
    if kind == "dahl":
        stiffness = shape["stiffness"]
        return lambda xp, z, dq, q, qd, dt: _approach(xp, z, xp.sign(dq), -stiffness * xp.abs(dq)), True
    if kind == "lagged_sign":
        time, still = shape["time_constant"], shape["standstill"]

        def lagged(xp: Any, z: Array, dq: Array, q: Array, qd: Array, dt: Array) -> Array:
            return xp.where(xp.abs(qd) <= still, z, _approach(xp, z, xp.sign(qd), -dt / time))

        return lagged, True
    if kind == "harmonic":
        order, late = shape["order"], 0.5 * math.pi if shape["phase"] == "cos" else 0.0
        if late:
            return lambda xp, z, dq, q, qd, dt: xp.cos(order * q), False
        return lambda xp, z, dq, q, qd, dt: xp.sin(order * q), False
    raise InputError(f"the compensator sees a column of the kind {kind!r}, which is computed in the model's control loop alone")


def _approach(xp: Any, z: Array, end: Array, exponent: Array) -> Array:
    return end + (z - end) * xp.exp(exponent)


def _sliding(shape: Union[str, dict[str, Any]]) -> Column:
    kind, by = (shape, {}) if isinstance(shape, str) else next(iter(shape.items()))
    velocity = by.get("velocity")
    if kind == "viscous":
        return lambda xp, z, dq, q, qd, dt: qd
    if kind == "coulomb":
        return lambda xp, z, dq, q, qd, dt: xp.sign(qd)
    if kind == "stribeck":
        return lambda xp, z, dq, q, qd, dt: xp.sign(qd) * xp.exp(-xp.abs(qd) / velocity)
    if kind in ("soft_coulomb", "degressive"):
        return lambda xp, z, dq, q, qd, dt: xp.tanh(qd / velocity)
    raise InputError(f"the compensator sees friction of the kind {kind!r}, which is computed in the model's control loop alone")
