# SPDX-License-Identifier: Apache-2.0
"""Checks an environment against the documented interface of Gymnasium's Env.

Each rule is one that gymnasium.Env's page, or that of its `reset` and `step`, states.
"""

from __future__ import annotations

import math
from typing import Any, Callable, Sequence

import numpy as np

STEPS = 20
_FIRST_SEED, _OTHER_SEED = 7, 8


def _same(one: Any, other: Any) -> bool:
    return np.array_equal(np.asarray(one), np.asarray(other))


def _check_spaces(environment: Any) -> list[str]:
    broken = []
    for name in ("action_space", "observation_space"):
        space = getattr(environment, name, None)
        if not callable(getattr(space, "sample", None)) or not callable(getattr(space, "contains", None)):
            broken.append(f"{name} is no space: it has no sample or no contains")
        elif not space.contains(space.sample()):
            broken.append(f"{name} does not contain what it samples")
    modes = dict(getattr(environment, "metadata", None) or {}).get("render_modes")
    if not isinstance(modes, (list, tuple)):
        broken.append("metadata has no list of render_modes")
    elif getattr(environment, "render_mode", None) not in (None, *modes):
        broken.append("render_mode is none of metadata's render_modes")
    for name in ("reset", "step", "close", "render"):
        if not callable(getattr(environment, name, None)):
            broken.append(f"there is no function {name}")
    return broken


def _begin(environment: Any, broken: list[str], **how: Any) -> Any:
    """Resets, and returns the observation."""
    result = environment.reset(**how)
    if not isinstance(result, tuple) or len(result) != 2:
        broken.append("reset does not return a pair (observation, info)")
        return result
    observation, info = result
    if not isinstance(info, dict):
        broken.append("reset returns an info that is no dictionary")
    if not environment.observation_space.contains(observation):
        broken.append("reset returns an observation outside observation_space")
    return observation


def _check_result(environment: Any, result: Any, broken: list[str]) -> bool:
    """What a step returned. False: not even its form is right."""
    if not isinstance(result, tuple) or len(result) != 5:
        broken.append("step does not return (observation, reward, terminated, truncated, info)")
        return False
    observation, reward, terminated, truncated, info = result
    if not environment.observation_space.contains(observation):
        broken.append("step returns an observation outside observation_space")
    if isinstance(reward, bool) or not isinstance(reward, (int, float, np.integer, np.floating)) \
            or not math.isfinite(reward):
        broken.append("step returns a reward that is no finite number")
    for name, flag in (("terminated", terminated), ("truncated", truncated)):
        if not isinstance(flag, (bool, np.bool_)):
            broken.append(f"step returns {name} that is no bool")
    if not isinstance(info, dict):
        broken.append("step returns an info that is no dictionary")
    return True


def _play(environment: Any, actions: Sequence[Any], broken: list[str]) -> list[tuple[Any, float]]:
    """An episode: what each step showed and gave."""
    seen = []
    for action in actions:
        given = np.array(action, copy=True)
        result = environment.step(action)
        if not _check_result(environment, result, broken):
            return seen
        if not _same(action, given):
            broken.append("step changes the action that it is given")
        observation, reward, terminated, truncated, _ = result
        kept = np.array(observation, copy=True)
        seen.append((observation, kept, float(reward)))
        if terminated or truncated:
            break
    if any(not _same(observation, kept) for observation, kept, _ in seen):
        broken.append("an observation changes after it was returned")
    return [(kept, reward) for _, kept, reward in seen]


def _check_seeds(environment: Any, broken: list[str]) -> None:
    first = _begin(environment, broken, seed=_FIRST_SEED)
    drawn = _begin(environment, broken)
    again = _begin(environment, broken, seed=_FIRST_SEED)
    if not _same(first, again):
        broken.append("equal seeds begin unequal episodes")
    if not _same(drawn, _begin(environment, broken)):
        broken.append("after equal seeds, resets without a seed begin unequal episodes")
    if _same(first, drawn) and _same(first, _begin(environment, broken, seed=_OTHER_SEED)):
        return  # nothing is drawn at all
    if _same(first, drawn):
        broken.append("reset without a seed begins as with the last seed, and does not go on drawing")


def _check_episodes(environment: Any, broken: list[str]) -> None:
    environment.action_space.seed(_FIRST_SEED)
    actions = [environment.action_space.sample() for _ in range(STEPS)]
    episodes = []
    for _ in range(2):
        _begin(environment, broken, seed=_FIRST_SEED, options=None)
        episodes.append(_play(environment, actions, broken))
    one, other = episodes
    if len(one) != len(other) or any(not _same(a, b) or r != s for (a, r), (b, s) in zip(one, other)):
        broken.append("equal seeds and actions make unequal episodes")


def check_environment(environment: Any) -> list[str]:
    """The rules that it breaks, each in words, once; an empty list: none. Plays a few short episodes."""
    broken = _check_spaces(environment)
    if broken:
        return broken
    checks: tuple[Callable[[Any, list[str]], None], ...] = (_check_seeds, _check_episodes)
    for check in checks:
        try:
            check(environment, broken)
        except (TypeError, ValueError, AttributeError) as error:
            broken.append(f"it raises {type(error).__name__}: {error}")
    return list(dict.fromkeys(broken))
