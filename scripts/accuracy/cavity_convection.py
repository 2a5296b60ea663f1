#!/usr/bin/python3
"""Writes reference/heated_cavity.csv: natural convection in a square cavity, Pr = 0.71, by a spectral method.

The side at x = 0 has temperature 1, that at x = 1 has 0, floor and ceiling are insulated. Chebyshev collocation and Newton's
method for the stream function psi (u = psi_y, v = -psi_x, in thermal diffusivity over edge) and T:

    laplace^2 psi - u . grad(laplace psi) / Pr = Ra T_x,   u . grad T = laplace T

psi = (1 - x^2) q along each axis has both boundary conditions: Trefethen, Spectral Methods in MATLAB (2000), program 38.
"""
import csv
import pathlib

import numpy as np

REFERENCE = pathlib.Path(__file__).parent / "reference" / "heated_cavity.csv"
PRANDTL, RAYLEIGH = 0.71, (10**4, 10**5, 10**6)
ORDERS = (28, 36)  # even: the middle is a node
DE_VAHL_DAVIS = {10**4: (2.243, 16.178, 0.823, 19.617, 0.119), 10**5: (4.519, 34.73, 0.855, 68.59, 0.066),
                 10**6: (8.800, 64.63, 0.850, 219.36, 0.0379)}
COLUMNS = ("Nu", "u_max", "y", "v_max", "x")
HEAD = """# Natural convection of air (Pr = 0.71) in a square cavity: Nusselt number of the hot side, and the largest velocities, over the
# thermal diffusivity by the edge: u_max across, on the line up through the middle, at y; v_max up, on the line across, at x.
# de Vahl Davis: Int. J. Numer. Methods Fluids 3 (1983) 249; he gives his errors as 0.2, 0.3 and 1 % at Ra = 1e4, 1e5 and 1e6.
# spectral: computed by cavity_convection.py. change: of its Nusselt number from the lower of two orders, relative.
"""


def chebyshev(N):
    """Returns (nodes from -1 to 1, matrix of the derivative)."""
    x = -np.cos(np.pi * np.arange(N + 1) / N)
    c = np.array([2, *np.ones(N - 1), 2]) * (-1)**np.arange(N + 1)
    D = np.outer(c, 1 / c) / (x[:, None] - x + np.eye(N + 1))
    return x, D - np.diag(D.sum(axis=1))


class Cavity:
    """A Cavity is the spectral method of an order. Fields are [x][y]."""

    def __init__(self, N):
        x, D = chebyshev(N)
        self.N, self.x = N, (x + 1) / 2
        D2 = D @ D
        inner, s = x[1:-1], np.diag(1 / (1 - x[1:-1]**2))
        row = lambda *terms: sum(np.diag(f) @ M[1:-1, 1:-1] for f, M in terms) @ s  # noqa: E731
        b, one = 1 - inner**2, np.ones(N - 1)
        E = np.eye(N + 1)
        self.D, self.D2 = 2 * D, 4 * D2
        self.clamped = [E[1:-1, 1:-1], 2 * row((b, D), (-2 * inner, E)), 4 * row((b, D2), (-4 * inner, D), (-2 * one, E)),
                        8 * row((b, D2 @ D), (-6 * inner, D2), (-6 * one, D)), 16 * row((b, D2 @ D2), (-8 * inner, D2 @ D), (-12 * one, D2))]
        C, I = self.clamped, np.eye(N + 1)
        self.px, self.py = np.kron(C[1], C[0]), np.kron(C[0], C[1])
        self.lx, self.ly = np.kron(C[3], C[0]) + np.kron(C[1], C[2]), np.kron(C[0], C[3]) + np.kron(C[2], C[1])  # of laplace psi
        self.l2 = np.kron(C[4], C[0]) + np.kron(C[0], C[4]) + 2 * np.kron(C[2], C[2])
        self.tx, self.ty = np.kron(self.D, I), np.kron(I, self.D)
        self.lt = np.kron(self.D2, I) + np.kron(I, self.D2)
        inside = np.zeros((N + 1, N + 1), bool)
        inside[1:-1, 1:-1] = True
        self.inside = inside.ravel()
        self.psi, self.T = np.zeros((N - 1)**2), np.repeat(1 - self.x, N + 1)

    def solve(self, rayleigh):
        for _ in range(20):
            if self.improve(rayleigh) < 1e-9:
                return
        raise ArithmeticError(f"no steady flow at Ra = {rayleigh}")

    def improve(self, rayleigh):
        """Takes a step of Newton's method; returns the largest change of T."""
        inside, m = self.inside, len(self.psi)
        u, v = self.py @ self.psi, -self.px @ self.psi
        wx, wy = self.lx @ self.psi, self.ly @ self.psi
        scale = lambda f, M: f[:, None] * M  # noqa: E731
        flow = self.l2 @ self.psi - (u * wx + v * wy) / PRANDTL - rayleigh * (self.tx @ self.T)[inside]
        flow_psi = self.l2 - (scale(u, self.lx) + scale(v, self.ly) + scale(wx, self.py) - scale(wy, self.px)) / PRANDTL
        flow_T = -rayleigh * self.tx[inside]
        heat, heat_T, heat_psi = -self.lt @ self.T, -self.lt.copy(), np.zeros((len(self.T), m))
        Tx, Ty = (self.tx @ self.T)[inside], (self.ty @ self.T)[inside]
        heat[inside] += u * Tx + v * Ty
        heat_T[inside] += scale(u, self.tx[inside]) + scale(v, self.ty[inside])
        heat_psi[inside] = scale(Tx, self.py) - scale(Ty, self.px)
        N = self.N
        for i in range(N + 1):
            for j in range(N + 1):
                n = i * (N + 1) + j
                if i in (0, N):
                    heat[n], heat_T[n] = self.T[n] - (i == 0), np.eye(1, len(self.T), n)
                elif j in (0, N):
                    heat[n], heat_T[n] = self.ty[n] @ self.T, self.ty[n]
        change = np.linalg.solve(np.block([[flow_psi, flow_T], [heat_psi, heat_T]]), -np.concatenate([flow, heat]))
        self.psi, self.T = self.psi + change[:m], self.T + change[m:]
        return abs(change[m:]).max()

    def found(self):
        """Returns the quantities in the order of COLUMNS."""
        N = self.N
        slope = self.fit(-(self.D @ self.T.reshape(N + 1, -1))[0])
        nusselt = slope.integ()(1) - slope.integ()(-1)
        middle = N // 2 - 1
        u, v = ((f @ self.psi).reshape(N - 1, -1) for f in (self.py, -self.px))
        fine = np.linspace(-1, 1, 200001)
        lines = [self.fit(np.concatenate([[0], line, [0]]))(fine) for line in (u[middle], v[:, middle])]
        (y, u_max), (x, v_max) = (((fine[np.argmax(line)] + 1) / 2, line.max()) for line in lines)
        return nusselt / 2, u_max, y, v_max, x

    def fit(self, values):
        return np.polynomial.Chebyshev.fit(2 * self.x - 1, values, self.N)


def main():
    cavities = [Cavity(N) for N in ORDERS]
    rows = []
    for rayleigh in RAYLEIGH:
        for cavity in cavities:
            cavity.solve(rayleigh)
        coarse, fine = (cavity.found() for cavity in cavities)
        rows.append([rayleigh, "de Vahl Davis", *DE_VAHL_DAVIS[rayleigh], ""])
        rows.append([rayleigh, "spectral", *(f"{value:.6g}" for value in fine), f"{abs(coarse[0] / fine[0] - 1):.0e}"])
        print(*rows[-1], *coarse, flush=True)
    with open(REFERENCE, "w") as stream:
        stream.write(HEAD)
        csv.writer(stream, lineterminator="\n").writerows([["Ra", "source", *COLUMNS, "change"], *rows])


if __name__ == "__main__":
    main()
