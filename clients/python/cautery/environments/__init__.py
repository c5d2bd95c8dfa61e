# SPDX-License-Identifier: Apache-2.0
"""Tasks for learners, with the interface of Gymnasium's environments. Gymnasium itself is not needed.

    from cautery.environments import PartBand

    environment = PartBand()
    observation, info = environment.reset(seed=1)
    observation, reward, terminated, truncated, info = environment.step(environment.action_space.sample())
"""

from .check import check_environment
from .check_vector import check_vector_environment
from .clear_plane import ClearPlane
from .part_band import PartBand
from .seal_and_divide import SealAndDivide
from .spaces import Box
from .task import Task
from .vector import AutoresetMode, VectorEnvironment

__all__ = ["AutoresetMode", "Box", "ClearPlane", "PartBand", "SealAndDivide", "Task", "VectorEnvironment",
           "check_environment", "check_vector_environment"]
