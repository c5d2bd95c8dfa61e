# SPDX-License-Identifier: Apache-2.0
"""An areolar plane: strands join two sheets. Part all strands under traction, and damage no sheet."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np
import numpy.typing as npt

from .spaces import Box
from .task import Observation, Picture, Task
from .tissue import Seen, ToolCommand

LENGTH_M, WIDTH_M = 0.014, 0.010  # of the plane, along x and y
TAB_M = 0.004  # of the upper sheet, in front of the plane, where the grasper holds it
BACK_M = 0.004  # of the upper sheet, behind the plane, so that traction can lift it there too
STEP_M = 0.001  # from strand to strand, along x and y
# Distance of the sheets, which is the length of a strand. The wire parts a sheet that is 0.7 mm from its middle, but not
# a sheet at 0.8 mm. So the wire cannot pass between sheets that are 1.4 mm apart: traction has to open the plane.
GAP_M = 0.0014
HOT_RADIUS_M = 0.0004
FOOT_M = 0.004  # of the hook, along x: as wide as four strands
TEMPERATURE_C = 700
THICKNESS_M, STIFFNESS_PA = 0.0005, 1e6  # of a sheet; the stiffness is that of its strain limit
# A sheet bends as a plate of that stiffness, E h^3 / (12 (1 - nu^2)) (Timoshenko and Woinowsky-Krieger, Theory of Plates
# and Shells, 1959, eq. 3). Soft tissue keeps its volume, so nu is 0.5. Without bending stiffness the tab hangs straight
# down, and the grasper finds nothing to hold. With it the tab's edge sags by 0.03 mm.
BENDING_NM = STIFFNESS_PA * THICKNESS_M ** 3 / (12 * (1 - 0.5 ** 2))
LEAST_M = np.array([-0.008, -0.012, -GAP_M])  # least position of the tip
MOST_M = np.array([0.008, 0.006, 0.003])
MOVE_M = 0.0005  # largest motion in a step, of the tip along each axis and of the grasper
HEIGHT_MOST_M = 0.01  # of the grasper
HEIGHT_FIRST_M = 0.004  # height at the start; there the grasper feels 0.16 N, and no strand is longer than 4.6 mm
FORCE_MOST_N = 0.8  # force without a penalty; a grasper 7 mm high, which opens the plane enough, feels up to 0.61 N
TICKS = 4  # of the simulation in a step
STEPS_MOST = 250  # of an episode
ROWS = 5  # number of blocks of strands along x, and along y

_HELD_Y_M = -WIDTH_M / 2 - TAB_M / 2  # y at which the grasper holds
_FREE_Y_M = -0.02  # y without tissue
_APPROACH_TICKS, _GRASP_TICKS, _LIFT_STEPS, _LIFT_TICKS = 10, 15, 10, 2  # phases before an episode, until traction
_SIDEWAYS = (0.5 ** 0.5, 0.5 ** 0.5, 0.0, 0.0)  # the shaft comes along y, from the free edge; the foot lies along x
_FLAT = (0.5, 0.5, 0.5, -0.5)  # as the hook's, and the jaws open along z
_CLEARED_REWARD, _DONE_REWARD, _BURNT_REWARD, _FORCE_REWARD, _STEP_REWARD = 10.0, 10.0, -0.5, -0.1, -0.005


def _sheet(name: str, width_m: float, y_m: float, z_m: float) -> dict[str, Any]:
    cells = [round(LENGTH_M / STEP_M), round(width_m / STEP_M)]
    return {"source": "sheet", "name": name, "size_m": [LENGTH_M, width_m], "cells": cells, "translate_m": [0, y_m, z_m]}


def _layer(name: str) -> dict[str, Any]:
    return {"kind": "fascia", "name": name, "mesh": name, "thickness_m": THICKNESS_M, "density_kg_m3": 1100,
            "bending_stiffness_nm": BENDING_NM, "limit_stiffness_pa": STIFFNESS_PA, "limit": "range",
            "strain_min": [-0.1, -0.1], "strain_max": [0.1, 0.1], "shear_max": 0.2,
            "ignition_c": 120, "ignition_spread_c": 20, "absorption_per_s": 4}


def scene(seed: int) -> dict[str, Any]:
    """Returns the scene of the task. `seed` decides which strands and faces are tougher."""
    # Each strand goes straight down, because no other vertex is within reach_m. The ends of a strand are farther from the
    # wire than the faces of a cut. So strands take up heat ten times as fast as the sheets. Strands are 0.18 mm thick, so
    # that the traction which opens the plane for the wire stays below FORCE_MOST_N.
    strands = {"kind": "links", "name": "strands", "of": "upper", "to": "lower", "young_modulus_pa": 1e5,
               "area_m2": 2.5e-8, "reach_m": 1.02 * GAP_M, "per_vertex": 1, "ignition_c": 120, "ignition_spread_c": 20,
               "absorption_per_s": 40}
    hook = {"name": "hook", "shape": "hook", "hot_radius_m": HOT_RADIUS_M, "tip_length_m": FOOT_M,
            "shaft_radius_m": HOT_RADIUS_M, "temperature_c": TEMPERATURE_C, "grid_step_m": HOT_RADIUS_M,
            "position_m": [0, _FREE_Y_M, -GAP_M / 2], "rotation": list(_SIDEWAYS)}
    grasper = {"name": "grasper", "shape": "grasper", "tip_length_m": 0.008, "shaft_radius_m": 0.003,
               "close_force_n": 4, "position_m": [0, _FREE_Y_M, 0], "rotation": list(_FLAT)}
    far = {"kind": "box", "layer": "upper", "least_m": [-1, WIDTH_M / 2 + BACK_M - 1e-4, -1], "most_m": [1, 1, 1]}
    bed = {"kind": "box", "layer": "lower", "least_m": [-1, -1, -1], "most_m": [1, 1, 1]}
    upper = _sheet("upper", WIDTH_M + TAB_M + BACK_M, (BACK_M - TAB_M) / 2, 0)
    return {"name": "clear-plane", "description": "Two sheets, joined by strands.", "seed": seed, "parting": "elements",
            "meshes": [upper, _sheet("lower", WIDTH_M, 0, -GAP_M)],
            "layers": [_layer("upper"), _layer("lower"), strands], "pins": [bed, far], "tools": [hook, grasper]}


class ClearPlane(Task):
    """Part all strands, and no face of a sheet. `cautery.environments.Task` describes the parameters.

    A grasper holds the free edge of the upper sheet, and its height gives the traction. Without traction the sheets are
    so near each other that the hook parts one of them. The hook lies between the sheets, with its foot along x.

    An action has five numbers from -1 to 1: the motion of the hook's tip along x, y and z, the motion of the grasper
    upward (1 is 0.5 mm), and the energy, which is on above 0. An observation has: the position of the tip (3, from -1 to 1
    within its reach); whether energy is on; the height of the grasper (over 10 mm); its force (over twice the force
    without a penalty, at most 1); whether the grasper holds; for each of 5 x 5 blocks of strands, x slowest, the share of
    parted strands (25); and for each block the distance of the upper from the lower sheet (25, over 10 mm).

    Rewards: 10 times the share of strands that part; 10 when all strands have parted; -0.5 for each face that parts; -0.1
    for each step at twice the force without a penalty (in proportion to the excess); -0.005 for each step. An episode
    terminates when all strands or a face have parted, and is truncated after 250 steps.

    Streams do not show strands. A strand has parted if the channel `charring` of both its vertices counts a parted edge:
    as long as no face has parted, no other edge can have. `reset(options={"tip_m": [x, y, z]})` sets the first position
    of the tip. `render()` returns the plane from above, (110, 150, 3): strands that hold, and the wire.
    """

    steps_usual, ticks, scalars = STEPS_MOST, TICKS, ("charring",)

    def _spaces(self) -> tuple[Box, Box]:
        shares = 4 + 2 * ROWS ** 2
        return Box(-np.ones(5), np.ones(5)), Box(np.r_[-np.ones(3), np.zeros(shares)], np.ones(3 + shares))

    # ---- an episode
    def _begin(self, options: Mapping[str, Any]) -> None:
        place = self._random.uniform((-0.006, -0.011, -0.0012), (0.006, -0.008, -0.0006))
        toughness = self._draw_tissue()
        if "tip_m" in options:
            place = np.asarray(options["tip_m"], float)
        self._tissue.begin(scene(toughness), self.scalars)
        self._take_strands()
        self._tip, self._energy = place, False
        self._take_hold()

    def _take_strands(self) -> None:
        """Finds the upper and lower end of each strand, and its block."""
        # In whole steps of STEP_M, because a daemon sends rest positions as rounded floats.
        corner = (-LENGTH_M / 2, -WIDTH_M / 2)
        steps = np.round((self._tissue.rest[:, :2] - corner) / STEP_M).astype(int)
        upper, lower = (np.unique(self._tissue.faces[self._faces_of(layer)]) for layer in (0, 1))
        below = {tuple(steps[vertex]): vertex for vertex in lower}
        self._ends = np.array([(vertex, below[tuple(steps[vertex])]) for vertex in upper if tuple(steps[vertex]) in below])
        along, across = (steps[self._ends[:, 0]] * ROWS // (steps[lower].max(axis=0) + 1)).T
        self._block = along * ROWS + across
        self._in_block = np.bincount(self._block, minlength=ROWS ** 2)

    def _take_hold(self) -> None:
        """Closes the grasper on the tab, and lifts it."""
        place = np.array([0, _HELD_Y_M, 0])
        hook = ToolCommand("hook", self._tip, _SIDEWAYS)
        self._go([hook, ToolCommand("grasper", place, _FLAT, jaw=1.0)], _APPROACH_TICKS)
        self._go([ToolCommand("grasper", place, _FLAT, grasping=True)], _GRASP_TICKS)
        for k in range(_LIFT_STEPS):
            self._height = HEIGHT_FIRST_M * (k + 1) / _LIFT_STEPS
            self._go(self._commands(), _LIFT_TICKS)

    def _commands(self) -> list[ToolCommand]:
        held = np.array([0, _HELD_Y_M, self._height])
        return [ToolCommand("hook", self._tip, _SIDEWAYS, energized=self._energy),
                ToolCommand("grasper", held, _FLAT, grasping=True)]

    def _act(self, action: npt.NDArray[np.float64]) -> list[ToolCommand]:
        self._tip = (self._tip + MOVE_M * action[:3]).clip(LEAST_M, MOST_M)
        self._height = float(np.clip(self._height + MOVE_M * action[3], 0, HEIGHT_MOST_M))
        self._energy = bool(action[4] > 0)
        return self._commands()

    def _judge(self, before: Seen) -> tuple[float, bool]:
        parted, burnt = self._parted(self._state), int(self._state.removed.sum())
        gone = (parted.sum() - self._parted(before).sum()) / len(parted)
        cleared = bool(parted.all())
        above = max(self._force_n() / FORCE_MOST_N - 1, 0)
        reward = (_CLEARED_REWARD * gone + _DONE_REWARD * (cleared and not burnt) + _FORCE_REWARD * above
                  + _BURNT_REWARD * (burnt - int(before.removed.sum())) + _STEP_REWARD)
        return float(reward), cleared or burnt > 0

    # ---- what is seen
    def _parted(self, state: Seen) -> npt.NDArray[np.bool_]:
        """Which strands have parted."""
        return (state.scalars["charring"][self._ends] > 0).all(axis=1)

    def _force_n(self) -> float:
        return float(np.linalg.norm(self._state.tools["grasper"].force_n))

    def _of_blocks(self, of_strands: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
        """The mean in each block."""
        return np.bincount(self._block, of_strands, ROWS ** 2) / self._in_block

    def _heights_m(self) -> npt.NDArray[np.float64]:
        """From where each strand is joined to the lower sheet up to where it is, or was, to the upper one."""
        return (self._state.positions[self._ends[:, 0]] - self._state.positions[self._ends[:, 1]])[:, 2]

    def _observe(self) -> Observation:
        tip = 2 * (self._tip - LEAST_M) / (MOST_M - LEAST_M) - 1
        holds = self._state.tools["grasper"].grasped_vertices > 0
        seen = np.r_[tip, self._energy, self._height / HEIGHT_MOST_M, self._force_n() / FORCE_MOST_N / 2, holds,
                     self._of_blocks(self._parted(self._state)), (self._of_blocks(self._heights_m()) / 0.01).clip(0)]
        return seen.clip(-1, 1).astype(np.float32)

    def _info(self) -> dict[str, Any]:
        upper, lower = (int(self._state.removed[self._faces_of(layer)].sum()) for layer in (0, 1))
        parted = self._parted(self._state)
        return {"tick": self._state.tick, "strands": len(parted), "strands_parted": int(parted.sum()),
                "cleared": bool(parted.all()), "faces_burnt_above": upper, "faces_burnt_below": lower,
                "force_n": self._force_n(), "tip_m": self._tip.copy()}

    def _draw(self) -> Picture:
        picture = np.full((110, 150, 3), (220, 150, 130), np.uint8)

        def place(x: float, y: float) -> tuple[int, int]:
            return int((x / LENGTH_M + 0.5) * 140) + 5, int((y / WIDTH_M + 0.5) * 100) + 5
        for (x, y, _), parted in zip(self._tissue.rest[self._ends[:, 0]], self._parted(self._state)):
            column, row = place(x, y)
            picture[row - 2:row + 3, column - 2:column + 3] = (150, 90, 80) if parted else (255, 245, 235)
        x, y, _ = self._tip
        left, row = place(x - FOOT_M / 2, y)
        right, _ = place(x + FOOT_M / 2, y)
        picture[max(row - 1, 0):max(row + 2, 0), max(left, 0):max(right, 0)] = (220, 60, 0)
        return picture
