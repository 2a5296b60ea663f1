#!/usr/bin/python3
"""The boundary elements of bodies with edges against independent results."""
import math
import pathlib
import sys
import unittest

ACCURACY = pathlib.Path(__file__).resolve().parent.parent.parent / "scripts" / "accuracy"
sys.path[:0] = [str(ACCURACY), str(ACCURACY.parent)]

import numpy as np  # noqa: E402

import stokes_scene  # noqa: E402
from stokes_panels import FLIPS, Body, cube_panels, cylinder_panels, potentials  # noqa: E402
from stokes_periodic import PeriodicBox  # noqa: E402

HASIMOTO = 2.837297  # mobility of a point force in a cube of edge L: 1 / (6 pi a) - HASIMOTO / (6 pi L)


class Panels(unittest.TestCase):
    def test_potentials_are_those_of_many_points(self):
        panel = np.array([[0.1, 0.2, 0.3], [1.1, 0.4, 0.3], [0.9, 1.3, 0.3], [0.2, 0.9, 0.3]])
        turn = stokes_scene.rotation_about((1, 2, 3), 40)
        n = 200
        u, v = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(n) + 0.5) / n, indexing="ij")
        weights = [(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v]
        points = sum(w[..., None] * corner for w, corner in zip(weights, panel)).reshape(-1, 3)
        du = (1 - v)[..., None] * (panel[1] - panel[0]) + v[..., None] * (panel[2] - panel[3])
        dv = (1 - u)[..., None] * (panel[3] - panel[0]) + u[..., None] * (panel[2] - panel[1])
        areas = np.linalg.norm(np.cross(du, dv), axis=-1).ravel() / n**2
        targets = np.array([[0.5, 0.6, 0.9], [2.0, 0.1, 0.3], [-0.4, 0.2, -0.5]])
        away = targets[:, None] - points
        r = np.linalg.norm(away, axis=-1)[..., None, None]
        exact = ((np.eye(3) / r + away[..., :, None] * away[..., None, :] / r**3) * areas[:, None, None]).sum(1) / (8 * math.pi)
        found = potentials(targets @ turn.T, panel[None] @ turn.T)[:, 0]
        np.testing.assert_allclose(found, turn @ exact @ turn.T, atol=1e-6)

    def test_capacity_of_the_cube(self):
        """The trace of the flow of a force is that of a charge; the unit cube's capacity is 0.6606782 (Hwang,
        Mascagni 2004)."""
        panels = cube_panels(1, 12)
        centres = panels.mean(1)
        areas = np.linalg.norm(np.cross(panels[:, 1] - panels[:, 0], panels[:, 2] - panels[:, 0]), axis=-1)
        matrix = 2 * math.pi * sum(np.trace(potentials(centres, panels * flip), axis1=-2, axis2=-1) for flip in FLIPS)
        self.assertAlmostEqual(8 * np.linalg.solve(matrix, np.ones(len(centres))) @ areas, 0.6606782, delta=3e-5)


class Bodies(unittest.TestCase):
    def test_a_thin_cylinder_is_a_disc(self):
        """16 mu a U broadside, 32/3 mu a U edgewise, 32/3 mu a^3 w about any axis; a thickness t adds t ln t."""
        found = Body(cylinder_panels(1, 1e-4, 12)).resistance()
        exact = [32 / 3, 32 / 3, 16, 32 / 3, 32 / 3, 32 / 3]
        np.testing.assert_allclose(np.diag(found), exact, rtol=5e-3)

    def test_a_cube_resists_alike_in_any_orientation_in_unbounded_fluid(self):
        body = Body(cube_panels(1, 6))
        turned = body.resistance(None, stokes_scene.rotation_about((1, 2, 3), 40))
        np.testing.assert_allclose(turned, body.resistance(), atol=1e-9)

    def test_a_large_box_adds_what_hasimoto_says(self):
        body = Body(cube_panels(1, 6))
        free = body.resistance()[0, 0]
        for edge in (10, 20):
            boxed = body.resistance(PeriodicBox((edge,) * 3), stokes_scene.rotation_about((1, 2, 3), 40))[0, 0]
            self.assertAlmostEqual(6 * math.pi * (1 / free - 1 / boxed) * edge, HASIMOTO, delta=5 / edge**2)

    def test_torque_in_a_box_is_that_of_the_dipole(self):
        """A turning body's flow is, from afar, that of its torque T; in a cube of volume V the rest turns
        about it with -T / (6 V)."""
        body, edge = Body(cube_panels(1, 6)), 6
        free, boxed = body.resistance()[3, 3], body.resistance(PeriodicBox((edge,) * 3))[3, 3]
        self.assertAlmostEqual(boxed * (1 / free - 1 / (6 * edge**3)), 1, delta=1e-3)


if __name__ == "__main__":
    unittest.main()
