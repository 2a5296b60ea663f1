#!/usr/bin/python3
"""The reference solution of the Stokes problems against independent results."""
import csv
import math
import pathlib
import sys
import tomllib
import unittest

ACCURACY = pathlib.Path(__file__).resolve().parent.parent.parent / "scripts" / "accuracy"
sys.path[:0] = [str(ACCURACY), str(ACCURACY.parent)]

import numpy as np  # noqa: E402

import drag_laws  # noqa: E402
import random_array  # noqa: E402
import stokes_scene  # noqa: E402
from stokes_periodic import (Channel, Mirrors, PeriodicBox, ellipsoid_points, rotation_about, solve,  # noqa: E402
                             sphere_points, spheroid_points, torus_points, uniform)

HASIMOTO = 2.837297  # mobility of a point force in a cube of edge L: 1 / (6 pi a) - HASIMOTO / (6 pi L)
ORIGIN = np.zeros(3)


def rows(name):
    with open(ACCURACY / "reference" / name) as stream:
        return list(csv.DictReader(line for line in stream if not line.startswith("#")))


def unbounded(factor, bodies, edge, volume):
    """The factor in unbounded fluid from that in a large cube: Hasimoto's correction, to order (a / L)^3."""
    return 1 / (1 / factor + bodies * (HASIMOTO / edge - volume / edge**3))


class Periodic(unittest.TestCase):
    def test_ewald_split_does_not_matter(self):
        points = np.random.default_rng(1).random((20, 3)) * (2, 3, 4)
        one, other = (PeriodicBox((2, 3, 4), split).velocities(points[:10], points[10:]) for split in (1.4, 2.1))
        np.testing.assert_allclose(one, other, atol=1e-9)

    def test_mean_velocity_is_zero(self):
        box, n = PeriodicBox((2, 2, 3)), 12
        grid = (np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3) + 0.5) / n * (2, 2, 3)
        inside = np.array([[1.0, 1.0, 1.5]])
        values = box.velocities(grid, inside).mean(0)
        # The midpoint rule has the singularity's error, h^2 times a constant.
        self.assertLess(np.abs(values).max(), 0.02 * np.abs(box.velocities(grid, inside)).max())

    def test_simple_cubic_arrays(self):
        exact = {float(r["phi"]): float(r["K_computed"]) for r in rows("01_periodic_arrays_stokes.csv") if r["lattice"] == "SC"}
        for phi in (0.01, 0.064, 0.2):
            edge = (4 * math.pi / 3 / phi)**(1 / 3)
            flow, = solve(PeriodicBox((edge,) * 3), [sphere_points(ORIGIN, 1, 320)], [uniform((1, 0, 0))],
                          Mirrors(ORIGIN, (-1, 1, 1)))
            self.assertAlmostEqual(flow.force(0)[0] / (6 * math.pi) / exact[phi], 1, delta=1e-4)

    def test_two_spheres_of_stimson_and_jeffery(self):
        exact = {float(r["r_over_2a"]): float(r["lambda_par"]) for r in rows("04_two_sphere_stokes.csv")}
        for half in (1.1, 1.5):
            body = sphere_points((half, 0, 0), 1, 300, 0.76 if half < 1.2 else 0.6)
            flow, = solve(PeriodicBox((80,) * 3), [body], [uniform((1, 0, 0))], Mirrors(ORIGIN, (-1, 1, 1)))
            found = unbounded(flow.force(0)[0] / (12 * math.pi), 2, 80, 4 * math.pi / 3)
            self.assertAlmostEqual(found / exact[half], 1, delta=2e-4)

    def test_spheroids_of_oberbeck(self):
        table = tomllib.loads((ACCURACY / "reference" / "07_nonspherical_drag.toml").read_text())["spheroid"]
        for aspect in (0.5, 3):
            polar, equatorial = aspect**(2 / 3), aspect**(-1 / 3)
            for name, direction in (("K_par", 2), ("K_perp", 0)):
                body = spheroid_points(ORIGIN, polar, equatorial, np.eye(3), 450, 0.55)
                flow, = solve(PeriodicBox((30,) * 3), [body], [uniform(np.eye(3)[direction])],
                              Mirrors(ORIGIN, tuple(-1 if d == direction else 1 for d in range(3))))
                found = unbounded(flow.force(0)[direction] / (6 * math.pi), 1, 30, 4 * math.pi / 3)
                self.assertAlmostEqual(found / table[name][table["r"].index(aspect)], 1, delta=1e-3)

    def test_torus_of_johnson_and_wu(self):
        """Broadside, of a thin torus; the next term is of the order of the square of the tube's radius, over
        the ring's."""
        ring, edge = 8, 64
        flow, = solve(PeriodicBox((edge,) * 3), [torus_points(ORIGIN, ring, 1, np.eye(3), 700)], [uniform((0, 0, 1))],
                      Mirrors(ORIGIN, (1, 1, -1)))
        found = 1 / (1 / flow.force(0)[2] + HASIMOTO / (6 * math.pi * edge))
        self.assertAlmostEqual(found / (8 * math.pi**2 * ring / (math.log(8 * ring) + 0.5)), 1, delta=6e-3)

    def test_turning_ellipsoid_of_jeffery(self):
        """16 pi (a^2 + b^2) / (3 (a^2 alpha + b^2 beta)) about the third axis; what the images add falls with
        the box's volume."""
        axes = np.array([1.0, 0.25, 0.5])
        s = np.tan((np.arange(20000) + 0.5) / 20000 * np.pi / 2)          # of lambda: the integral by the midpoint rule
        weight = 2 * s * (1 + s**2) * np.pi / 2 / 20000 / np.sqrt(((axes**2)[:, None] + s**2).prod(0))
        alpha, beta, _ = (weight / ((axes**2)[:, None] + s**2)).sum(1)
        exact = 16 * math.pi * (axes[0]**2 + axes[1]**2) / (3 * (axes[0]**2 * alpha + axes[1]**2 * beta))
        torque = {}
        for edge in (6, 8):
            flow, = solve(PeriodicBox((edge,) * 3), [ellipsoid_points(ORIGIN, axes, np.eye(3), 350, 0.55)],
                          [rotation_about(ORIGIN, (0, 0, 1))], Mirrors(ORIGIN, (-1, -1, 1)))
            torque[edge] = flow.torque(0, ORIGIN)[2]
        far = (8**3 * torque[8] - 6**3 * torque[6]) / (8**3 - 6**3)
        self.assertAlmostEqual(far / exact, 1, delta=2e-3)

    def test_torque_on_a_turning_sphere(self):
        for edge in (10, 20):
            flow, = solve(PeriodicBox((edge,) * 3), [sphere_points(ORIGIN, 1, 120, 0.6)], [rotation_about(ORIGIN, (0, 0, 1))])
            found = flow.torque(0, ORIGIN)[2] / (8 * math.pi)
            self.assertAlmostEqual(found, 1 / (1 - 4 * math.pi / 3 / edge**3), delta=1e-4)


class Cases(unittest.TestCase):
    def test_ring_that_sinks(self):
        """The torus has the resistance that cases/torus is compared with."""
        folder = ACCURACY.parent.parent / "cases" / "torus"
        case = tomllib.loads((folder / "case.toml").read_text())
        reference = {q["name"]: q["value"] for q in tomllib.loads((folder / "reference.toml").read_text())["quantity"]}
        edge, tube, ring = case["domain"]["size"][0], 4, 12
        turn = case["bodies"][0]["orientation"]
        body = torus_points(ORIGIN, ring, tube, stokes_scene.rotation_about(turn["axis"], turn["degrees"]), 500)
        flows = solve(PeriodicBox((edge,) * 3), [body], [uniform((1, 0, 0)), uniform((0, 0, 1))], Mirrors(ORIGIN, (0, 1, 0)))
        resistance = np.stack([flow.force(0)[[0, 2]] for flow in flows], -1) * (case["fluid"]["relaxation_time"] - 0.5) / 3
        fluid = edge**3 - 2 * math.pi**2 * ring * tube**2
        force = case["fluid"]["body_force"][2]
        weight = (case["bodies"][0]["density"] - 1) * (edge**3 - fluid) * -case["gravity"]["acceleration"][2]
        self.assertAlmostEqual(weight / (force * fluid), 1, delta=2e-3)
        aside, up = np.linalg.solve(resistance, (0, force * edge**3))   # of the box, seen from the ring
        self.assertAlmostEqual(up / reference["sinking_velocity"], 1, delta=2e-3)
        self.assertAlmostEqual(aside / reference["gliding_velocity"], 1, delta=2e-2)


class BetweenPlates(unittest.TestCase):
    def test_no_slip_and_reciprocity(self):
        box, generator = Channel((4, 5), 3, 0.5), np.random.default_rng(2)
        a, b = generator.random((10, 3)) * (4, 5, 2.4) + (0, 0, 0.3), generator.random((10, 3)) * (4, 5, 2.4) + (0, 0, 0.3)
        plates = np.concatenate([a * (1, 1, 0), b * (1, 1, 0) + (0, 0, 3)])
        self.assertLess(np.abs(box.velocities(plates, a)).max(), 1e-5)
        np.testing.assert_allclose(box.velocities(a, b), box.velocities(b, a).transpose(2, 3, 0, 1), atol=1e-9)

    def test_sphere_at_a_wall_of_goldman_cox_and_brenner(self):
        """The sides and the other plate change the factors by (a / L)^3 and smaller terms."""
        h = 1.5430806
        exact = next(r for r in rows("04_sphere_wall_stokes.csv") if float(r["h_over_a"]) == h)
        found = {}
        for edge in (12, 16):
            centre = np.array([0, 0, h])
            moving, turning = solve(Channel((edge, edge), edge, 2 * h - 1.65), [sphere_points(centre, 1, 160)],
                                    [uniform((1, 0, 0)), rotation_about(centre, (0, 1, 0))], Mirrors(centre, (-1, 1, 0)))
            found[edge] = np.array([moving.force(0)[0] / (6 * math.pi), turning.torque(0, centre)[1] / (8 * math.pi)])
            # Lorentz' reciprocal theorem, exact in any box
            self.assertAlmostEqual(moving.torque(0, centre)[1], turning.force(0)[0], delta=0.05)
        far = (16**3 * found[16] - 12**3 * found[12]) / (16**3 - 12**3)
        np.testing.assert_allclose(far, [float(exact["F_t"]), float(exact["T_r"])], rtol=4e-3)


class Scenes(unittest.TestCase):
    def test_laws_of_random_arrays(self):
        table = tomllib.loads((ACCURACY / "reference" / "02_random_array_drag.toml").read_text())["sample_values_F_d"]
        for Re, phi, hill, beetstra, _, tenneti in table["rows"]:
            found = [law(phi, Re) * (1 - phi) for law in drag_laws.LAWS]
            np.testing.assert_allclose(found, [hill, beetstra, tenneti], atol=1e-3)

    def test_spheres_of_an_array_do_not_overlap(self):
        for phi in random_array.FRACTIONS:
            x, edge = random_array.array(phi, 0), random_array.edge(phi)
            distance = random_array.apart(x[:, None] - x[None], edge)[1] + 9 * np.eye(len(x))
            self.assertGreaterEqual(distance.min(), 2 + random_array.LEAST_GAP)
            self.assertAlmostEqual(len(x) * 4 / 3 * math.pi / edge**3, phi)

    def test_places_fill_the_cell(self):
        for column in zip(*stokes_scene.offsets(4)):
            self.assertEqual(sorted(int(4 * x) for x in column), [0, 1, 2, 3])


if __name__ == "__main__":
    unittest.main()
