# SPDX-License-Identifier: Apache-2.0
"""Checks a vector of environments against the documented interface of Gymnasium's VectorEnv.

Each rule is one that the page of gymnasium.vector.VectorEnv states, or that of its autoreset modes.
"""

from __future__ import annotations

from typing import Any, Callable

import numpy as np

STEPS = 20
_SEED = 7
_MODES = ("NextStep", "SameStep", "Disabled")


def _same(one: Any, other: Any) -> bool:
    return np.array_equal(np.asarray(one), np.asarray(other))


def _mode(vector: Any) -> Any:
    mode = dict(getattr(vector, "metadata", None) or {}).get("autoreset_mode")
    return getattr(mode, "value", mode)


def _check_form(vector: Any) -> list[str]:
    broken = []
    count = getattr(vector, "num_envs", None)
    if not isinstance(count, int) or count < 1:
        return ["num_envs is no number of environments"]
    for name in ("action_space", "observation_space"):
        single, whole = getattr(vector, "single_" + name, None), getattr(vector, name, None)
        if not callable(getattr(single, "sample", None)) or not callable(getattr(whole, "sample", None)):
            broken.append(f"{name} or single_{name} is no space")
        elif np.shape(whole.sample()) != (count, *np.shape(single.sample())):
            broken.append(f"{name} is not num_envs times single_{name}")
    if _mode(vector) not in _MODES:
        broken.append("metadata states no autoreset_mode")
    for name in ("reset", "step", "close", "render"):
        if not callable(getattr(vector, name, None)):
            broken.append(f"there is no function {name}")
    return broken


def _check_infos(vector: Any, infos: Any, of: str, broken: list[str]) -> None:
    if not isinstance(infos, dict):
        broken.append(f"{of} returns infos that are no dictionary")
        return
    for name, values in infos.items():
        if name.startswith("_"):
            continue
        if np.shape(values)[:1] != (vector.num_envs,) or np.shape(infos.get("_" + name)) != (vector.num_envs,):
            broken.append(f"{of} returns an info that has no value, or no mask, for each environment")


def _begin(vector: Any, broken: list[str], **how: Any) -> Any:
    result = vector.reset(**how)
    if not isinstance(result, tuple) or len(result) != 2:
        broken.append("reset does not return a pair (observations, infos)")
        return np.zeros(0)
    observations, infos = result
    if not vector.observation_space.contains(observations):
        broken.append("reset returns observations outside observation_space")
    _check_infos(vector, infos, "reset", broken)
    return np.array(observations, copy=True)


def _check_result(vector: Any, result: Any, broken: list[str]) -> bool:
    """What a step returned. False: not even its form is right."""
    if not isinstance(result, tuple) or len(result) != 5:
        broken.append("step does not return (observations, rewards, terminations, truncations, infos)")
        return False
    observations, rewards, terminations, truncations, infos = result
    if not vector.observation_space.contains(observations):
        broken.append("step returns observations outside observation_space")
    if np.shape(rewards) != (vector.num_envs,) or not np.isfinite(np.asarray(rewards, float)).all():
        broken.append("step returns rewards that are no finite number for each environment")
        return False
    for name, flags in (("terminations", terminations), ("truncations", truncations)):
        if not isinstance(flags, np.ndarray) or flags.dtype != bool or flags.shape != (vector.num_envs,):
            broken.append(f"step returns {name} that are no bool for each environment")
            return False
    _check_infos(vector, infos, "step", broken)
    return True


def _check_autoreset(vector: Any, ended: Any, result: Any, broken: list[str]) -> None:
    """The step after some have ended, in the mode NEXT_STEP."""
    _, rewards, terminations, truncations, _ = result
    if np.asarray(rewards)[ended].any():
        broken.append("the step after an end gives a reward, and autoreset is NextStep")
    if (terminations | truncations)[ended].any():
        broken.append("the step after an end ends again, and autoreset is NextStep")


def _play(vector: Any, actions: Any, broken: list[str]) -> list[Any]:
    """What each step returned, copied."""
    seen: list[Any] = []
    shown: list[Any] = []
    ended = np.zeros(vector.num_envs, bool)
    for action in actions:
        given = np.array(action, copy=True)
        result = vector.step(action)
        if not _check_result(vector, result, broken):
            return seen
        if not _same(action, given):
            broken.append("step changes the actions that it is given")
        if _mode(vector) == "NextStep":
            _check_autoreset(vector, ended, result, broken)
        elif _mode(vector) == "Disabled" and ended.any():
            return seen
        ended = result[2] | result[3]
        shown.append(result[0])
        seen.append([np.array(part, copy=True) for part in result[:4]])
    if any(not _same(one, kept[0]) for one, kept in zip(shown, seen)):
        broken.append("observations change after they were returned")
    return seen


def _check_seeds(vector: Any, broken: list[str]) -> None:
    count = vector.num_envs
    by_list = _begin(vector, broken, seed=[_SEED + i for i in range(count)])
    if not _same(by_list, _begin(vector, broken, seed=_SEED)):
        broken.append("a seed s is not the seed s + i of environment i")
    alike = _begin(vector, broken, seed=[_SEED] * count)
    if not _same(alike, np.repeat(alike[:1], count, axis=0)):
        broken.append("equal seeds begin unequal episodes in different environments")
    if not _same(alike[:1], by_list[:1]):
        broken.append("what one environment draws depends on the seeds of the others")


def _check_episodes(vector: Any, steps: int, broken: list[str]) -> None:
    vector.action_space.seed(_SEED)
    actions = [vector.action_space.sample() for _ in range(steps)]
    episodes = []
    for _ in range(2):
        _begin(vector, broken, seed=_SEED, options=None)
        episodes.append(_play(vector, [np.array(action, copy=True) for action in actions], broken))
    one, other = episodes
    if len(one) != len(other) or any(not _same(a, b) for first, second in zip(one, other) for a, b in zip(first, second)):
        broken.append("equal seeds and actions make unequal episodes")


def check_vector_environment(vector: Any, steps: int = STEPS) -> list[str]:
    """The rules that it breaks, each in words, once; an empty list: none. Plays two runs of so many steps.

    The rules of autoreset are checked where an episode ends within them.
    """
    broken = _check_form(vector)
    if broken:
        return broken
    checks: tuple[Callable[[], None], ...] = (lambda: _check_seeds(vector, broken),
                                              lambda: _check_episodes(vector, steps, broken))
    for check in checks:
        try:
            check()
        except (TypeError, ValueError, AttributeError) as error:
            broken.append(f"it raises {type(error).__name__}: {error}")
    return list(dict.fromkeys(broken))
