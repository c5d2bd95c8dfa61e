# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes one reference case as text (format: README.md; reader: case.c)."""


def _numbers(values):
    return " ".join(f"{v + 0.0:.9g}" for v in values)


def _section(out, name, rows):
    rows = list(rows)
    out.write(f"{name} {len(rows)}\n")
    for row in rows:
        out.write(row + "\n")


def write_case(path, case, mesh, solution):
    """`mesh`: (position, tetrahedron); `solution`: the fields named below, by vertex."""
    position, tetrahedron = mesh
    with open(path, "w", encoding="ascii") as out:
        out.write("cautery-reference 1\n")
        out.write(f"name {case.name}\nmodel {case.model}\n")
        out.write(f"young_modulus_pa {case.young_modulus_pa:.9g}\n")
        out.write(f"poisson_ratio {case.poisson_ratio:.9g}\n")
        out.write(f"density_kg_m3 {case.density_kg_m3:.9g}\n")
        out.write(f"gravity_m_s2 {_numbers(case.gravity_m_s2)}\n")
        out.write(f"sphere_m {_numbers(case.sphere_m())}\n")
        for name in ("residual", "measure", "measure_converged"):
            out.write(f"{name} {solution[name]:.9g}\n")
        for name in ("reaction_n", "hold_n", "contact_n"):
            out.write(f"{name} {_numbers(solution[name])}\n")
        _section(out, "vertices", (_numbers(p) for p in position))
        _section(out, "tetrahedra", (" ".join(map(str, t)) for t in tetrahedron))
        _section(out, "fixed", (str(v) for v in solution["fixed"]))
        _section(out, "prescribed", (f"{v} {_numbers(solution['displacement'][v])}" for v in solution["moved"]))
        _section(out, "contacts", (f"{v} {f:.9g}" for v, f in solution["contacts"]))
        _section(out, "displacements", (_numbers(u) for u in solution["displacement"]))
        out.write("end\n")
