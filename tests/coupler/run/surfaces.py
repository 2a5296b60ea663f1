#!/usr/bin/python3
"""surfaces.py SILT: scripts/surfaces, read back by VTK: the surfaces of every shape enclose its volume about its place, and move as it does."""
import pathlib
import subprocess
import sys
import unittest
import xml.etree.ElementTree as ElementTree

import numpy as np
from silt_test import SiltTest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

SCRIPTS = pathlib.Path(__file__).resolve().parents[3] / "scripts"
sys.path.insert(0, str(SCRIPTS))

import silt_results  # noqa: E402

SHAPES = {"sphere": "radius = 3", "box": "edges = [4, 5, 6]", "capsule": "radius = 2\nlength = 4", "cylinder": "radius = 2.5\nlength = 5",
          "ellipsoid": "diameters = [4, 6, 8]", "cone": "radius = 3\nheight = 5",
          "polyhedron": "vertices = [[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6], [3, 3, 4]]",
          "compound": 'parts = [{ type = "box", edges = [2, 3, 4], position = [-1, 0, 0] }, { type = "box", edges = [3, 3, 3], position = [1.5, 0, 0] }]',
          "mesh": 'file = "ring.stl"'}
SCENE = """
[units]
system = "lattice"
[domain]
size = [120, 16, 16]
boundary = { x = "periodic", y = ["no-slip", "no-slip"], z = ["no-slip", "no-slip"] }
[run]
steps = 20
[output]
bodies = { every = 10, contacts = true }
"""


def points_of(polygons):
    return vtk_to_numpy(polygons.GetPoints().GetData()).astype(float)


class Surfaces(SiltTest):
    def setUp(self):
        super().setUp()
        subprocess.run([SCRIPTS / "make_mesh", "torus", self.case / "ring.stl", "--radius", "3", "--tube", "1.2"], check=True, capture_output=True)
        text = SCENE
        for number, (shape, sizes) in enumerate(SHAPES.items()):
            text += f'[[shapes]]\nname = "{shape}"\ntype = "{shape}"\n{sizes}\n'
            text += f'[[bodies]]\nshape = "{shape}"\ndensity = {1 + number}\nposition = [{6 + 13 * number}, 8, 8]\n'
            text += f"velocity = [0, 0.01, {0.001 * number}]\nangular_velocity = [0, {0.001 * number}, 0.01]\n"
        self.write(text)
        self.silt("run", self.case)
        self.series = silt_results.open(self.case).bodies

    def surfaces(self, *arguments, code=0):
        result = subprocess.run([SCRIPTS / "surfaces", self.case, *arguments], capture_output=True, text=True)
        self.assertEqual(result.returncode, code, result.stderr)
        return result.stdout + result.stderr

    def read(self, name):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(self.out / name))
        reader.Update()
        self.assertEqual(reader.GetErrorCode(), 0)
        return reader.GetOutput()

    def test_surfaces_enclose_the_bodies(self):
        self.surfaces()
        rows, polygons = self.series.at(-1), self.read("bodies_000000000020.vtp")
        cells = {name: vtk_to_numpy(polygons.GetCellData().GetArray(name)) for name in ("id", "kind", "velocity")}
        corners = points_of(polygons)[vtk_to_numpy(polygons.GetPolys().GetConnectivityArray()).reshape(-1, 3)]
        signed = np.einsum("td,td->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
        moments = signed[:, None] * corners.sum(axis=1) / 4
        for row, body in enumerate(rows["id"]):
            own = cells["id"] == body
            volume, centre = signed[own].sum(), moments[own].sum(axis=0) / signed[own].sum()
            self.assertAlmostEqual(volume, rows["mass"][row] / (1 + row), delta=0.03 * volume, msg=list(SHAPES)[row])
            self.assertLess(np.abs(centre - rows["position"][row]).max(), 0.02, list(SHAPES)[row])
            self.assertEqual(set(cells["kind"][own]), {rows["kind"][row]})
            self.assertTrue((cells["velocity"][own] == rows["velocity"][row].astype("f4")).all())
        self.assertEqual(set(cells["id"]), set(rows["id"]))

    def test_points_move_as_they_say(self):
        """From step 0 to 10, by the means of their velocities then: exact but for the third order of a turn by 0.1."""
        self.surfaces()
        first, later = self.read("bodies_000000000000.vtp"), self.read("bodies_000000000010.vtp")
        middle = sum(vtk_to_numpy(p.GetPointData().GetArray("surface_velocity")) for p in (first, later)) / 2
        self.assertLess(np.abs(points_of(later) - points_of(first) - 10 * middle).max(), 1e-3)
        self.assertGreater(np.abs(10 * middle[:, 0]).max(), 0.2)

    def test_list_of_times(self):
        said = self.surfaces("--every", "2")
        listed = [(float(d.get("timestep")), d.get("file")) for d in ElementTree.parse(self.out / "bodies.pvd").iter("DataSet")]
        self.assertEqual(listed, [(0, "bodies_000000000000.vtp"), (20, "bodies_000000000020.vtp")])
        self.assertRegex(said, "wrote 2 times; open .*bodies.pvd .*0 sphere, 1 box")
        time = self.read("bodies_000000000020.vtp").GetFieldData().GetArray("TimeValue")
        self.assertEqual(time.GetValue(0), 20)

    def test_they_are_results(self):
        """A run that begins anew moves them aside with the others; scripts/clean takes them for results."""
        self.surfaces()
        said = subprocess.run([SCRIPTS / "clean", self.case], capture_output=True, text=True).stdout
        self.assertIn("out", said)
        self.silt("run", self.case, "--overwrite")
        self.assertFalse((self.out / "bodies.pvd").exists())

    def test_without_bodies(self):
        (self.out / "bodies.h5").unlink()
        self.assertIn("output.bodies", self.surfaces(code=1))


if __name__ == "__main__":
    unittest.main()
