#!/usr/bin/python3
"""Writes reference/sphere_nusselt.csv: drag and heat flow of a sphere in a steady stream without bounds, by finite differences.

Axisymmetric flow in stream function psi and vorticity omega, Newton's method, second order, drawn out from two grids as
Richardson has it. Lengths are in radii, velocities in the stream's. xi = ln r, W = omega r sin(theta), and

    L psi = -r^2 W,   r sin(theta) (psi_theta d/dxi - psi_xi d/dtheta) (W / (r sin(theta))^2) = 2/Re L W,
    L = d^2/dxi^2 - d/dxi + sin(theta) d/dtheta (1/sin(theta) d/dtheta);
    (psi_theta T_xi - psi_xi T_theta) / (r sin(theta)) = 2/Pe (T_xixi + T_xi + 1/sin(theta) d/dtheta (sin(theta) T_theta)).

theta = 0 is downstream. Far out psi less that of the stream does not change with r, as that of Oseen's source; W and T vanish upstream
and do not change downstream.
"""
import csv
import pathlib

import numpy as np

REFERENCE = pathlib.Path(__file__).parent / "reference" / "sphere_nusselt.csv"
REYNOLDS, PRANDTL = (20, 50, 100), (0.7, 7)
STEPS = (5, 20, 35, 50, 65, 80, 90, 100)  # Reynolds numbers on the way: Newton's method begins each with the flow before
GRIDS = ((80, 64), (120, 96))
FAR = 4.0          # ln of the outer radius
STRETCH = 2.0      # the outermost step of xi is e^STRETCH times the innermost
HEAD = """# Drag coefficient and Nusselt number (over the diameter) of a sphere of one temperature in a steady stream without bounds,
# computed by sphere_convection.py (its docstring has the method). change: of the Nusselt number between the finer of two
# grids and what is drawn out of both, relative: a bound of its error.
"""


class Grid:
    """A Grid has nodes in xi (N + 1, the first on the sphere) and theta (M + 1, on the axis at both ends), and matrices of derivatives."""

    def __init__(self, N, M):
        s = np.arange(N + 1) / N
        self.xi = FAR * np.expm1(STRETCH * s) / np.expm1(STRETCH)
        self.r = np.exp(self.xi)
        self.theta = np.linspace(0, np.pi, M + 1)
        self.sine = np.sin(self.theta)
        self.down = self.theta < np.pi / 2
        self.h = np.pi / M
        below, above = np.diff(self.xi)[:-1], np.diff(self.xi)[1:]
        self.first = np.array([-above / below, above / below - below / above, below / above]) / (below + above)  # d/dxi at 1..N-1
        self.second = 2 * np.array([1 / below, -1 / below - 1 / above, 1 / above]) / (below + above)
        self.slope = (np.eye(M + 1, k=1) - np.eye(M + 1, k=-1)) / (2 * self.h)  # d/dtheta between the ends
        self.slope[[0, -1]] = 0  # of what is even about the axis
        half = np.sin(self.theta[:-1] + self.h / 2)
        self.stokes = self.between(1 / half, self.sine)                          # sin d(1/sin d)
        with np.errstate(divide="ignore", invalid="ignore"):
            self.laplace = self.between(half, 1 / self.sine)                     # 1/sin d(sin d)
        for end, inner in ((0, 1), (-1, -2)):
            self.laplace[end] = 0
            self.laplace[end, [end, inner]] = [-4 / self.h**2, 4 / self.h**2]

    def between(self, flux, scale):
        M = len(self.theta) - 1
        matrix = np.zeros((M + 1, M + 1))
        for j in range(1, M):
            matrix[j, j - 1:j + 2] = scale[j] / self.h**2 * np.array([flux[j - 1], -flux[j - 1] - flux[j], flux[j]])
        return matrix


def solve_blocks(lower, middle, upper, right):
    """Solves a block tridiagonal system; right: [block, row]."""
    gains, values = [], []
    for i in range(len(middle)):
        block, known = middle[i], right[i]
        if i:
            block, known = block - lower[i] @ gains[-1], known - lower[i] @ values[-1]
        solved = np.linalg.solve(block, np.column_stack([upper[i], known]))
        gains.append(solved[:, :-1])
        values.append(solved[:, -1])
    for i in range(len(middle) - 2, -1, -1):
        values[i] = values[i] - gains[i] @ values[i + 1]
    return np.array(values)


class Flow:
    """A Flow is the steady flow at a Reynolds number; start: a Flow on the same grid to begin with."""

    def __init__(self, grid, reynolds, start=None):
        self.grid, self.reynolds = grid, reynolds
        shape = (len(grid.xi), len(grid.theta))
        self.stream = 0.5 * np.outer(grid.r**2, grid.sine**2)
        self.stream_xi, self.stream_theta = 2 * self.stream, np.outer(grid.r**2, grid.sine * np.cos(grid.theta))
        self.phi = start.phi if start else -self.stream * np.exp(-2 * grid.xi)[:, None]  # psi less the stream's
        self.W = start.W if start else np.zeros(shape)
        inner = slice(1, -1)
        G = np.eye(shape[1])[:, inner] / grid.sine[inner]**2  # W to W / sin^2, the axis from its neighbours: it is even
        G[0] = (4 * G[1] - G[2]) / 3
        G[-1] = (4 * G[-2] - G[-3]) / 3
        self.G, self.G_theta = G[inner], (grid.slope @ G)[inner]
        for _ in range(30):
            change = self.improve()
            if change < 1e-9:
                return
        raise ArithmeticError(f"no steady flow at Re = {reynolds}: change {change}")

    def improve(self):
        """Takes a step of Newton's method; returns the largest change of W."""
        g, m = self.grid, len(self.grid.theta) - 2
        N = len(g.xi) - 1
        S, D, eye, inner = g.stokes[1:-1, 1:-1], g.slope[1:-1, 1:-1], np.eye(m), slice(1, -1)
        lower, upper = np.zeros((N + 1, 2 * m, 2 * m)), np.zeros((N + 1, 2 * m, 2 * m))
        middle, right = np.zeros((N + 1, 2 * m, 2 * m)), np.zeros((N + 1, 2 * m))
        P, Q = slice(0, m), slice(m, 2 * m)
        phi, W = self.phi[:, inner], self.W[:, inner]
        # On the sphere: psi = 0, and W from psi_xi = 0.
        middle[0, P, P] = eye
        right[0, P] = -self.stream[0, inner] - phi[0]
        wall = self.stream[0, inner] + phi[0]
        step = g.xi[1]
        curve = 2 / step**2  # psi_xixi of psi even about the wall
        middle[0, Q, Q], upper[0, Q, P] = eye, curve * eye
        right[0, Q] = -(W[0] + curve * (self.stream[1, inner] + phi[1] - wall))
        # Far out.
        middle[N, P, P], lower[N, P, P] = eye, -eye
        right[N, P] = phi[N - 1] - phi[N]
        middle[N, Q, Q], lower[N, Q, Q] = eye, -np.diag(g.down[inner].astype(float))
        right[N, Q] = g.down[inner] * W[N - 1] - W[N]
        for i in range(1, N):
            first, second = g.first[:, i - 1], g.second[:, i - 1]
            line, r2 = second - first, g.r[i]**2
            middle[i, P, P], middle[i, P, Q] = line[1] * eye + S, r2 * eye
            lower[i, P, P], upper[i, P, P] = line[0] * eye, line[2] * eye
            right[i, P] = -(line @ phi[i - 1:i + 2] + S @ phi[i] + r2 * W[i])
            weight = g.r[i] * g.sine[inner]
            along = self.stream_theta[i, inner] + D @ phi[i]
            across = self.stream_xi[i, inner] + first @ phi[i - 1:i + 2]
            H = W[i - 1:i + 2] / g.r[i - 1:i + 2, None]**2
            H_xi, H_theta = first @ (H @ self.G.T), self.G_theta @ H[1]
            fade = 2 / self.reynolds
            for block, n in ((lower, 0), (middle, 1), (upper, 2)):
                block[i, Q, Q] = (weight * along)[:, None] * self.G * (first[n] / g.r[i - 1 + n]**2) - fade * line[n] * eye
                block[i, Q, P] -= np.diag(weight * first[n] * H_theta)
            middle[i, Q, Q] -= (weight * across)[:, None] * self.G_theta / r2 + fade * S
            middle[i, Q, P] += (weight * H_xi)[:, None] * D
            right[i, Q] = -(weight * (along * H_xi - across * H_theta) - fade * (line @ W[i - 1:i + 2] + S @ W[i]))
        change = solve_blocks(lower, middle, upper, right)
        self.phi, self.W = self.phi.copy(), self.W.copy()
        self.phi[:, inner] += change[:, P]
        self.W[:, inner] += change[:, Q]
        return abs(change[:, Q]).max()

    def drag(self):
        """Returns the drag coefficient, of friction and of pressure, both from the vorticity on the sphere."""
        g = self.grid
        omega = np.zeros((3, len(g.theta)))
        omega[:, 1:-1] = self.W[:3, 1:-1] / np.outer(g.r[:3], g.sine[1:-1])
        slope = one_sided(g.xi) @ omega
        friction = 8 / self.reynolds * np.trapz(omega[0] * g.sine**2, g.theta)
        pressure = -4 / self.reynolds * np.trapz((slope + omega[0]) * g.sine**2, g.theta)
        return -(friction + pressure)  # W is negative

    def nusselt(self, prandtl):
        g = self.grid
        N, M = len(g.xi) - 1, len(g.theta) - 1
        lower, upper = np.zeros((N + 1, M + 1, M + 1)), np.zeros((N + 1, M + 1, M + 1))
        middle, right = np.zeros((N + 1, M + 1, M + 1)), np.zeros((N + 1, M + 1))
        eye = np.eye(M + 1)
        middle[0], right[0] = eye, 1
        middle[N], lower[N] = eye, -np.diag(g.down.astype(float))
        psi = self.stream + self.phi
        for i in range(1, N):
            first, second = g.first[:, i - 1], g.second[:, i - 1]
            along, across = np.zeros(M + 1), np.zeros(M + 1)
            along[1:-1] = (self.stream_theta[i] + g.slope @ self.phi[i])[1:-1] / (g.r[i] * g.sine[1:-1])
            across[1:-1] = (self.stream_xi[i] + first @ self.phi[i - 1:i + 2])[1:-1] / (g.r[i] * g.sine[1:-1])
            along[[0, -1]] = 2 * psi[i, [1, -2]] / (g.r[i] * g.h**2) * np.array([1, -1])
            fade = 2 / (self.reynolds * prandtl)
            line = second + first
            lower[i], upper[i] = (np.diag(along * first[n] - fade * line[n]) for n in (0, 2))
            middle[i] = np.diag(along * first[1] - fade * line[1]) - across[:, None] * g.slope - fade * g.laplace
        T = solve_blocks(lower, middle, upper, right)
        return np.trapz(-(one_sided(g.xi) @ T[:3]) * g.sine, g.theta)  # 2 radii times the mean over the sphere


def one_sided(x):
    """Returns the weights of the derivative at x[0] from values at x[0..2]."""
    a, b = x[1] - x[0], x[2] - x[0]
    return np.array([-(a + b) / (a * b), b / (a * (b - a)), -a / (b * (b - a))])


def flows(grid):
    """Returns the flow at each Reynolds number, each beginning with the one before."""
    found, start = {}, None
    for reynolds in STEPS:
        start = found[reynolds] = Flow(grid, reynolds, start)
    return found


def main():
    coarse, fine = (flows(Grid(*shape)) for shape in GRIDS)
    drawn_out = lambda a, b: b + (b - a) / ((GRIDS[1][0] / GRIDS[0][0])**2 - 1)  # noqa: E731
    rows = []
    for reynolds in REYNOLDS:
        drag = drawn_out(coarse[reynolds].drag(), fine[reynolds].drag())
        for prandtl in PRANDTL:
            a, b = (flow[reynolds].nusselt(prandtl) for flow in (coarse, fine))
            nusselt = drawn_out(a, b)
            rows.append([reynolds, prandtl, f"{drag:.4f}", f"{nusselt:.4f}", f"{abs(b / nusselt - 1):.0e}"])
            print(*rows[-1], flush=True)
    with open(REFERENCE, "w") as stream:
        stream.write(HEAD)
        csv.writer(stream, lineterminator="\n").writerows([["Re", "Pr", "C_D", "Nu", "change"], *rows])


if __name__ == "__main__":
    main()
