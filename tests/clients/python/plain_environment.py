# SPDX-License-Identifier: GPL-3.0-or-later
"""An environment without a simulation that keeps every rule of the interface."""

import numpy as np

from cautery.environments import Box


class Plain:
    metadata = {"render_modes": []}
    render_mode = None
    farthest = 9

    def __init__(self):
        self.action_space = Box([-1.0], [1.0])
        self.observation_space = Box([-10.0, 0.0], [10.0, 1.0])
        self.random = np.random.default_rng()
        self.place = np.zeros(2, np.float32)

    def reset(self, *, seed=None, options=None):
        del options
        if seed is not None:
            self.random = np.random.default_rng(seed)
        self.place = np.array([self.random.uniform(-1, 1), 0], np.float32)
        return self.place.copy(), {}

    def step(self, action):
        self.place[0] = np.clip(self.place[0] + action[0], -10, 10)
        return self.place.copy(), -abs(float(self.place[0])), bool(abs(self.place[0]) > self.farthest), False, {}

    def render(self):
        return None

    def close(self):
        pass
