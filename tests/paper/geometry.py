# SPDX-License-Identifier: GPL-3.0-or-later
"""Small geometry on plain tuples: strains of triangles, distances in the plane."""

import math


def rest_weights(rest, axis):
    """(p, q) with axis = p e_0 + q e_1, e the two edges of a triangle at rest; plane z = 0."""
    e = [(corner[0] - rest[0][0], corner[1] - rest[0][1]) for corner in rest[1:]]
    determinant = e[0][0] * e[1][1] - e[0][1] * e[1][0]
    return ((axis[0] * e[1][1] - axis[1] * e[1][0]) / determinant,
            (e[0][0] * axis[1] - e[0][1] * axis[0]) / determinant)


def strain(rest, now, axis):
    """|F axis| - 1 of a triangle (eq. 8), `axis` a unit vector of the plane at rest."""
    p, q = rest_weights(rest, axis)
    image = [p * (now[1][k] - now[0][k]) + q * (now[2][k] - now[0][k]) for k in range(3)]
    return math.sqrt(sum(value * value for value in image)) - 1


def point_segment(point, a, b):
    """Distance in the plane."""
    along = (b[0] - a[0], b[1] - a[1])
    length2 = along[0] ** 2 + along[1] ** 2
    t = ((point[0] - a[0]) * along[0] + (point[1] - a[1]) * along[1]) / length2 if length2 else 0
    t = min(1, max(0, t))
    return math.hypot(point[0] - a[0] - t * along[0], point[1] - a[1] - t * along[1])


def turn(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def segments_cross(a, b, c, d):
    return turn(a, b, c) * turn(a, b, d) < 0 and turn(c, d, a) * turn(c, d, b) < 0


def segments_distance(a, b, c, d):
    if segments_cross(a, b, c, d):
        return 0
    return min(point_segment(a, c, d), point_segment(b, c, d), point_segment(c, a, b), point_segment(d, a, b))


def is_inside(point, triangle):
    turns = [turn(triangle[i], triangle[(i + 1) % 3], point) for i in range(3)]
    return all(t >= 0 for t in turns) or all(t <= 0 for t in turns)


def triangle_distance(triangle, a, b):
    """Of a triangle and a segment, both in the plane."""
    if is_inside(a, triangle) or is_inside(b, triangle):
        return 0
    return min(segments_distance(triangle[i], triangle[(i + 1) % 3], a, b) for i in range(3))
