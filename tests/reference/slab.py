# SPDX-License-Identifier: GPL-3.0-or-later
"""A box of cells, each cut into six tetrahedra along its main diagonal (Kuhn, Freudenthal)."""

from itertools import permutations

import numpy as np


def slab(size_m, cells):
    """Positions (m, (vertices x 3)) and tetrahedra ((tetrahedra x 4), positive volume).

    Centred on the origin in x and y, top at z = 0; x runs fastest.
    """
    axes = [np.linspace(0.0, size_m[a], cells[a] + 1) for a in range(3)]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    position = np.stack([x.ravel() - size_m[0] / 2, y.ravel() - size_m[1] / 2,
                         z.ravel() - size_m[2]], axis=1)
    stride = np.array([1, cells[0] + 1, (cells[0] + 1) * (cells[1] + 1)])
    k, j, i = np.meshgrid(*(np.arange(cells[a]) for a in (2, 1, 0)), indexing="ij")
    corner = np.stack([i.ravel(), j.ravel(), k.ravel()], axis=1) @ stride
    paths = []
    for order in permutations(range(3)):
        path = [0]
        for axis in order:
            path.append(path[-1] + stride[axis])
        odd = np.linalg.det(np.eye(3)[list(order)]) < 0
        paths.append([path[0], path[2], path[1], path[3]] if odd else path)
    tetrahedron = (corner[:, None, None] + np.array(paths)[None]).reshape(-1, 4)
    return position, tetrahedron
