#!/usr/bin/python3
"""scripts/body_shapes.py: the lines that a drawing of a mesh has."""
import pathlib
import sys
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))
from body_shapes import outline  # noqa: E402

VIEW = np.linalg.qr(np.array([[1.0, 0.3, 0.2], [0.1, 1.0, -0.4], [0.3, 0.5, 1.0]]).T)[0].T


def cube():
    """Two triangles a face; edges of length 1."""
    faces = []
    for d in range(3):
        for end in (0, 1):
            square = np.zeros((4, 3))
            square[:, d] = end
            square[:, d - 2] = (0, 1, 1, 0)
            square[:, d - 1] = (0, 0, 1, 1)
            square = square if end else square[::-1]
            faces += [square[[0, 1, 2]], square[[0, 2, 3]]]
    return np.array(faces)


def ball(rings=40, sectors=80):
    polar, azimuth = np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, sectors + 1)
    azimuth[-1] = 0
    points = np.array([[[np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)] for a in azimuth] for p in polar])
    points[0], points[-1] = (0, 0, 1), (0, 0, -1)
    faces = []
    for i in range(rings):
        for j in range(sectors):
            a, b, c, d = points[i, j], points[i + 1, j], points[i + 1, j + 1], points[i, j + 1]
            faces += ([[a, b, c]] if i + 1 < rings else []) + ([[a, c, d]] if i > 0 else [])
    return np.array(faces)


class Outlines(unittest.TestCase):
    def test_a_cube_has_its_twelve_edges(self):
        edges = outline(cube(), VIEW)
        self.assertEqual(len(edges), 12)
        np.testing.assert_allclose(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1), 1)

    def test_a_ball_has_its_silhouette(self):
        edges = outline(ball(), VIEW)
        # of the unit ball: within half an edge (pi / 40) of the great circle across the line of sight, and
        # once around it
        self.assertLess(np.abs(edges @ VIEW[2]).max(), 0.1)
        length = np.linalg.norm((edges[:, 1] - edges[:, 0]) @ VIEW[:2].T, axis=1).sum()
        self.assertAlmostEqual(length, 2 * np.pi, delta=0.1 * 2 * np.pi)

    def test_an_open_sheet_has_its_rim(self):
        self.assertEqual(len(outline(cube()[:2], VIEW)), 4)

    def test_faces_that_bend_less_than_a_crease_have_no_line_between(self):
        bent = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0], [0, 1, 0], [-1, 0, 0.3]]], float)  # 17 degrees
        self.assertEqual(len(outline(bent, np.eye(3))), 4)
        self.assertEqual(len(outline(bent, np.eye(3), crease=10)), 5)


if __name__ == "__main__":
    unittest.main()
