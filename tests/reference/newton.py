# SPDX-License-Identifier: GPL-3.0-or-later
"""Static equilibrium by Newton's method, with an exact active set against a rigid sphere."""

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse

from finite_element import Factor

RESIDUAL = 1e-11  # |free forces| / |all forces| that counts as converged
MOST_ITERATIONS = 60
MOST_ACTIVE_SETS = 40
SMALLEST_STEP = 1e-3  # of a Newton step


@dataclass
class Sphere:
    center_m: np.ndarray
    radius_m: float

    def gap(self, x):
        """Signed distance (m) of points x ((points x 3)) and outward unit normals."""
        d = x - self.center_m
        length = np.linalg.norm(d, axis=1)
        return length - self.radius_m, d / length[:, None]


@dataclass
class Equilibrium:
    u: np.ndarray      # m, (3 nodes)
    force: np.ndarray  # N, (nodes x 3): of supports and sphere on the body
    residual: float    # |unbalanced| / |all forces|
    iterations: int
    stable: bool       # the Hessian is positive definite on the free directions
    contact: dict = field(default_factory=dict)  # node: normal force (N)


class Problem:
    """The free rows of a body whose nodes `active` are held on the sphere's surface.

    Unknowns are the displacements and one normal force for each active node; the rows are
    gradient - sum of force x normal = 0 and gap = 0.
    """

    def __init__(self, body, free, sphere, active, residual):
        self.body, self.free, self.sphere, self.active = body, free, sphere, active
        self.least = residual
        self.n, self.m = len(free), len(active)
        column = np.full(3 * body.node_count, -1)
        column[free] = np.arange(self.n)
        self._column = column.reshape(-1, 3)[active]
        # The gap is scaled to a force so that one norm judges both.
        self.scale = abs(body.hessian(np.zeros(3 * body.node_count)).diagonal()).mean()  # N/m
        self.rounding = 1e-14 * self.scale * np.ptp(body.position)  # N: forces of a body at rest

    def _contact(self, u):
        gap, normal = self.sphere.gap((self.body.position + u.reshape(-1, 3))[self.active])
        rows = np.repeat(np.arange(self.m), 3)
        jacobian = scipy.sparse.csr_matrix((normal.ravel(), (rows, self._column.ravel())),
                                           shape=(self.m, self.n))
        return gap, normal, jacobian

    def residual(self, u, force):
        """Unbalanced rows (N) and the whole gradient (N)."""
        gradient = self.body.gradient(u)
        if not self.m:
            return gradient[self.free], gradient
        gap, _, jacobian = self._contact(u)
        unbalanced = gradient[self.free] - jacobian.T @ force
        return np.concatenate([unbalanced, self.scale * gap]), gradient

    def factor(self, u, force):
        """Factor of the symmetric system [[H, -J^T], [-J, 0]]."""
        h = self.body.hessian(u)[self.free][:, self.free]
        if not self.m:
            return Factor(h)
        gap, normal, jacobian = self._contact(u)
        block = np.eye(3)[None] - normal[:, :, None] * normal[:, None, :]
        block *= (force / (gap + self.sphere.radius_m))[:, None, None]
        rows, columns = np.repeat(self._column, 3, axis=1), np.tile(self._column, (1, 3))
        bend = scipy.sparse.csr_matrix((block.ravel(), (rows.ravel(), columns.ravel())), h.shape)
        return Factor(scipy.sparse.bmat([[h - bend, -jacobian.T], [-jacobian, None]], "csr"))

    def right_side(self, r):
        return np.concatenate([-r[:self.n], r[self.n:] / self.scale])


def _shorten(problem, u, force, r, gradient, step):
    """Halves a Newton step until the residual or, without contact, the energy falls."""
    slope = gradient[problem.free] @ step[:problem.n]
    energy = problem.body.energy(u)
    size = 1.0
    while size > SMALLEST_STEP:
        trial = u.copy()
        trial[problem.free] += size * step[:problem.n]
        trial_force = force + size * step[problem.n:]
        new, new_gradient = problem.residual(trial, trial_force)
        if (np.linalg.norm(new) < (1 - 1e-3 * size) * np.linalg.norm(r)
                or (not problem.m and slope < 0
                    and problem.body.energy(trial) < energy + 1e-4 * size * slope)):
            return trial, trial_force, new, new_gradient
        size /= 2
    raise ArithmeticError("a Newton step improves nothing")


def _newton(problem, u, force):
    """Displacements, normal forces, relative residual, iterations, stability."""
    r, gradient = problem.residual(u, force)
    for iteration in range(MOST_ITERATIONS):
        factor = problem.factor(u, force)
        size, whole = np.linalg.norm(r), np.linalg.norm(gradient)
        if size <= problem.least * whole + problem.rounding:
            # One negative eigenvalue for each constraint: none is left for the body.
            relative = size / max(whole, size, problem.rounding)
            return u, force, relative, iteration, factor.negative_count == problem.m
        step = factor.solve(problem.right_side(r))
        u, force, r, gradient = _shorten(problem, u, force, r, gradient, step)
    raise ArithmeticError("Newton does not converge")


def _settle(body, free, u, sphere, contact, residual):
    """Newton on each active set until no force pulls and no node is inside the sphere."""
    total = 0
    for _ in range(MOST_ACTIVE_SETS):
        active = np.array(sorted(contact), dtype=int)
        force = np.array([contact[a] for a in active])
        problem = Problem(body, free, sphere, active, residual)
        u, force, reached, count, stable = _newton(problem, u, force)
        total += count
        contact = {a: f for a, f in zip(active, force) if f >= 0}
        inside = []
        if sphere:
            gap, _ = sphere.gap(body.position + u.reshape(-1, 3))
            inside = np.setdiff1d(np.flatnonzero(gap < -1e-12 * sphere.radius_m), active)
        if len(contact) == len(active) and len(inside) == 0:
            return u, reached, total, stable, contact
        contact.update((node, 0.0) for node in inside)
    raise ArithmeticError("the active set does not settle")


def _first_guess(body, u, free, held, target):
    """Moves the held rows to their target and the free ones with them, linearly."""
    move = np.zeros_like(u)
    move[held] = target - u[held]
    if move.any():
        h = body.hessian(u)
        move[free] = Factor(h[free][:, free]).solve(-(h[free][:, held] @ move[held]))
    return u + move


def equilibrium(body, held_nodes, held_u, sphere_at=None, steps=1, start=None,
                residual=RESIDUAL):
    """Loads the body with its weight and its held nodes in equal steps.

    `held_u` (m, (held nodes x 3)) is reached at the last step; `sphere_at(s)` is the sphere at the
    fraction s of the loading. With `start` (m, (3 nodes), near the answer, no sphere) there is one
    step.
    """
    held = (3 * np.asarray(held_nodes)[:, None] + np.arange(3)).ravel()
    free = np.setdiff1d(np.arange(3 * body.node_count), held)
    u, contact, total = np.zeros(3 * body.node_count), {}, 0
    if start is not None:
        u, steps = start.copy(), 1
    for step in range(1, steps + 1):
        s = step / steps
        body.set_load(s)
        u = _first_guess(body, u, free, held, s * np.asarray(held_u).ravel())
        sphere = sphere_at(s) if sphere_at else None
        u, reached, count, stable, contact = _settle(body, free, u, sphere, contact, residual)
        total += count
    return Equilibrium(u, body.gradient(u).reshape(-1, 3), reached, total, stable, contact)
