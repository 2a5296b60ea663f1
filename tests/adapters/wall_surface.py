#!/usr/bin/python3
"""scripts/wall_surface.py: the lines that a drawing of a mesh has, and where a wall is at a time."""
import pathlib
import shutil
import sys
import tempfile
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from wall_surface import at_time, outline  # noqa: E402

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


def stl(corners):
    rows = np.zeros(len(corners), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]))
    rows["corners"] = corners
    return bytes(80) + len(corners).to_bytes(4, "little") + rows.tobytes()


class Outlines(unittest.TestCase):
    def test_a_cube_has_its_twelve_edges(self):
        edges = outline(cube(), VIEW)
        self.assertEqual(len(edges), 12)
        np.testing.assert_allclose(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1), 1)

    def test_a_ball_has_its_silhouette(self):
        edges = outline(ball(), VIEW)
        # of the unit ball: within half an edge (pi / 40) of the great circle across the line of sight, and once around it
        self.assertLess(np.abs(edges @ VIEW[2]).max(), 0.1)
        length = np.linalg.norm((edges[:, 1] - edges[:, 0]) @ VIEW[:2].T, axis=1).sum()
        self.assertAlmostEqual(length, 2 * np.pi, delta=0.1 * 2 * np.pi)

    def test_an_open_sheet_has_its_rim(self):
        self.assertEqual(len(outline(cube()[:2], VIEW)), 4)

    def test_faces_that_bend_less_than_a_crease_have_no_line_between(self):
        bent = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 0], [0, 1, 0], [-1, 0, 0.3]]], float)  # 17 degrees
        self.assertEqual(len(outline(bent, np.eye(3))), 4)
        self.assertEqual(len(outline(bent, np.eye(3), crease=10)), 5)


class Motions(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)
        (self.folder / "cube.stl").write_bytes(stl(cube()))

    def pose(self, motion, time):
        """Returns where the corner at the origin is, and the edge from it that was along x."""
        corners = at_time({"file": "cube.stl", "motion": motion}, self.folder, time).reshape(-1, 3)
        origin, x = (corners[np.isclose(cube().reshape(-1, 3), point).all(axis=1)][0] for point in ((0, 0, 0), (1, 0, 0)))
        return origin, x - origin

    def test_rotation_about_a_point_that_moves(self):
        origin, x = self.pose({"angular_velocity": np.pi / 2, "axis": "z", "point": [1, 0, 0], "velocity": [3, 0, 0]}, 1)
        np.testing.assert_allclose(origin, (4, -1, 0), atol=1e-6)
        np.testing.assert_allclose(x, (0, 1, 0), atol=1e-6)

    def test_oscillation(self):
        swing = {"oscillation": {"amplitude": [0, 0.2, 0], "frequency": 0.25, "phase": 90}}
        for time, y in ((0, 0.2), (1, 0), (2, -0.2)):
            np.testing.assert_allclose(self.pose(swing, time)[0], (0, y, 0), atol=1e-6)

    def test_table(self):
        (self.folder / "motion.csv").write_text("t,x,y,z,a,b,c\n0,0,0,0,0,0,0\n# a remark\n\n1,1,0,0,0,0,0.5\n3,9,0,0,0,0,1.5\n4,9,0,0,0,0,1.5\n")
        for time, at in ((-1, 0), (0, 0), (1, 1), (3, 9), (4, 9), (7, 9)):
            np.testing.assert_allclose(self.pose({"table": "motion.csv"}, time)[0], (at, 0, 0), atol=1e-6, err_msg=f"{time}")
        # Parabolas through three lines: t^2, of slope 2 at 1, and one of slope 4/3 at 3; of the angle 1/2 and 1/6. Half-way
        # between, a cubic is the mean of its ends and an eighth of the length times the difference of its slopes.
        origin, x = self.pose({"table": "motion.csv"}, 2)
        angle = 1 + 2 / 8 * (1 / 2 - 1 / 6)
        np.testing.assert_allclose(origin, (5 + 2 / 8 * (2 - 4 / 3), 0, 0), atol=1e-6)
        np.testing.assert_allclose(x, (np.cos(angle), np.sin(angle), 0), atol=1e-6)


if __name__ == "__main__":
    unittest.main()
