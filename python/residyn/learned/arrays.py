"""The few array functions that NumPy and torch share under one name, and how arrays of either are made."""

from __future__ import annotations

import contextlib
from typing import Any, Optional

import numpy as np

#: An array of NumPy or a tensor of torch.
Array = Any


class Arrays:
    """Makes arrays on a device, of torch, or of NumPy where there is none."""

    def __init__(self, device: Optional[Any]) -> None:
        """`device`: of torch, such as "cuda:0" or "cpu"; None for NumPy."""
        self.device = device
        if device is None:
            #: Module with the functions.
            self.xp: Any = np
        else:
            import torch

            self.xp = torch

    def of(self, values: Any, dtype: str = "float64") -> Array:
        """The values as an array of this kind."""
        if self.device is None:
            return np.asarray(values, dtype)
        if not self.xp.is_tensor(values):
            # A copy: torch warns of arrays that cannot be written, such as a file's.
            values = np.array(values)
        return self.xp.as_tensor(values, dtype=getattr(self.xp, dtype), device=self.device)

    def zeros(self, *shape: int, dtype: str = "float64") -> Array:
        """Zeros."""
        return self.of(np.zeros(shape), dtype)

    def cast(self, values: Array, dtype: str) -> Array:
        """An array of this kind in another type."""
        return values.astype(dtype) if self.device is None else values.to(getattr(self.xp, dtype))

    def like(self, values: Array, other: Any) -> Array:
        """An array of this kind in the type of another one."""
        if self.device is None:
            return values.astype(np.result_type(np.asarray(other).dtype, np.float32))
        return values.to(other.dtype) if self.xp.is_tensor(other) and other.is_floating_point() else values

    def untracked(self) -> Any:
        """Context in which torch records no gradients."""
        return contextlib.nullcontext() if self.device is None else self.xp.no_grad()
