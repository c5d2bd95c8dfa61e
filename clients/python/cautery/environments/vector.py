# SPDX-License-Identifier: Apache-2.0
"""Several environments as one, with the interface of Gymnasium's VectorEnv."""

from __future__ import annotations

import enum
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, Callable, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from ..errors import Error
from .spaces import Box

Infos = dict[str, Any]
_Result = tuple[npt.NDArray[np.float32], float, bool, bool, Mapping[str, Any]]


class AutoresetMode(enum.Enum):
    """When an environment begins its next episode, with the values of gymnasium.vector.AutoresetMode."""

    NEXT_STEP = "NextStep"
    SAME_STEP = "SameStep"
    DISABLED = "Disabled"


def _batch(space: Box, count: int) -> Box:
    return Box(np.repeat(space.low[None], count, axis=0), np.repeat(space.high[None], count, axis=0))


def _seeds(seed: int | Sequence[int | None] | None, count: int) -> list[int | None]:
    if seed is None:
        return [None] * count
    if isinstance(seed, (int, np.integer)):
        return [int(seed) + i for i in range(count)]
    if len(seed) != count:
        raise ValueError(f"{len(seed)} seeds for {count} environments")
    return list(seed)


def _together(infos: Sequence[Mapping[str, Any]]) -> Infos:
    """Joins infos: each member becomes an array over the environments. The member "_" + name marks those that have it."""
    made: Infos = {}
    for i, info in enumerate(infos):
        for name, value in info.items():
            if name not in made:
                kind = np.asarray(value)
                plain = kind.dtype.kind in "biuf"
                made[name] = np.zeros((len(infos), *(kind.shape if plain else ())), kind.dtype if plain else object)
                made["_" + name] = np.zeros(len(infos), bool)
            made[name][i], made["_" + name][i] = value, True
    return made


class VectorEnvironment:
    """Gymnasium's VectorEnv: `reset` and `step` act on all environments and return arrays, (N, ...).

    `makers` has a function for each environment that creates it. The environments must have equal spaces. `threads` is the
    number of threads that step environments; results do not depend on it. Several threads help if steps release Python's
    lock, as steps of cautery_core do.

    The mode of autoreset is NEXT_STEP: in the step after an environment has ended, its action is ignored and it is reset.
    That step returns the first observation of the next episode, reward 0, and no end of the episode.

    A seed s gives environment i the seed s + i; a list has a seed for each environment. If an environment raises, the other
    environments first finish their step. After an error, call `reset`.
    """

    render_mode = None
    spec = None

    def __init__(self, makers: Sequence[Callable[[], Any]], threads: int = 1) -> None:
        if not makers or threads < 1:
            raise ValueError("a vector needs at least one environment and one thread")
        self.environments: list[Any] = []
        self._pool = ThreadPoolExecutor(threads, "cautery vector") if threads > 1 else None
        self.closed = False
        try:
            for maker in makers:
                self.environments.append(maker())
            self._take_spaces()
        except BaseException:
            self.close()
            raise
        self._ended: npt.NDArray[np.bool_] | None = None  # None: call reset first

    def _take_spaces(self) -> None:
        first = self.environments[0]
        self.num_envs = len(self.environments)
        self.single_action_space, self.single_observation_space = first.action_space, first.observation_space
        for other in self.environments:
            if (other.action_space, other.observation_space) != (first.action_space, first.observation_space):
                raise ValueError("the environments have different spaces")
        self.action_space = _batch(first.action_space, self.num_envs)
        self.observation_space = _batch(first.observation_space, self.num_envs)
        self.metadata: Mapping[str, Any] = {**first.metadata, "autoreset_mode": AutoresetMode.NEXT_STEP}

    @property
    def unwrapped(self) -> VectorEnvironment:
        """This vector of environments."""
        return self

    def __enter__(self) -> VectorEnvironment:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes all environments. A second call does nothing."""
        if self.closed:
            return
        self.closed = True
        if self._pool:
            self._pool.shutdown()
        for environment in self.environments:
            environment.close()

    def render(self) -> tuple[Any, ...]:
        """Returns the picture of each environment."""
        return tuple(environment.render() for environment in self.environments)

    # ---- episodes
    def reset(self, *, seed: int | Sequence[int | None] | None = None, options: Mapping[str, Any] | None = None,
              ) -> tuple[npt.NDArray[np.float32], Infos]:
        """Begins an episode in all environments."""
        seeds = _seeds(seed, self.num_envs)
        self._ended = None
        results = self._on_all(lambda i: self.environments[i].reset(seed=seeds[i], options=options))
        self._ended = np.zeros(self.num_envs, bool)
        return np.stack([observation for observation, _ in results]), _together([info for _, info in results])

    def step(self, actions: npt.ArrayLike) -> tuple[
            npt.NDArray[np.float32], npt.NDArray[np.float64], npt.NDArray[np.bool_], npt.NDArray[np.bool_], Infos]:
        """Steps all environments. Returns observations, rewards, terminations, truncations and infos."""
        if self._ended is None:
            raise Error("no episode has begun, or an environment has raised an error: call reset")
        given = np.asarray(actions)
        if given.shape != self.action_space.shape:
            raise ValueError(f"actions must have the shape {self.action_space.shape}, not {given.shape}")
        ended, self._ended = self._ended, None
        results = self._on_all(lambda i: self._step_one(i, given[i].copy(), bool(ended[i])))
        observations, rewards, terminations, truncations, infos = zip(*results)
        terminated, truncated = np.array(terminations, bool), np.array(truncations, bool)
        self._ended = terminated | truncated
        return np.stack(observations), np.array(rewards, float), terminated, truncated, _together(infos)

    def _step_one(self, number: int, action: npt.NDArray[Any], ended: bool) -> _Result:
        if ended:
            observation, info = self.environments[number].reset()
            return observation, 0.0, False, False, info
        result: _Result = self.environments[number].step(action)
        return result

    def _on_all(self, act: Callable[[int], Any]) -> list[Any]:
        """Calls `act` for all environments. Returns the results in order, or raises the first error after all calls."""
        if self.closed:
            raise Error("the environments are closed")
        if not self._pool:
            return [act(i) for i in range(self.num_envs)]
        waiting: list[Future[Any]] = [self._pool.submit(act, i) for i in range(self.num_envs)]
        errors = [one.exception() for one in waiting]
        for error in errors:
            if error:
                raise error
        return [one.result() for one in waiting]
