#!/usr/bin/python3
"""The treatment of the edges of bodies, piece by piece: drag and torque of the bodies of cube.py on a lattice of its own.

edge_links.py [--only TEXT] [--cells N] [--places N] [--lip B] [--open] [--scheme multireflection|cli]

The lattice is that of docs/method.md without inertia, the walls (19) or (13) with g = 0. Two things can be tried:

    crossing links    between fluid cells on the two sides of an edge, whose straight line passes through the body, are cut at both ends
    a lip             the surface is moved outwards by B (1 - |2 s - 1|) cells where it is s < 1 cells from the nearest edge; the
                      wall distance stays above 0.01

--open leaves both out. Prints for each setup of cube.py the mean error in percent, the least and the largest, over random places.
"""
import argparse

import numpy as np

import cube
import stokes_scene as scene

C = np.array([c for c in np.ndindex(3, 3, 3) if 0 < sum(x != 1 for x in c) < 3]) - 1
C = np.concatenate([[[0, 0, 0]], C])
W = np.array([1 / 3] + [1 / 18 if abs(c).sum() == 1 else 1 / 36 for c in C[1:]])
OPPOSITE = np.array([int(np.flatnonzero((C == -c).all(1))[0]) for c in C])
MAGIC = {"multireflection": 2 / 15, "cli": 1 / 6}
EVEN = scene.RELAXATION_TIME - 0.5
LEAST = 0.01                                     # wall distance under a lip


class Geometry:
    """A Geometry is a cube or a cylinder in its own frame."""

    def __init__(self, body, size):
        self.round, self.half = body == "cylinder", size / 2

    def inside(self, o, d):
        """Returns where lines o + t d enter and leave."""
        with np.errstate(divide="ignore", invalid="ignore"):
            low, high = (-self.half - o) / d, (self.half - o) / d
            enter, leave = np.minimum(low, high), np.maximum(low, high)
            flat = d == 0
            enter[flat] = np.where(np.abs(o[flat]) <= self.half, -np.inf, np.inf)
            leave[flat] = -enter[flat]
            if self.round:
                a, b = (d[:, :2]**2).sum(1), (o[:, :2] * d[:, :2]).sum(1)
                c = (o[:, :2]**2).sum(1) - self.half**2
                root = np.sqrt(b * b - a * c)    # not a number: the line misses
                first, last = np.where(a > 0, (-b - root) / a, np.where(c <= 0, -np.inf, np.inf)), np.where(
                    a > 0, (root - b) / a, np.where(c <= 0, np.inf, -np.inf))
                first, last = np.where(np.isnan(first), np.inf, first), np.where(np.isnan(last), -np.inf, last)
                enter, leave = np.stack([first, enter[:, 2]], 1), np.stack([last, leave[:, 2]], 1)
        return enter.max(1), leave.min(1)

    def near_edge(self, x, d):
        """Returns, of points on the surface, the distance to the nearest edge along it, and |d.n|, n its normal."""
        if not self.round:
            depth = np.sort(self.half - np.abs(x), axis=1)
            face = np.argmax(np.abs(x), axis=1)
            return depth[:, 1], np.abs(d[np.arange(len(d)), face])
        radius = np.linalg.norm(x[:, :2], axis=1)
        end, side = self.half - np.abs(x[:, 2]), self.half - radius
        cap = end < side
        return np.where(cap, side, end), np.where(cap, np.abs(d[:, 2]), np.abs((x[:, :2] * d[:, :2]).sum(1)) / radius)


class Lattice:
    """A Lattice is the periodic box with the body at a place."""

    def __init__(self, setup, cells, offset, options):
        body, oriented, self.flow = cube.parts(setup)
        self.setup, self.cells, self.size = setup, cells, cells / cube.BOX[body]
        self.radius, self.magic = cube.radius(body) * self.size, MAGIC[options.scheme]
        shape, rotation = Geometry(body, self.size), scene.rotation_about(*cube.TURN[oriented])
        index = np.stack(np.meshgrid(*[np.arange(cells)] * 3, indexing="ij"), -1).reshape(-1, 3)
        self.arm = index + 0.5 - (cells // 2 + np.array(offset))
        enter, leave = shape.inside(self.arm @ rotation, np.zeros((len(index), 3)))
        self.solid = enter < leave
        links = []
        for i in range(1, 19):
            x = np.flatnonzero(~self.solid)
            o, d = self.arm[x] @ rotation, np.broadcast_to(C[i] @ rotation, (len(x), 3))
            enter, leave = shape.inside(o, d)
            cut = self.solid[self.at(x, 1, i)]
            cut |= (not options.open) & (enter < leave) & (enter >= 0) & (leave <= 1)
            q, o, d = enter[cut], o[cut], d[cut]
            if not options.open:
                s, slope = shape.near_edge(o + q[:, None] * d, d)
                q = q - options.lip * np.maximum(1 - np.abs(2 * s - 1), 0) / np.maximum(slope, 0.3)
            links.append((x[cut], np.full(cut.sum(), i), np.clip(q, LEAST, 1)))
        self.x, self.i, self.q = (np.concatenate(parts) for parts in zip(*links))
        self.scheme = options.scheme

    def at(self, x, steps, i):
        """Returns the cells so many links along i from cells x."""
        n = self.cells
        xyz = np.stack(np.unravel_index(x, (n,) * 3), -1) + steps * C[i]
        return np.ravel_multi_index(tuple((xyz % n).T), (n,) * 3)

    def coefficients(self):
        q, ratio = self.q, self.magic / EVEN
        if self.scheme == "cli":
            s = 1 / (0.5 + q)
            return (q + 0.5) * s, 1 - 2 * q * s, (q - 0.5) * s, 0 * q, 0 * q
        m = 1 / (1 + q)**2
        r = m * (1 - 2 * q - 2 * q * q)
        return 1 + 0 * q, r + 2 * m * ratio, -r + 2 * m * ratio, -m * q * q - 2 * m * ratio, m * q * q - 2 * m * ratio

    def run(self):
        """Returns K of the drag, or the factor of the torque."""
        n, x, i, flow = self.cells, self.x, self.i, self.flow
        back, fluid = OPPOSITE[i], ~self.solid
        behind, beyond = self.at(x, -1, i), self.at(x, -2, i)
        a, b, c, d, g = self.coefficients()
        k = 6 * W[i] * (1 - c - d)
        driven = (k - 6 * W[i] * (a - c - 2 * d - g)) / 2 * C[i, 0]
        turning = np.cross([1.0, 0, 0], self.arm[x]) if flow == "torque" else np.zeros((len(x), 3))
        moving = k * (turning * C[i]).sum(1)
        even, odd = 1 / (EVEN + 0.5), 1 / (self.magic / EVEN + 0.5)
        lever = np.cross(self.arm[x], C[i])[:, 0]
        f = 3 * W[:, None] * C[:, :1] * fluid * (1.0 if flow == "drag" else 0)
        push = 0.0
        for _ in range(round((11 if flow == "drag" else 9) * n**2 / (4 * np.pi**2 * scene.VISCOSITY))):
            rho, u = f.sum(0) * fluid, (C.T @ f + np.array([[push / 2], [0], [0]])) * fluid
            mirrored = f[OPPOSITE]
            out = f - even * ((f + mirrored) / 2 - W[:, None] * rho) - odd * ((f - mirrored) / 2 - 3 * W[:, None] * (C @ u)) \
                + (1 - odd / 2) * 3 * W[:, None] * C[:, :1] * push
            returned = a * out[i, x] + b * out[i, behind] + c * out[back, x] + d * out[back, behind] + g * out[i, beyond] \
                - moving + driven * push
            exchanged = out[i, x] + returned
            grid = out.reshape(19, n, n, n)
            f = np.stack([np.roll(grid[j], C[j], (0, 1, 2)) for j in range(19)]).reshape(19, -1)
            f[back, x] = returned
            force = (C[i, 0] * exchanged).sum()
            if flow == "drag":
                push = force / fluid.sum()       # keeps the momentum of the fluid
        if flow == "torque":
            return -(lever * exchanged).sum() / (8 * np.pi * scene.VISCOSITY * self.radius**3)
        volume = 4 / 3 * np.pi * self.radius**3
        return (force + push * volume) / (6 * np.pi * scene.VISCOSITY * self.radius * u[0].sum() / n**3)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", metavar="TEXT", default="", help="setups with TEXT in their names")
    parser.add_argument("--cells", type=int, default=24, help="of the box (24)")
    parser.add_argument("--places", type=int, default=8)
    parser.add_argument("--lip", type=float, default=0.22, help="cells (0.22)")
    parser.add_argument("--open", action="store_true")
    parser.add_argument("--scheme", choices=MAGIC, default="multireflection")
    options = parser.parse_args()
    for setup in (name for name in cube.SETUPS if options.only in name):
        exact = scene.references("cube")[setup][cube.QUANTITY[cube.parts(setup)[2]]]
        errors = [scene.percent(Lattice(setup, options.cells, offset, options).run(), exact)
                  for offset in scene.offsets(options.places)]
        print(f"{setup:24s} {np.mean(errors):6.2f}  ({min(errors):.2f}, {max(errors):.2f})", flush=True)


if __name__ == "__main__":
    main()
