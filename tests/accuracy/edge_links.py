#!/usr/bin/python3
"""scripts/accuracy/edge_links.py: its geometry against points, its lattice against the reference."""
import argparse
import pathlib
import sys
import unittest

ACCURACY = pathlib.Path(__file__).resolve().parent.parent.parent / "scripts" / "accuracy"
sys.path[:0] = [str(ACCURACY), str(ACCURACY.parent)]

import numpy as np  # noqa: E402

import stokes_scene as scene  # noqa: E402
from edge_links import Geometry, Lattice  # noqa: E402


class Lines(unittest.TestCase):
    def test_inside_is_where_the_points_are(self):
        generator = np.random.default_rng(3)
        o, d = generator.uniform(-2, 2, (200, 3)), generator.uniform(-1, 1, (200, 3))
        d[:20, 2] = 0
        d[20:40, :2] = 0
        for body in ("cube", "cylinder"):
            enter, leave = Geometry(body, 2).inside(o, d)
            for t in np.linspace(-2, 2, 41):
                x = o + t * d
                across = np.linalg.norm(x[:, :2], axis=1) if body == "cylinder" else np.abs(x[:, :2]).max(1)
                np.testing.assert_array_equal((enter <= t) & (t <= leave), (across <= 1) & (np.abs(x[:, 2]) <= 1))

    def test_distance_to_the_edge(self):
        along_x = np.array([[1.0, 0, 0]])
        for body in ("cube", "cylinder"):
            s, slope = Geometry(body, 2).near_edge(np.array([[1.0, 0, 0.7]]), along_x)
            np.testing.assert_allclose([s[0], slope[0]], [0.3, 1])
            s, slope = Geometry(body, 2).near_edge(np.array([[0.0, 0.8, -1.0]]), along_x)
            np.testing.assert_allclose([s[0], slope[0]], [0.2, 0])


class Edges(unittest.TestCase):
    def test_closed_edges_take_most_of_the_error_away(self):
        exact = scene.references("cube")["cube.diagonal.torque"]["torque"]

        def error(**keys):
            options = argparse.Namespace(**{"lip": 0.22, "open": False, "scheme": "multireflection", **keys})
            return scene.percent(Lattice("cube.diagonal.torque", 24, scene.offsets(3)[0], options).run(), exact)

        self.assertAlmostEqual(error(open=True), -11.09, delta=0.05)  # the program's own, when it did nothing at edges
        self.assertLess(abs(error(lip=0)), 0.6 * 11.09)
        self.assertLess(abs(error()), 0.3 * 11.09)


if __name__ == "__main__":
    unittest.main()
