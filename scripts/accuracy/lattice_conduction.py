#!/usr/bin/python3
"""Writes reference/conduction_arrays.csv: the effective conductivity of cubic arrays of spheres, by Rayleigh's method.

Around a sphere at the origin the temperature is sum_lm (A_lm r^l + B_lm / r^(l + 1)) Y_lm. The sphere gives B_lm from A_lm,
and A_lm is the mean field and what the multipoles B of all other spheres add. Rayleigh, Phil. Mag. 34 (1892) 481; McPhedran,
McKenzie, Proc. R. Soc. A 359 (1978) 45; McKenzie, McPhedran, Derrick, Proc. R. Soc. A 362 (1978) 211. The mean gradient is along
z, a fourfold axis of each array: l is odd and m a multiple of four. Lengths are in edges of the cubic cell.
"""
import csv
import itertools
import math
import pathlib

import numpy as np

REFERENCE = pathlib.Path(__file__).parent / "reference" / "conduction_arrays.csv"
PLACES = {"SC": [(0, 0, 0)], "BCC": [(0, 0, 0), (0.5, 0.5, 0.5)], "FCC": [(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)]}
FRACTIONS = (0.1, 0.2, 0.3, 0.4, 0.5)
ORDERS = (31, 61)   # largest l: the coarser one bounds the error of the finer
REACH = 7           # cells of the sums over the lattice and its reciprocal
SPLIT = 2.0         # 1 / cell edge: where Ewald's method parts the two sums, on which the result does not depend
HEAD = """# Effective conductivity of cubic arrays of spheres over the fluid's, computed by lattice_conduction.py (its docstring has
# the method). insulating: no heat passes the spheres; conducting: a sphere has one temperature. change: of the value from
# poles up to l = 31 instead of 61, relative: a bound of its error. Touching: phi = 0.5236 (SC), 0.6802 (BCC), 0.7405 (FCC).
# Up to phi = 0.2 the series of Sangani, Acrivos, Proc. R. Soc. A 386 (1983) 263 agrees to 2e-6, with 0.2419 for the fourth
# coefficient of FCC, which Andrianov, Topol, arXiv 1106.1783 quote as 0.0420 (tests/accuracy/heat_references.py).
"""


def legendre(n, m, x):
    """Returns sqrt((n - m)! / (n + m)!) P_n^m(x), m >= 0, without the sign (-1)^m."""
    value, before = np.ones_like(x), np.zeros_like(x)
    for k in range(1, m + 1):
        value = value * np.sqrt(1 - x * x) * math.sqrt((2 * k - 1) / (2 * k))
    for k in range(m + 1, n + 1):
        value, before = ((2 * k - 1) * x * value - math.sqrt((k - 1 - m) * (k - 1 + m)) * before) / math.sqrt((k - m) * (k + m)), value
    return value


def harmonics(n, m, points):
    """Returns sqrt((n - m)! / (n + m)!) P_n^m(cos theta) cos(m phi) at points of the shape [:, 3]; the sine cancels in each lattice."""
    r = np.linalg.norm(points, axis=1)
    return legendre(n, m, points[:, 2] / r) * np.cos(m * np.arctan2(points[:, 1], points[:, 0]))


def upper_gamma(n, x):
    """Returns Gamma(n + 1/2, x) / Gamma(n + 1/2)."""
    value, term = np.vectorize(math.erfc)(np.sqrt(x)), 2 * np.sqrt(x / np.pi) * np.exp(-x)
    for k in range(n):
        value, term = value + term, term * x / (k + 1.5)
    return value


class Array:
    """An Array is a cubic lattice with its sums S_nm = sum of Y_nm(R) / R^(n + 1) over all lattice points R but the origin."""

    def __init__(self, name):
        places = PLACES[name]
        cells = np.array(list(itertools.product(range(-REACH, REACH + 1), repeat=3)))
        points = np.concatenate([cells + place for place in places])
        weights = np.exp(2j * np.pi * cells @ np.transpose(places)).sum(axis=1).real  # of the reciprocal points, 0 or the places
        self.volume = 1 / len(places)
        self.points = points[(points**2).sum(axis=1) > 0]
        self.waves = 2 * np.pi * cells[(weights > 0.5) & ((cells**2).sum(axis=1) > 0)]
        self.sums = {}

    def lattice_sum(self, n, m):
        """Returns S_nm, n even, by Ewald's method: Nijboer, de Wette, Physica 23 (1957) 309. S_2m is 0 by symmetry, summed in spheres."""
        m = abs(m)
        if n == 2:
            return 0.0
        if (n, m) not in self.sums:
            r, k = np.linalg.norm(self.points, axis=1), np.linalg.norm(self.waves, axis=1)
            near = (harmonics(n, m, self.points) * upper_gamma(n, (SPLIT * r)**2) / r**(n + 1)).sum()
            scale = np.exp((n - 2) * np.log(k / 2) - (k / (2 * SPLIT))**2 - math.lgamma(n + 0.5))
            far = (-1)**(n // 2) * math.pi**1.5 / self.volume * (harmonics(n, m, self.waves) * scale).sum()
            self.sums[n, m] = near + far
        return self.sums[n, m]

    def conductivity(self, fraction, conducting, order):
        """Returns the effective conductivity over the fluid's, from poles up to l = order."""
        radius = (3 * fraction * self.volume / (4 * math.pi))**(1 / 3)
        poles = [(l, m) for l in range(1, order + 1, 2) for m in range(-(l // 4) * 4, l + 1, 4)]
        matrix = np.eye(len(poles))
        for row, (l, m) in enumerate(poles):
            answer = -1 if conducting else l / (l + 1)  # B_lm = answer a^(2l + 1) A_lm; unknowns are B_lm / a^(l + 1)
            for column, (p, q) in enumerate(poles):
                ways = math.exp(0.5 * (log_choose(l + p - m + q, l - m) + log_choose(l + p + m - q, l + m)))
                matrix[row, column] += answer * ways * radius**(l + p + 1) * self.lattice_sum(l + p, q - m)
        first = poles.index((1, 0))
        right = np.zeros(len(poles))
        right[first] = radius * (-1 if conducting else 0.5)  # of a unit local gradient
        dipole = np.linalg.solve(matrix, right)[first] * radius**2
        gradient = 1 + 4 * math.pi * dipole / (3 * self.volume)  # Lorentz: the mean gradient that goes with it
        return 1 - 4 * math.pi * dipole / (self.volume * gradient)


def log_choose(n, k):
    return math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)


def main():
    rows = []
    for name in PLACES:
        array = Array(name)
        for kind in ("insulating", "conducting"):
            for fraction in FRACTIONS:
                coarse, fine = (array.conductivity(fraction, kind == "conducting", order) for order in ORDERS)
                rows.append([name, kind, fraction, f"{fine:.8f}", f"{max(abs(coarse / fine - 1), 1e-15):.0e}"])
                print(*rows[-1], flush=True)
    with open(REFERENCE, "w") as stream:
        stream.write(HEAD)
        csv.writer(stream, lineterminator="\n").writerows([["array", "spheres", "phi", "conductivity", "change"], *rows])


if __name__ == "__main__":
    main()
