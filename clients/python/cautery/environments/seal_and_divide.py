# SPDX-License-Identifier: Apache-2.0
"""A strip of tissue with an artery. Seal the artery with bipolar forceps, and divide it in the seal, without blood."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np
import numpy.typing as npt

from .spaces import Box
from .task import Observation, Picture, Task, is_divided
from .tissue import Seen, SeenVessel, ToolCommand

LENGTH_M, WIDTH_M, DEPTH_M = 0.02, 0.004, 0.003  # of the strip, along x, y and z; its top is at 0
REACH_M = 0.006  # reach of both tools along x, to both sides of the middle of the strip
FORCEPS_LOW_M, FORCEPS_HIGH_M = -0.008, 0.004  # height of the forceps' tip; when low, the strip is between the jaws
FORCEPS_MOVE_M = 0.001  # largest motion of the forceps in a step, along each axis
NEEDLE_REACH_M = 0.006  # reach to both sides of the middle line of the strip
NEEDLE_MOVE_M = 0.0005  # largest motion of the needle in a step, along each axis: 6 mm/s
PRESSURE_PA = (8000, 16000)  # range of the drawn pressure of the artery: low to high mean pressures of arteries
MARGIN = 2  # burst pressure that the artery needs, over its pressure
TICKS = 5  # of the simulation in a step
STEPS_MOST = 200  # of an episode

_NEEDLE_Z_M = -0.007  # z of the needle's tip; the needle passes through the whole depth of the strip
_TURNED = (0.5 ** 0.5, 0.0, 0.0, 0.5 ** 0.5)  # the jaws open along y
_HOT_C, _LOAD_OHM, _POWER_W, _BLEEDING_M3_S, _SHED_M3 = 100.0, 1000.0, 40.0, 5e-6, 5e-6  # values that are 1 in an observation
_SEALED_REWARD, _DONE_REWARD, _BLOOD_REWARD, _STEP_REWARD = 5.0, 10.0, -2e6, -0.005  # blood: -2 for 1 ml


def scene(seed: int) -> dict[str, Any]:
    """Returns the scene of the task: like deploy/scenes/pedicle.json, but half as long, with coarser elements and a third of
    the iterations.

    `seed` decides the position of the artery across the strip, its pressure, and the tissue.
    """
    random = np.random.default_rng(seed)
    y_m = float(random.uniform(-0.0004, 0.0004))  # leaves at least 0.6 mm of tissue beside the artery
    pressure_pa = float(random.uniform(*PRESSURE_PA))
    strip = {"kind": "fat", "name": "strip", "mesh": "strip", "tissue": "connective", "density_kg_m3": 1050,
             "young_modulus_pa": 60000, "model": "neohookean", "poisson_ratio": 0.4, "limit": "none",
             "limit_stiffness_pa": 1000, "tear_energy_j_m2": 2000, "coagulated_tear": 0.2}
    forceps = {"name": "forceps", "shape": "bipolar", "hot_radius_m": 0.003, "tip_length_m": 0.012, "jaw_open_rad": 1.0,
               "close_force_n": 60, "grid_step_m": 0.0005, "power_w": 40, "peak_v": 60,
               "position_m": [0, 0, FORCEPS_HIGH_M], "rotation": list(_TURNED)}
    needle = {"name": "needle", "shape": "capsule", "hot_radius_m": 0.0003, "tip_length_m": 0.01, "grid_step_m": 0.0003,
              "power_w": 40, "position_m": [0, -NEEDLE_REACH_M, _NEEDLE_Z_M]}
    artery = {"name": "artery", "layer": "strip", "radius_m": 0.001, "wall_m": 0.0002, "pressure_pa": pressure_pa,
              "end_pressure_pa": pressure_pa / 3,
              "points": [{"at_m": [x, y_m, -DEPTH_M / 2]} for x in (-LENGTH_M / 2, LENGTH_M / 2)]}
    ends = [{"kind": "box", "layer": "strip", "least_m": [x - 1e-4, -1, -1], "most_m": [x + 1e-4, 1, 1]}
            for x in (-LENGTH_M / 2, LENGTH_M / 2)]
    return {"name": "seal-and-divide", "description": "A strip with an artery.", "seed": seed, "energy": "tissue",
            "cell_m": 0.0004, "iterations": 10, "parting": "elements",
            "meshes": [{"source": "slab", "name": "strip", "size_m": [LENGTH_M, WIDTH_M, DEPTH_M], "cells": [25, 4, 3]}],
            "layers": [strip], "pins": ends, "tools": [forceps, needle], "vessels": [artery]}


class SealAndDivide(Task):
    """Seal the artery, and divide the strip in the seal. `cautery.environments.Task` describes the parameters.

    An action has seven numbers from -1 to 1. Forceps: motion along x and z (1 is 1 mm), closing of the jaws (closed above
    0), and energy (on above 0). Needle: motion along x and y (1 is 0.5 mm), and energy.

    An observation has 21 numbers. Forceps: position along x and z (2, from -1 to 1 within their reach), opening of the
    jaws, whether they hold tissue, whether energy is on, power (over 40 W), load (over 1,000 ohm), temperature (over
    100 degC) and force (over 60 N). Needle: position along x and y (2), whether energy is on, power. Artery: its pressure
    (over 16 kPa); the burst pressure of its seal (over the needed pressure, which is twice its pressure); whether it is
    shut, sealed, pierced and parted; bleeding (over 5 ml/s); and lost blood (over 5 ml).

    Rewards: 5 times each gain in the share of the needed burst pressure; 10 when the strip and the artery are divided
    without blood; -2 for each millilitre of blood; -0.005 for each step. An episode terminates when strip and artery are
    divided, and is truncated after 200 steps. The burst pressure is a prediction (core/vessel/README.md).

    `reset(options={"forceps_x_m": x})` sets the first position of the forceps. `render()` returns the strip from above,
    (60, 200, 3).
    """

    steps_usual, ticks = STEPS_MOST, TICKS

    def _spaces(self) -> tuple[Box, Box]:
        least = np.zeros(21)
        least[[0, 1, 9, 10]] = -1
        return Box(-np.ones(7), np.ones(7)), Box(least, np.ones(21))

    # ---- an episode
    def _begin(self, options: Mapping[str, Any]) -> None:
        forceps_x, needle_x = self._random.uniform(-0.004, 0.004, 2)
        made = scene(self._draw_tissue())
        forceps_x = float(options.get("forceps_x_m", forceps_x))
        self._tissue.begin(made, self.scalars)
        self._pressure_pa = made["vessels"][0]["pressure_pa"]
        vertices = np.unique(self._tissue.faces)
        sides = self._tissue.rest[vertices][:, 0] / LENGTH_M
        self._ends = (set(vertices[sides < -0.499].tolist()), set(vertices[sides > 0.499].tolist()))
        self._forceps = np.array([forceps_x, 0, FORCEPS_HIGH_M])
        self._needle = np.array([needle_x, -NEEDLE_REACH_M, _NEEDLE_Z_M])
        self._closed = self._sealing = self._cutting = False
        self._best = 0.0
        self._go(self._commands())

    def _commands(self) -> list[ToolCommand]:
        return [ToolCommand("forceps", self._forceps, _TURNED, 0.0 if self._closed else 1.0, self._sealing, self._closed),
                ToolCommand("needle", self._needle, energized=self._cutting)]

    def _act(self, action: npt.NDArray[np.float64]) -> list[ToolCommand]:
        x, z = self._forceps[[0, 2]] + FORCEPS_MOVE_M * action[:2]
        self._forceps = np.array([np.clip(x, -REACH_M, REACH_M), 0, np.clip(z, FORCEPS_LOW_M, FORCEPS_HIGH_M)])
        x, y = self._needle[:2] + NEEDLE_MOVE_M * action[4:6]
        self._needle = np.array([np.clip(x, -REACH_M, REACH_M), np.clip(y, -NEEDLE_REACH_M, NEEDLE_REACH_M), _NEEDLE_Z_M])
        self._closed, self._sealing, self._cutting = (bool(action[i] > 0) for i in (2, 3, 6))
        return self._commands()

    def _judge(self, before: Seen) -> tuple[float, bool]:
        share = self._share(self._artery(self._state))
        gained, self._best = max(share - self._best, 0), max(share, self._best)
        blood_m3 = self._artery(self._state).shed_m3
        divided = self._is_divided()
        reward = (_SEALED_REWARD * gained + _BLOOD_REWARD * (blood_m3 - self._artery(before).shed_m3)
                  + _DONE_REWARD * (divided and blood_m3 == 0) + _STEP_REWARD)
        return reward, divided

    # ---- what is seen
    def _artery(self, state: Seen) -> SeenVessel:
        return state.vessels["artery"]

    def _share(self, artery: SeenVessel) -> float:
        """Of the burst pressure that it needs."""
        return min(artery.burst_pa / (MARGIN * self._pressure_pa), 1)

    def _is_divided(self) -> bool:
        return self._artery(self._state).parted and is_divided(self._tissue.faces[~self._state.removed], self._ends)

    def _observe(self) -> Observation:
        forceps, needle, artery = self._state.tools["forceps"], self._state.tools["needle"], self._artery(self._state)
        middle = (FORCEPS_HIGH_M + FORCEPS_LOW_M) / 2
        seen = [self._forceps[0] / REACH_M, (self._forceps[2] - middle) / (FORCEPS_HIGH_M - middle), forceps.jaw,
                forceps.grasped_vertices > 0, self._sealing, forceps.power_w / _POWER_W, forceps.load_ohm / _LOAD_OHM,
                forceps.tip_temperature_c / _HOT_C, float(np.linalg.norm(forceps.force_n)) / 60,
                self._needle[0] / REACH_M, self._needle[1] / NEEDLE_REACH_M, self._cutting, needle.power_w / _POWER_W,
                self._pressure_pa / PRESSURE_PA[1], self._share(artery), artery.shut, artery.sealed, artery.pierced,
                artery.parted, artery.bleeding_m3_s / _BLEEDING_M3_S, artery.shed_m3 / _SHED_M3]
        return np.array(seen, float).clip(self.observation_space.low, 1).astype(np.float32)

    def _info(self) -> dict[str, Any]:
        artery = self._artery(self._state)
        return {"tick": self._state.tick, "divided": self._is_divided(), "parted": artery.parted, "sealed": artery.sealed,
                "burst_pa": artery.burst_pa, "pressure_pa": self._pressure_pa, "shed_m3": artery.shed_m3,
                "forceps_m": self._forceps.copy(), "needle_m": self._needle.copy()}

    def _draw(self) -> Picture:
        picture = np.full((60, 200, 3), 255, np.uint8)

        def place(x: float, y: float) -> tuple[int, int]:
            return int((x / LENGTH_M + 0.5) * 199), int((y / (3 * WIDTH_M) + 0.5) * 59)
        faces = self._tissue.faces[~self._state.removed]
        exposure = self._state.scalars["exposure"][faces].mean(axis=1)
        for (x, y, _), heat in zip(self._state.positions[faces].mean(axis=1), exposure):
            column, row = place(x, y)
            picture[max(row - 2, 0):max(row + 3, 0), max(column - 3, 0):max(column + 4, 0)] = (
                230 - 100 * heat, 150 - 60 * heat, 130 - 60 * heat)
        for (x, y, _), colour in ((self._forceps, (60, 60, 200)), (self._needle, (220, 60, 0))):
            column, row = place(x, y)
            picture[max(row - 1, 0):row + 2, max(column - 1, 0):column + 2] = colour
        return picture
