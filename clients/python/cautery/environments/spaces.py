# SPDX-License-Identifier: Apache-2.0
"""The only kind of space that the tasks need, with the interface of gymnasium.spaces.Box."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt


class Box:
    """Arrays of float32 between two bounds for each element."""

    def __init__(self, low: npt.ArrayLike, high: npt.ArrayLike) -> None:
        self.low = np.asarray(low, np.float32)
        self.high = np.asarray(high, np.float32)
        if self.low.shape != self.high.shape or not (self.low < self.high).all():
            raise ValueError("low and high must have the same shape, and low must be below high")
        self.shape = self.low.shape
        self.dtype = np.dtype(np.float32)
        self._random = np.random.default_rng()

    def seed(self, seed: int | None = None) -> None:
        """Sets the seed of the random numbers of `sample`."""
        self._random = np.random.default_rng(seed)

    def sample(self) -> npt.NDArray[np.float32]:
        """Returns a random element, uniform between the bounds."""
        return self._random.uniform(self.low, self.high).astype(np.float32)

    def contains(self, x: Any) -> bool:
        """Returns whether `x` is an array of this shape and type within the bounds."""
        return (isinstance(x, np.ndarray) and x.shape == self.shape and x.dtype == self.dtype
                and bool(((x >= self.low) & (x <= self.high)).all()))

    def __contains__(self, x: Any) -> bool:
        return self.contains(x)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Box) and np.array_equal(self.low, other.low) and np.array_equal(self.high, other.high)

    def __hash__(self) -> int:
        return hash((self.low.tobytes(), self.high.tobytes()))

    def __repr__(self) -> str:
        return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, float32)"
