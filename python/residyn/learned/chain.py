"""Rigid-body torque of many arms at once."""

from __future__ import annotations

from typing import Any, Sequence

import numpy as np

from .arrays import Array, Arrays


class Chain:
    """Joints of a serial arm with the links that they move, base first."""

    def __init__(self, arrays: Arrays, joints: Sequence[dict[str, Any]], gravity: Sequence[float]) -> None:
        """`joints`: as `_residyn.Model.parts` gives them. `gravity`: in the base frame, m/s²."""
        self._arrays = arrays
        self._gravity = arrays.of(gravity)
        self._joints = [_Joint(arrays, joint) for joint in joints]

    def torque(self, q: Array, qd: Array, qdd: Array) -> Array:
        """Torque, N·m (N), for positions, velocities and accelerations; all of shape (arms, joints)."""
        xp, arms = self._arrays.xp, q.shape[0]
        zero = self._arrays.zeros(arms, 3)
        turning, turning_rate, gravity = zero, zero, zero + self._gravity
        rate = -gravity
        placed = []
        for i, joint in enumerate(self._joints):
            speed, change = joint.axis * qd[:, i, None], joint.axis * qdd[:, i, None]
            rotation, origin = joint.placed(xp, q[:, i])
            inward = _transposed(xp, rotation)
            across = _cross(xp, turning_rate, origin) + _cross(xp, turning, _cross(xp, turning, origin))
            rate, gravity = _turned(inward, rate + across), _turned(inward, gravity)
            turning, turning_rate = _turned(inward, turning), _turned(inward, turning_rate)
            if joint.slides:
                rate = rate + 2.0 * _cross(xp, turning, speed) + change
            else:
                turning_rate = turning_rate + _cross(xp, turning, speed) + change
                turning = turning + speed
            # A part of the link's weight may be held from outside.
            felt = rate + joint.held * gravity
            moved = _cross(xp, turning_rate, joint.moment) + _cross(xp, turning, _cross(xp, turning, joint.moment))
            spin = _turned(joint.inertia, turning)
            twist = _cross(xp, joint.moment, felt) + _turned(joint.inertia, turning_rate) + _cross(xp, turning, spin)
            placed.append((joint, rotation, origin, joint.mass * felt + moved, twist))
        torque, force, twist = [], zero, zero
        for joint, rotation, origin, own_force, own_twist in reversed(placed):
            force, twist = force + own_force, twist + own_twist
            torque.append((joint.axis * (force if joint.slides else twist)).sum(-1))
            force, twist = _turned(rotation, force), _turned(rotation, twist)
            twist = twist + _cross(xp, origin, force)
        return xp.stack(torque[::-1], -1)


class _Joint:
    """Constants of one joint in the frame that it moves."""

    def __init__(self, arrays: Arrays, given: dict[str, Any]) -> None:
        self.slides = given["slides"]
        axis, rotation = np.array(given["axis"]), np.array(given["rotation"]).reshape(3, 3)
        mass, x, y, z, xx, xy, yy, xz, yz, zz = given["parameters"]
        self.mass, self.held = mass, given["held"]
        self.axis, self.moment = arrays.of(axis), arrays.of([x, y, z])
        self.inertia = arrays.of([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        self._rotation, self._translation = arrays.of(rotation), arrays.of(given["translation"])
        self._way = arrays.of(rotation @ axis)
        # Rodrigues' formula, the placement multiplied in.
        outer, a = np.outer(axis, axis), axis
        cross = np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
        parts = (outer, np.eye(3) - outer, cross)
        self._constant, self._cosine, self._sine = (arrays.of(rotation @ part) for part in parts)

    def placed(self, xp: Any, q: Array) -> tuple[Array, Array]:
        """Orientation and origin in the parent's frame at positions q."""
        if self.slides:
            return self._rotation, self._translation + self._way * q[:, None]
        q = q[:, None, None]
        return self._constant + self._cosine * xp.cos(q) + self._sine * xp.sin(q), self._translation


def _transposed(xp: Any, matrix: Array) -> Array:
    return xp.swapaxes(matrix, -1, -2)


def _turned(matrix: Array, vector: Array) -> Array:
    return (matrix @ vector[..., None])[..., 0]


def _cross(xp: Any, a: Array, b: Array) -> Array:
    x, y, z = (a[..., i] for i in range(3))
    u, v, w = (b[..., i] for i in range(3))
    return xp.stack([y * w - z * v, z * u - x * w, x * v - y * u], -1)
