#!/usr/bin/python3
"""surfaces.py SILT: scripts/surfaces, read back by VTK: the surfaces of every shape enclose its volume about
its place, and move as it does; walls, from files of every kind, are where the run has them."""
import unittest
import xml.etree.ElementTree as ElementTree

import numpy as np
from silt_test import SiltTest, script
from silt_runs import domain_of, entry_of  # on the path by silt_test
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

import silt_results  # on the path by silt_test

SHAPES = {"sphere": "radius = 3", "box": "edges = [4, 5, 6]", "capsule": "radius = 2\nlength = 4", "cylinder": "radius = 2.5\nlength = 5",
          "ellipsoid": "diameters = [4, 6, 8]",
          "polyhedron": "vertices = [[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6], [3, 3, 4]]",
          "compound": 'parts = [{ type = "box", edges = [2, 3, 4], position = [-1, 0, 0] }, { type = "box", edges = [3, 3, 3], position = [1.5, 0, 0] }]',
          "mesh": 'file = "ring.stl"'}
SCENE = (domain_of([120, 16, 16], '{ x = "periodic", y = ["no-slip", "no-slip"], z = ["no-slip", "no-slip"] }') +
         "[run]\nsteps = 20\n[output]\nbodies = { every = 10, contacts = true }\n")


# Cubes of four cells, from a file of each kind: one turns about a point that moves, one oscillates, one
# follows a table, one is at rest, turned.
def cube(name, file, x, *lines):
    return entry_of("walls", [f'name = "{name}"', 'type = "mesh"', 'solid = "inside"', f'file = "{file}"', "scale = 4"],
                    f"position = [{x}, 6, 6]", *lines)


WALLS = (domain_of([48, 16, 16]) + "[fluid]\nrelaxation_time = 0.8\n" +
         cube("turning", "binary.stl", 6, 'motion = { angular_velocity = 0.01, axis = "z", point = [8, 6, 6], velocity = [0.02, 0, 0] }') +
         cube("swinging", "text.stl", 18, "motion = { amplitude = [0, 2, 0], frequency = 0.005 }") +
         cube("led", "cube.ply", 28, 'motion = { table = "motion.csv" }') +
         cube("resting", "cube.obj", 42, "orientation = { axis = [0, 0, 1], degrees = 30 }") +
         '[run]\nsteps = 100\n[output]\nfields = { every = 50, quantities = ["body-id"] }\n')
MOTION = "t,x,y,z,a,b,c\n0,0,0,0,0,0,0\n# a remark\n\n50,1,0,0,0,0,0.5\n150,9,0,0,0,0,1.5\n200,9,0,0,0,0,1.5\n"


def cube_files(folder):
    """Writes the unit cube at the origin as binary and text STL, PLY and OBJ."""
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    faces = np.array([t for q in quads for t in (q[:3], [q[0], q[2], q[3]])])
    rows = np.zeros(len(faces), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]))
    rows["corners"] = corners[faces]
    (folder / "binary.stl").write_bytes(bytes(80) + len(faces).to_bytes(4, "little") + rows.tobytes())
    facets = "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex {:g} {:g} {:g}\n".format(*c) for c in corners[f])
                     + "endloop\nendfacet\n" for f in faces)
    (folder / "text.stl").write_text(f"solid cube\n{facets}endsolid cube\n")
    points = "".join("{:g} {:g} {:g}\n".format(*c) for c in corners)
    (folder / "cube.ply").write_text("ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
                                     f"element face 12\nproperty list uchar int vertex_indices\nend_header\n{points}"
                                     + "".join("3 {} {} {}\n".format(*f) for f in faces))
    (folder / "cube.obj").write_text("".join(f"v {line}\n" for line in points.splitlines())
                                     + "".join("f {} {} {}\n".format(*(f + 1)) for f in faces))
    (folder / "motion.csv").write_text(MOTION)


def placed(corner, angle):
    """Returns the corners of a cube of four cells whose first is at `corner`, turned about it and z."""
    unit = np.array([[x, y, z] for z in (0, 4) for y in (0, 4) for x in (0, 4)], float)
    c, s = np.cos(angle), np.sin(angle)
    return corner + unit @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])


def expected(time):
    """Returns where the corners of the four cubes are at a time, from their motions by hand."""
    angle = 0.01 * time
    turning = np.array([8 + 0.02 * time, 6, 6]) + 2 * np.array([-np.cos(angle), -np.sin(angle), 0])
    # Parabolas through three rows of the table: x has the slope 0.04 at 50 (t^2 / 2500 through 0, 1 and 9)
    # and 8/300 at 150, where the last row is 50 after and no further; of the angle 0.01 and 1/300. Half-way a
    # cubic is the mean and an eighth of the length times the difference of the slopes.
    led = {0: (0, 0), 50: (1, 0.5), 100: (5 + 100 / 8 * (0.04 - 8 / 300), 1 + 100 / 8 * (0.01 - 1 / 300))}[time]
    return [placed(turning, angle), placed([18, 6 + 2 * np.sin(0.01 * np.pi * time), 6], 0),
            placed([28 + led[0], 6, 6], led[1]), placed([42, 6, 6], np.radians(30))]


def points_of(polygons):
    return vtk_to_numpy(polygons.GetPoints().GetData()).astype(float)


class Surfaces(SiltTest):
    def setUp(self):
        super().setUp()
        script("make_mesh", "torus", self.case / "ring.stl", "--radius", "3", "--tube", "1.2")
        text = SCENE
        for number, (shape, sizes) in enumerate(SHAPES.items()):
            text += f'[[shapes]]\nname = "{shape}"\ntype = "{shape}"\n{sizes}\n'
            text += f'[[bodies]]\nshape = "{shape}"\ndensity = {1 + number}\nposition = [{6 + 13 * number}, 8, 8]\n'
            text += f"velocity = [0, 0.01, {0.001 * number}]\nangular_velocity = [0, {0.001 * number}, 0.01]\n"
        self.write(text)
        self.silt("run", self.case)
        self.series = silt_results.open(self.case).bodies

    def surfaces(self, *arguments, code=0):
        return script("surfaces", self.case, *arguments, code=code)

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
        """Points move from step 0 to 10 by the means of their velocities then: exact but for the third order
        of a turn by 0.1."""
        self.surfaces()
        first, later = self.read("bodies_000000000000.vtp"), self.read("bodies_000000000010.vtp")
        middle = sum(vtk_to_numpy(p.GetPointData().GetArray("surface_velocity")) for p in (first, later)) / 2
        self.assertLess(np.abs(points_of(later) - points_of(first) - 10 * middle).max(), 1e-3)
        self.assertGreater(np.abs(10 * middle[:, 0]).max(), 0.2)

    def test_list_of_times(self):
        said = self.surfaces("--every", "2")
        listed = [(float(d.get("timestep")), d.get("file")) for d in ElementTree.parse(self.out / "bodies.pvd").iter("DataSet")]
        self.assertEqual(listed, [(0, "bodies_000000000000.vtp"), (20, "bodies_000000000020.vtp")])
        self.assertRegex(said, "wrote 2 times .*0 sphere, 1 box(.|\n)*open .*paraview.py")
        time = self.read("bodies_000000000020.vtp").GetFieldData().GetArray("TimeValue")
        self.assertEqual(time.GetValue(0), 20)
        text = (self.out / "paraview.py").read_text()  # what ParaView makes of it: opens_in_paraview.py
        compile(text, "paraview.py", "exec")
        self.assertIn(str(self.out), text)
        self.assertNotIn("{", text.split("FOLDER, UP =")[1].splitlines()[0])

    def test_without_bodies(self):
        (self.out / "bodies.h5").unlink()
        self.assertIn("output.bodies", self.surfaces(code=1))

    def test_they_are_results(self):
        """A run that begins anew moves them aside with the others; scripts/clean takes them for results."""
        self.surfaces()
        self.assertIn("out", script("clean", self.case))
        self.silt("run", self.case, "--overwrite")
        self.assertFalse((self.out / "bodies.pvd").exists())


class Walls(SiltTest):
    def run_with(self, *arguments):
        cube_files(self.case)
        self.write(WALLS)
        self.silt("run", self.case, *arguments)
        script("surfaces", self.case)
        return silt_results.open(self.case)

    def test_walls_of_every_kind_of_file_are_where_they_are(self):
        run = self.run_with()
        self.assertEqual([wall.name for wall in run.scene.walls], ["turning", "swinging", "led", "resting"])
        self.assertEqual([wall.moves for wall in run.scene.walls], [True, True, True, False])
        for time in (0, 50, 100):
            reader = vtkXMLPolyDataReader()
            reader.SetFileName(str(self.out / f"walls_{time:012d}.vtp"))
            reader.Update()
            polygons = reader.GetOutput()
            numbers = vtk_to_numpy(polygons.GetCellData().GetArray("wall"))
            corners = points_of(polygons)[vtk_to_numpy(polygons.GetPolys().GetConnectivityArray()).reshape(-1, 3)]
            for number, where in enumerate(expected(time)):
                found = corners[numbers == number]
                self.assertEqual(len(found), 12)
                near = np.linalg.norm(found.reshape(-1, 1, 3) - where, axis=2)
                self.assertLess(near.min(axis=1).max(), 1e-5, (time, number))
                self.assertEqual(set(near.argmin(axis=1)), set(range(8)))
                volume = np.einsum("td,td->t", found[:, 0], np.cross(found[:, 1], found[:, 2])).sum() / 6
                self.assertAlmostEqual(volume, 64, delta=1e-3)
        listed = [d.get("file") for d in ElementTree.parse(self.out / "walls.pvd").iter("DataSet")]
        self.assertEqual(listed, [f"walls_{time:012d}.vtp" for time in (0, 50, 100)])
        self.look_at_mask(run)

    def look_at_mask(self, run):
        """Cells whose centres are in one of the cubes are wall, all others are not; a wall that moves has
        moved on by a step at most."""
        field = run.fields[-1]
        centres = np.stack(np.meshgrid(field.x, field.y, field.z, indexing="ij"), axis=-1)
        inside, near = np.zeros(field.size, bool), np.zeros(field.size, bool)
        for where in expected(100):
            axes = (where[[1, 2, 4]] - where[0]) / 4
            along = (centres - where[0]) @ axes.T
            inside |= ((along > 0) & (along < 4)).all(axis=-1)
            near |= (np.minimum(np.abs(along), np.abs(along - 4)) < 0.1).any(axis=-1)
        self.assertTrue((field["solid"][inside & ~near] == 2).all())
        self.assertTrue((field["solid"][~inside & ~near] == 0).all())
        self.assertGreater((inside & ~near).sum(), 150)

    def test_they_are_those_of_the_run(self):
        """--set moves a wall; the case and its files may change later."""
        before = self.run_with().scene.walls[3].corners(0)
        moved = self.run_with("--overwrite", "--set", "walls.3.position=[40, 5, 6]", "--set", "walls.0.motion.angular_velocity=0")
        for name in ("binary.stl", "text.stl", "cube.ply", "cube.obj", "motion.csv", "case.toml"):
            (self.case / name).write_text("")
        script("surfaces", self.case, self.out)
        self.assertLess(np.abs(moved.scene.walls[3].corners(70) - before - [-2, -1, 0]).max(), 1e-12)
        self.assertLess(np.abs(moved.scene.walls[0].corners(50) - moved.scene.walls[0].corners(0) - [1, 0, 0]).max(), 1e-12)


if __name__ == "__main__":
    unittest.main()
