#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Uniaxial stretch with free sides, in closed form: writes uniaxial.txt. Standard library only.

F = diag(s, l, l). The lateral stretch l makes the lateral stress zero; the axial one is the nominal
stress (first Piola-Kirchhoff, Pa). Solved with 40 digits; the stress is checked against the energy.
"""

from decimal import Decimal as D
from decimal import getcontext
from pathlib import Path

getcontext().prec = 40

YOUNG_MODULUS_PA = D(5000)
CASES = [("stvk", "0.3"), ("stvk", "0.4"), ("neohookean", "0.3"), ("neohookean", "0.4"),
         ("neohookean", "0.45")]
STRETCHES = ["0.6", "0.7", "0.8", "0.9", "0.95", "1", "1.05", "1.1", "1.2", "1.35", "1.5"]


def lame(nu):
    """Lame's mu and lambda (Pa)."""
    mu = YOUNG_MODULUS_PA / (2 * (1 + nu))
    return mu, 2 * mu * nu / (1 - 2 * nu)


def stvk(s, nu):
    """l and stress: free sides give e_l = -nu e_s in Green's strain, e = (stretch^2 - 1) / 2."""
    strain = (s * s - 1) / 2
    return (1 - 2 * nu * strain).sqrt(), s * YOUNG_MODULUS_PA * strain


def stvk_energy(s, l, nu):
    mu, lam = lame(nu)
    a, b = (s * s - 1) / 2, (l * l - 1) / 2
    return mu * (a * a + 2 * b * b) + lam / 2 * (a + 2 * b) ** 2


def neohookean_constants(nu):
    mu, lam = lame(nu)
    m, l = mu * 4 / 3, lam + mu * 5 / 6
    return m, l, 1 + m / l - m / (4 * l)


def neohookean(s, nu):
    """l by bisection of the lateral stress over l: m (1 - 1/(I + 1)) + lambda (J - alpha) s."""
    m, lam, alpha = neohookean_constants(nu)

    def lateral(l):
        return m * (1 - 1 / (s * s + 2 * l * l + 1)) + lam * (s * l * l - alpha) * s

    low, high = D("0.2"), D("3")
    assert lateral(low) < 0 < lateral(high)
    for _ in range(130):
        middle = (low + high) / 2
        low, high = (middle, high) if lateral(middle) < 0 else (low, middle)
    l = (low + high) / 2
    return l, m * s * (1 - 1 / (s * s + 2 * l * l + 1)) + lam * (s * l * l - alpha) * l * l


def neohookean_energy(s, l, nu):
    m, lam, alpha = neohookean_constants(nu)
    i = s * s + 2 * l * l
    return m / 2 * (i - 3) + lam / 2 * (s * l * l - alpha) ** 2 - m / 2 * (i + 1).ln()


LAWS = {"stvk": (stvk, stvk_energy), "neohookean": (neohookean, neohookean_energy)}


def check(energy, s, l, stress, nu):
    """Central differences of the energy: axial stress, and no lateral stress."""
    h = D("1e-12")
    axial = (energy(s + h, l, nu) - energy(s - h, l, nu)) / (2 * h)
    side = (energy(s, l + h, nu) - energy(s, l - h, nu)) / (2 * h)
    assert abs(axial - stress) < D("1e-18") * YOUNG_MODULUS_PA, (s, axial, stress)
    assert abs(side) < D("1e-18") * YOUNG_MODULUS_PA, (s, side)


def rows():
    for model, poisson in CASES:
        solve, energy = LAWS[model]
        nu = D(poisson)
        for text in STRETCHES:
            s = D(text)
            l, stress = solve(s, nu)
            check(energy, s, l, stress, nu)
            yield model, float(YOUNG_MODULUS_PA), float(nu), float(s), float(l), float(stress)


def main():
    table = list(rows())
    with open(Path(__file__).parent / "uniaxial.txt", "w", encoding="ascii") as out:
        out.write(f"cautery-uniaxial 1\nrows {len(table)}\n")
        for model, *numbers in table:
            text = [f"{n if abs(n) > 1e-20 else 0:.15g}" for n in numbers]  # 1e-36 is rounding
            out.write(" ".join([model, *text]) + "\n")


if __name__ == "__main__":
    main()
