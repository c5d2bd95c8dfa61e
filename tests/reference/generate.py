#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solves every reference case with DOLFINx; writes *.case and verification.txt beside this file."""

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy
from petsc4py import PETSc
from scipy.interpolate import RegularGridInterpolator

import dolfinx
from case_file import write_case
from finite_element import Body
from newton import RESIDUAL, Sphere, equilibrium
from slab import slab

HERE = Path(__file__).parent
NEAR = 1e-9  # m, of a plane
FINE_RESIDUAL = 1e-8  # on the converged meshes, where rounding sets in near 1e-11


@dataclass
class Case:
    name: str
    model: str
    young_modulus_pa: float
    poisson_ratio: float
    size_m: tuple
    cells: tuple
    steps: int
    density_kg_m3: float = 911.0
    gravity_m_s2: tuple = (0.0, 0.0, 0.0)
    move_m: tuple = ()       # of the far end; empty: it is free, unless it is turned
    turn_rad: float = 0.0    # of the far end about the beam's axis
    sphere_radius_m: float = 0.0
    depth_m: float = 0.0
    finer: tuple = (2, 2)    # the converged mesh: cells along each side x this, and its degree

    def fixed(self, x):
        """The nodes that do not move: the bottom under a sphere, else the near end."""
        if self.sphere_radius_m:
            return np.flatnonzero(x[:, 2] < NEAR - self.size_m[2])
        return np.flatnonzero(x[:, 0] < NEAR - self.size_m[0] / 2)

    def end(self, x):
        return np.flatnonzero(x[:, 0] > self.size_m[0] / 2 - NEAR)

    def moved(self, x):
        return self.end(x) if self.move_m or self.turn_rad else np.array([], dtype=int)

    def end_moves(self, x):
        """What the far end's nodes are to move by (m)."""
        if not self.turn_rad:
            return np.tile(self.move_m, (len(x), 1))
        y, z = x[:, 1], x[:, 2] + self.size_m[2] / 2
        c, s = np.cos(self.turn_rad), np.sin(self.turn_rad)
        return np.stack([0 * y, (c - 1) * y - s * z, s * y + (c - 1) * z], axis=1)

    def sphere_m(self):
        """Centre and radius."""
        if not self.sphere_radius_m:
            return 0.0, 0.0, 0.0, 0.0
        return 0.0, 0.0, self.sphere_radius_m - self.depth_m, self.sphere_radius_m

    def sphere_at(self, s):
        r = self.sphere_radius_m
        return Sphere(np.array([0.0, 0.0, r - s * self.depth_m]), r)

    def measure(self, x, answer):
        """The one number that is compared with the converged mesh (README.md)."""
        if self.move_m:
            return answer.force[self.moved(x)].sum(axis=0)[0]
        if self.turn_rad:
            end = self.moved(x)
            now, force = (x + answer.u.reshape(-1, 3))[end], answer.force[end]
            arm = now[:, 1], now[:, 2] + self.size_m[2] / 2
            return (arm[0] * force[:, 2] - arm[1] * force[:, 1]).sum()
        if self.sphere_radius_m:
            return answer.force[list(answer.contact)].sum(axis=0)[2]
        y, z = abs(x[:, 1]), abs(x[:, 2] + self.size_m[2] / 2)
        corner = np.flatnonzero((x[:, 0] > self.size_m[0] / 2 - NEAR)
                                & (y > self.size_m[1] / 2 - NEAR)
                                & (z > self.size_m[2] / 2 - NEAR))
        assert len(corner) == 4
        return answer.u.reshape(-1, 3)[corner, 2].mean()

    def body(self, factor=1, degree=1):
        mesh = slab(self.size_m, [factor * c for c in self.cells])
        return mesh, Body(*mesh, self.model, self.young_modulus_pa, self.poisson_ratio,
                          self.density_kg_m3, self.gravity_m_s2, degree)

    def solve(self, body, start=None, residual=RESIDUAL):
        x = body.position
        fixed, moved = self.fixed(x), self.moved(x)
        target = np.zeros((len(fixed) + len(moved), 3))
        if len(moved):
            target[len(fixed):] = self.end_moves(x[moved])
        return equilibrium(body, np.concatenate([fixed, moved]), target,
                           self.sphere_at if self.sphere_radius_m else None, self.steps, start,
                           residual)


def cases():
    block = dict(young_modulus_pa=5e3, size_m=(0.06, 0.03, 0.02), cells=(10, 5, 4), steps=4,
                 move_m=(0.012, 0.0, 0.004))
    beam = dict(young_modulus_pa=4e5, size_m=(0.25, 0.03, 0.04), cells=(25, 3, 4), steps=4,
                gravity_m_s2=(0.0, 0.0, -9.81))
    # Sixty degrees: the far end's corners go 21 mm, its edges are never shorter than 0.87 on the way.
    twisted = dict(young_modulus_pa=5e3, size_m=(0.12, 0.03, 0.03), cells=(16, 4, 4), steps=6,
                   turn_rad=np.pi / 3)
    pressed = dict(young_modulus_pa=5e3, size_m=(0.024, 0.024, 0.012), cells=(12, 12, 6),
                   sphere_radius_m=0.006, finer=(2, 1))
    return [
        Case("block_stvk_nu30", "stvk", poisson_ratio=0.3, **block),
        Case("block_neohookean_nu30", "neohookean", poisson_ratio=0.3, **block),
        Case("block_neohookean_nu40", "neohookean", poisson_ratio=0.4, **block),
        Case("cantilever_stvk_nu30", "stvk", poisson_ratio=0.3, **beam),
        Case("cantilever_stvk_nu45", "stvk", poisson_ratio=0.45, **beam),
        Case("cantilever_neohookean_nu30", "neohookean", poisson_ratio=0.3, **beam),
        Case("cantilever_neohookean_nu45", "neohookean", poisson_ratio=0.45, **beam),
        Case("twist_stvk_nu30", "stvk", poisson_ratio=0.3, **twisted),
        Case("twist_neohookean_nu40", "neohookean", poisson_ratio=0.4, **twisted),
        # St. Venant-Kirchhoff gives way in compression: 2 mm already crushes elements to 0.43.
        Case("indentation_stvk_nu30", "stvk", poisson_ratio=0.3, depth_m=0.0015, steps=12,
             **pressed),
        Case("indentation_neohookean_nu30", "neohookean", poisson_ratio=0.3, depth_m=0.004, steps=8,
             **pressed),
        Case("indentation_neohookean_nu40", "neohookean", poisson_ratio=0.4, depth_m=0.004, steps=8,
             **pressed),
    ]


def finite_differences(body, length_m):
    """Relative errors of forces against the energy and of stiffness against forces."""
    random = np.random.default_rng(7)
    u = 0.03 * length_m * random.standard_normal(3 * body.node_count)
    d = random.standard_normal(u.size)
    h = 1e-6 * length_m
    slope = (body.energy(u + h * d) - body.energy(u - h * d)) / (2 * h)
    change = (body.gradient(u + h * d) - body.gradient(u - h * d)) / (2 * h)
    stiff = body.hessian(u) @ d
    force = abs(slope / (body.gradient(u) @ d) - 1)
    return force, np.linalg.norm(change - stiff) / np.linalg.norm(stiff)


def uniaxial_error():
    """Worst relative error of one cube of six tetrahedra against uniaxial.txt."""
    worst = 0.0
    for line in (HERE / "uniaxial.txt").read_text(encoding="ascii").splitlines()[2:]:
        model, *numbers = line.split()
        young, nu, stretch, lateral, stress = map(float, numbers)
        body = Body(*slab((0.01, 0.01, 0.01), (1, 1, 1)), model, young, nu)
        low = body.position - body.position.min(axis=0)
        u = low * (np.array([stretch, lateral, lateral]) - 1)
        force = body.gradient(u.ravel()).reshape(-1, 3)
        pull = force[low[:, 0] > NEAR].sum(axis=0)[0] / 1e-4
        side = abs(force[low[:, 1] > NEAR].sum(axis=0)[1]) / 1e-4
        worst = max(worst, abs(pull - stress) / young, side / young)
    return worst


def least_stretch(mesh, u):
    """Smallest principal stretch of any tetrahedron."""
    x, t = mesh
    rest, now = x[t], (x + u)[t]
    f = np.linalg.solve(rest[:, 1:] - rest[:, :1], now[:, 1:] - now[:, :1])
    assert (np.linalg.det(f) > 0).all()
    return np.linalg.svd(f, compute_uv=False).min()


def onto(mesh, case, u, points):
    """The coarse displacements at other points, linear in each cell: a start for a finer mesh."""
    x, _ = mesh
    shape = tuple(c + 1 for c in reversed(case.cells))
    axes = [np.unique(np.round(x[:, a], 12)) for a in (2, 1, 0)]
    at = RegularGridInterpolator(axes, u.reshape(*shape, 3), bounds_error=False, fill_value=None)
    return at(points[:, ::-1]).ravel()


def converged_measure(case, mesh, u):
    """The measure on the finer mesh of `case.finer`."""
    _, body = case.body(*case.finer)
    # Contact is followed from the start: the active set of a guess is nobody's.
    start = None if case.sphere_radius_m else onto(mesh, case, u, body.position)
    answer = case.solve(body, start, FINE_RESIDUAL)
    assert answer.stable
    return case.measure(body.position, answer)


def solve_case(case):
    """Writes one case; returns its line of verification.txt."""
    mesh, body = case.body()
    node = body.node_of_vertex
    vertex = np.argsort(node)
    force_error, stiffness_error = finite_differences(body, case.size_m[0] / case.cells[0])
    answer = case.solve(body)
    assert answer.stable, case.name
    u = answer.u.reshape(-1, 3)[node]
    force = answer.force[node]
    fixed, moved = case.fixed(mesh[0]), case.moved(mesh[0])
    contacts = sorted((vertex[n], f) for n, f in answer.contact.items())
    touching = [v for v, _ in contacts]
    solution = dict(residual=answer.residual, displacement=u, fixed=fixed, moved=moved,
                    contacts=contacts, measure=case.measure(body.position, answer),
                    measure_converged=converged_measure(case, mesh, u),
                    reaction_n=force[fixed].sum(axis=0), hold_n=force[moved].sum(axis=0),
                    contact_n=force[touching].sum(axis=0))
    write_case(HERE / f"{case.name}.case", case, mesh, solution)
    ratio = solution["measure"] / solution["measure_converged"]
    return (f"{case.name:28s} {answer.iterations:4d} {answer.residual:9.1e} {force_error:9.1e} "
            f"{stiffness_error:9.1e} {least_stretch(mesh, u):7.3f} {solution['measure']:12.6g} "
            f"{solution['measure_converged']:12.6g} {ratio:7.4f}")


def write_log(new):
    """Rewrites verification.txt: `new` lines by case name, and the old ones of other cases."""
    path = HERE / "verification.txt"
    old = path.read_text(encoding="ascii").splitlines() if path.exists() else []
    line = {text.split()[0]: text for text in old if not text.startswith("#")} | new
    petsc = ".".join(map(str, PETSc.Sys.getVersion()))
    head = [f"# DOLFINx {dolfinx.__version__}, PETSc {petsc}, NumPy {np.__version__},"
            f" SciPy {scipy.__version__}",
            f"# one cube against uniaxial.txt, worst |error| / E: {uniaxial_error():.1e}",
            "# case, Newton iterations, relative residual, error of forces and of stiffness by",
            "# finite differences, least principal stretch, measure, converged, their ratio"]
    body = [line[case.name] for case in cases() if case.name in line]
    path.write_text("\n".join(head + body) + "\n", encoding="ascii")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="cases to solve; none: all")
    names = parser.parse_args().names
    for case in cases():
        if not names or case.name in names:
            line = solve_case(case)
            print(line, flush=True)
            write_log({case.name: line})


if __name__ == "__main__":
    main()
