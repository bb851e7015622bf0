"""One trained unit: its networks, its window or carried state, its bounds, for many arms at once."""

from __future__ import annotations

from typing import Any, Optional

import numpy as np

from .arrays import Array, Arrays


class Unit:
    """Torque of one joint from the columns that its unit sees. docs/compensator-format.md has the formulas."""

    def __init__(self, arrays: Arrays, header: dict[str, Any], tensors: dict[str, np.ndarray]) -> None:
        """`header`: the unit in the file's header. `tensors`: those of the unit, by name within it."""
        self._arrays, self._xp = arrays, arrays.xp
        self.joint, self.columns = header["joint"], header["columns"]

        def single(values: np.ndarray) -> Array:
            return arrays.of(values, "float32")

        offset, span = tensors["input"]
        low, high, mean = tensors["range"]
        self._offset = single(offset)
        self._inverse = single(np.where(span > 0, 1.0 / np.where(span > 0, span, 1.0), 0.0))
        self._target = [float(x) for x in tensors["target"][:, 0]]
        self._fade = (header["fade"]["start"], header["fade"]["end"])
        slack = self._fade[1] * (high - low)
        self._held = (single(low - slack), single(high + slack))
        self._low, self._high, self._mean = single(low), single(high), single(mean)
        self._widths = single(np.where(high > low, high - low, np.inf))
        whitener = np.linalg.inv(tensors["covariance_factor"].astype(np.float64)).T
        self._whitener = single(whitener / header["radius"])
        self._limit = header["limit"]
        (kind, shape), *_ = header["architecture"].items()
        members = [
            {name.split(".", 2)[2]: value for name, value in tensors.items() if name.startswith(f"members.{m}.")}
            for m in range(header["members"])
        ]
        stacked = {name: single(np.stack([m[name] for m in members])) for name in members[0]}
        self._network = (Perceptron if kind == "perceptron" else Recurrent)(arrays, shape, stacked)

    def start(self, arms: int) -> list[Array]:
        """Memory before the first sample."""
        return [self._arrays.zeros(arms, *shape, dtype="float32") for shape in self._network.memory(len(self.columns))]

    def step(self, columns: Array, memory: list[Array], begun: Array) -> tuple[Array, Array, list[Array]]:
        """Torque, N·m (N), how far outside its training each arm is, and the memory after the sample.

        `columns`: of the compensator, shape (arms, columns). `begun`: arms that have seen a sample before.
        """
        xp = self._xp
        scaled = (columns[:, self.columns] - self._offset) * self._inverse
        held = xp.minimum(xp.maximum(scaled, self._held[0]), self._held[1])
        output, memory = self._network.step(held, memory, begun)
        offset, span = self._target
        torque = output * span + offset
        beyond = xp.maximum(scaled - self._high, self._low - scaled) / self._widths
        distance = xp.sqrt((((scaled - self._mean) @ self._whitener) ** 2).sum(-1)) - 1.0
        weight = self._weight(beyond).prod(-1) * self._weight(distance)
        beyond = xp.where(self._high > self._low, beyond, distance[:, None])
        excess = xp.maximum(xp.amax(beyond, -1), distance)
        return weight * self._bent(torque), excess, memory

    def _weight(self, excess: Array) -> Array:
        start, end = self._fade
        s = self._xp.clip((excess - start) / (end - start), 0.0, 1.0)
        return self._xp.clip(1.0 - s * s * s * (s * (s * 6.0 - 15.0) + 10.0), 0.0, 1.0)

    def _bent(self, torque: Array) -> Array:
        xp, knee = self._xp, 0.9 * self._limit
        room = self._limit - knee
        if room <= 0.0:
            return torque * 0.0
        above = xp.clip(xp.abs(torque) - knee, 0.0, None)
        return xp.where(above > 0.0, xp.sign(torque) * (knee + room * xp.tanh(above / room)), torque)


class Perceptron:
    """Layers over a window; members lie along the first axis of the weights."""

    def __init__(self, arrays: Arrays, shape: dict[str, Any], weights: dict[str, Array]) -> None:
        self._xp, self._weights, self._hidden = arrays.xp, weights, len(shape["hidden"])
        self._samples = shape["timestep"]

    def memory(self, columns: int) -> list[tuple[int, ...]]:
        """Shapes of what is remembered of each arm."""
        return [(self._samples - 1, columns)]

    def step(self, sample: Array, memory: list[Array], begun: Array) -> tuple[Array, list[Array]]:
        """Output, mean over members, and the memory after the sample."""
        window = _window(self._xp, sample, memory[0], begun)
        y = window.reshape(len(sample), -1)
        for layer in range(self._hidden + 1):
            y = y @ self._weights[f"layer{layer}.weight"] + self._weights[f"layer{layer}.bias"]
            y = self._xp.tanh(y) if layer < self._hidden else y
        return y[..., 0].mean(0), [window[:, 1:]]


class Recurrent:
    """LSTM encoder, attention, LSTM re-encoder and output; members lie along the first axis of the weights."""

    def __init__(self, arrays: Arrays, shape: dict[str, Any], weights: dict[str, Array]) -> None:
        self._xp, self._weights = arrays.xp, weights
        self._n, self._m, self._attention = shape["encoder"], shape["reencoder"], shape["attention"]
        memory = shape["memory"]
        self._samples = memory.get("timestep")
        self._earlier = memory.get("attended", 1) - 1 if self._attention is not None else 0
        self._members = weights["encoder.bias"].shape[0]

    def memory(self, columns: int) -> list[tuple[int, ...]]:
        """Shapes of what is remembered of each arm."""
        if self._samples is not None:
            return [(self._samples - 1, columns)]
        n, m, members = self._n, self._m, self._members
        return [(members, n), (members, n), (members, m), (members, m), (members, self._earlier, n), (self._earlier,)]

    def step(self, sample: Array, memory: list[Array], begun: Array) -> tuple[Array, list[Array]]:
        """Output, mean over members, and the memory after the sample."""
        if self._samples is None:
            return self._carry(sample, memory)
        window = _window(self._xp, sample, memory[0], begun)
        states, state = [], None
        for t in range(self._samples):
            state = self._lstm("encoder", [window[:, t]], state)
            states.append(state[0])
        keys = [self._key(state) for state in states]
        last = None
        for state in states:
            last = self._reencode(state, states, keys, None, last)
        return self._output(last[0]), [window[:, 1:]]

    def _carry(self, sample: Array, memory: list[Array]) -> tuple[Array, list[Array]]:
        xp = self._xp
        # Arms come first in memory, members in the networks.
        h, c, s, d, past = (xp.swapaxes(value, 0, 1) for value in memory[:5])
        seen = memory[5]
        state = self._lstm("encoder", [sample], (h, c))
        states = [state[0], *(past[:, :, k] for k in range(self._earlier))]
        mask = xp.concatenate([xp.ones_like(sample[:, :1]), seen], -1)
        last = self._reencode(state[0], states, [self._key(value) for value in states], mask, (s, d))
        kept = xp.stack(states[: self._earlier], 2) if self._earlier else past
        tensors = [xp.swapaxes(value, 0, 1) for value in (*state, *last, kept)]
        return self._output(last[0]), [*tensors, mask[:, : self._earlier]]

    def _lstm(self, layer: str, inputs: list[Array], state: Optional[tuple[Array, Array]]) -> tuple[Array, Array]:
        weight, start = self._weights[f"{layer}.weight"], 0
        gates = self._weights[f"{layer}.bias"]
        for x in inputs if state is None else [*inputs, state[0]]:
            gates = gates + x @ weight[:, start : start + x.shape[-1]]
            start += x.shape[-1]
        n = gates.shape[-1] // 4
        i, f, g, o = (gates[..., k * n : (k + 1) * n] for k in range(4))
        c = self._sigmoid(i) * self._xp.tanh(g)
        if state is not None:
            c = c + self._sigmoid(f) * state[1]
        return self._sigmoid(o) * self._xp.tanh(c), c

    def _sigmoid(self, x: Array) -> Array:
        # No exponential overflows.
        return 0.5 * (self._xp.tanh(0.5 * x) + 1.0)

    def _key(self, state: Array) -> Optional[Array]:
        if self._attention is None:
            return None
        return state @ self._weights["attention.key"] + self._weights["attention.bias"]

    def _reencode(
        self,
        newest: Array,
        states: list[Array],
        keys: list[Array],
        mask: Optional[Array],
        before: Optional[tuple[Array, Array]],
    ) -> tuple[Array, Array]:
        """State after the newest encoder state, with the context of `states` where `mask` is not zero."""
        if self._attention is None:
            return self._lstm("reencoder", [newest], before)
        xp, weights = self._xp, self._weights
        asked = 0.0 if before is None else before[0] @ weights["attention.query"]
        scores = xp.stack([(xp.tanh(key + asked) * weights["attention.score"]).sum(-1) for key in keys], -1)
        shares = xp.exp(scores - xp.amax(scores, -1)[..., None])
        if mask is not None:
            shares = shares * mask
        shares = shares / shares.sum(-1)[..., None]
        context = sum(shares[..., k, None] * state for k, state in enumerate(states))
        return self._lstm("reencoder", [newest, context], before)

    def _output(self, state: Array) -> Array:
        y = state @ self._weights["output.weight"] + self._weights["output.bias"]
        return y[..., 0].mean(0)


def _window(xp: Any, sample: Array, before: Array, begun: Array) -> Array:
    """Samples of each arm, oldest first; before the start of a motion its first sample repeats."""
    before = xp.where(begun[:, None, None], before, sample[:, None])
    return xp.concatenate([before, sample[:, None]], 1)
