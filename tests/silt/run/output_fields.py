#!/usr/bin/python3
"""output_fields.py SILT: fields and slices hold what theory and the other files say, the same on any ranks."""
import sys
import unittest

import h5py
import numpy as np
from vtkmodules.vtkIOHDF import vtkHDFReader
from silt_test import CASE, CHANNEL, ROOT, SiltTest
from silt_runs import body_of, domain_of, shape_of  # on the path by silt_test

import silt_results  # on the path by silt_test

sys.path.insert(0, str(ROOT / "tests" / "adapters" / "hdf5"))
import over_time  # noqa: E402

ALL = '["velocity", "density", "pressure", "shear-rate", "vorticity", "body-id"]'
BALLS = CASE.replace("fields = { every = 20 }", f"fields = {{ every = 20, quantities = {ALL} }}") + """
[[output.slices]]
name = "middle"
every = 15
box = [[0, 8.2, 0], [24, 8.2, 16]]
quantities = ["velocity", "body-id"]
[[output.slices]]
name = "corner"
every = 60
box = [[17, 3.2, 2.5], [24, 9.5, 10]]
quantities = ["density", "shear-rate", "vorticity"]
"""
VORTEX = (domain_of([32, 32, 32]) + '[fluid]\nrelaxation_time = 0.8\nprecision = "double"\n' +
          'initial = { type = "taylor-green-3d", velocity = [0.01, 0, 0] }\n' + "[run]\nsteps = 1\n" +
          "[output]\n" +
          'fields = { every = 1, quantities = ["pressure", "shear-rate", "velocity", "vorticity"], precision = "double" }\n')


PIPE = (domain_of([24, 24, 8], '{ x = "no-slip", y = "no-slip", z = "periodic" }') +
        'blocks = [6, 12, 8]\n[fluid]\nrelaxation_time = 0.8\nprecision = "double"\n' +
        '[[walls]]\nname = "pipe"\ntype = "tube"\npoint = [12, 12, 0]\naxis = "z"\nradius = 10\n' +
        "angular_velocity = 0.001\n[run]\nsteps = 1500\n" +
        '[output]\nfields = { every = 1500, quantities = ["vorticity"], precision = "double" }\n')


# A ball that moves on has the regions of cells move with it: at step 32 at the latest.
LEVELS = (domain_of([96, 32, 32]) +
          "[fluid]\nrelaxation_time = 0.8\n[coarsening]\nlevels = 2\ndistance = 8\n" +
          shape_of("ball", "sphere", "radius = 3") +
          body_of("ball", 20, "position = [16, 16, 16]", "velocity = [0.1, 0, 0]") + "[run]\nsteps = 64\n" +
          "[output]\n" +
          'fields = { every = 32, quantities = ["velocity", "density", "vorticity", "body-id"] }\n' +
          "checkpoint = { every = 32 }\n" +
          '[[output.slices]]\nname = "middle"\nevery = 64\nbox = [[0, 0, 16], [96, 32, 16]]\n' +
          'quantities = ["velocity"]\n')


class Fields(SiltTest):
    def slices(self, name, folder=None):
        return [silt_results.Field(path) for path in sorted((folder or self.out).glob(f"slice_{name}_*.hdf"))]

    def test_pressure_and_shear_of_a_vortex(self):
        """Taylor and Green's at the start: p = A^2/16 (cos 2kx + cos 2ky)(cos 2kz + 2), S from its gradient."""
        self.write(VORTEX)
        self.silt("run", self.case)
        field = silt_results.open(self.case).fields[0]
        a, k = 0.01, 2 * np.pi / 32
        x, y, z = np.meshgrid(field.x, field.y, field.z, indexing="ij")
        pressure = a * a / 16 * (np.cos(2 * k * x) + np.cos(2 * k * y)) * (np.cos(2 * k * z) + 2)
        self.assertLess(np.abs(field["pressure"] - pressure).max(), 1e-6 * a * a)
        sx, cx, sy, cy, sz, cz = (f(k * c) for c in (x, y, z) for f in (np.sin, np.cos))
        stretch, xz, yz = a * k * cx * cy * cz, -0.5 * a * k * sx * cy * sz, 0.5 * a * k * cx * sy * sz
        shear = np.sqrt(2 * (2 * stretch**2 + 2 * xz**2 + 2 * yz**2))
        self.assertLess(np.abs(field["shear-rate"] - shear).max(), 1e-5 * a * k)
        self.assertEqual(field.unit("shear-rate"), "1/step")

    def test_vorticity_of_a_vortex(self):
        """Differences of sines two cells apart give the curl times sin k / k."""
        self.write(VORTEX)
        a, k = 0.01, 2 * np.pi / 32
        for ranks in (1, 3, 4):
            self.silt("run", self.case, ranks=ranks)
            field = silt_results.open(self.case).fields[0]
            x, y, z = np.meshgrid(field.x, field.y, field.z, indexing="ij")
            sx, cx, sy, cy, sz, cz = (f(k * c) for c in (x, y, z) for f in (np.sin, np.cos))
            curl = a * np.sin(k) * np.stack([-cx * sy * sz, -sx * cy * sz, 2 * sx * sy * cz], axis=-1)
            self.assertLess(np.abs(field["vorticity"] - curl).max(), 1e-9 * a * k)
        self.assertEqual(field.unit("vorticity"), "1/step")

    def test_vorticity_beside_plane_walls(self):
        """A channel's velocity is quadratic: no error of the differences, in the cells at the walls either."""
        text = CHANNEL.replace("[output]", '[output]\nfields = { every = 10000, quantities = ["vorticity"], precision = "double" }')
        self.write(text.replace("change = 1e-3", "change = 1e-8"))
        self.silt("run", self.case, ranks=2)
        field = silt_results.open(self.case).fields[-1]
        wanted = -1e-6 / 0.1 * (field.z - 6)  # du/dz = -g (z - h/2) / nu
        found = field["vorticity"]
        self.assertLess(np.abs(found[..., 1] - wanted).max(), 1e-6 * wanted.max())
        self.assertLess(np.abs(found[..., ::2]).max(), 1e-9 * wanted.max())

    def test_vorticity_of_a_turning_pipe(self):
        """Fluid that turns with its pipe has twice the angular velocity everywhere, beside the curved wall too."""
        for ranks in (1, 4):
            self.write(PIPE)
            self.silt("run", self.case, ranks=ranks)
            field = silt_results.open(self.case).fields[-1]
            across = np.hypot(*np.meshgrid(field.x - 12, field.y - 12, indexing="ij"))
            found = field["vorticity"][across < 9.99]
            self.assertLess(np.abs(found - [0, 0, 0.002]).max(), 1e-3 * 0.002)
            self.assertTrue((field["vorticity"][across > 10.01] == 0).all())

    def test_bodies_are_where_they_are(self):
        self.write(BALLS)
        self.silt("run", self.case)
        run = silt_results.open(self.case)
        field, bodies = run.fields[-1], run.bodies.at(-1)
        centres = np.stack(np.meshgrid(field.x, field.y, field.z, indexing="ij"), axis=-1)
        expected = np.zeros(field.size)
        for i, x in zip(bodies["id"], bodies["position"]):
            away = centres - x
            away[..., :2] -= np.round(away[..., :2] / [24, 16]) * [24, 16]
            expected[np.linalg.norm(away, axis=-1) < 2.5] = i
        wrong = (field["body-id"] != expected).sum()  # cells change sides when a body has moved a little
        self.assertLessEqual(wrong, 3)
        self.assertEqual(set(np.unique(field["body-id"])), {0, 1, 2})
        solid = field["body-id"] > 0
        self.assertTrue((field["shear-rate"][solid] == 0).all() and (field["pressure"][solid] == 0).all())
        self.assertTrue(np.allclose(field["pressure"], (field["density"] - 1) / 3, atol=1e-7))

    def test_what_is_solid_is_told_apart(self):
        """Bodies and walls in every file of a scene that has them, in none of one that has not, as whole
        numbers of a byte."""
        self.write(PIPE.replace("steps = 1500", "steps = 1").replace("every = 1500", "every = 1") + """
[[output.slices]]
name = "middle"
every = 1
box = [[0, 0, 4], [24, 24, 4]]
quantities = ["velocity"]
[[shapes]]
name = "ball"
type = "sphere"
radius = 2.6
[[bodies]]
shape = "ball"
density = 1
position = [12, 12, 4]
""")
        self.silt("run", self.case, ranks=2)
        field, (middle, _) = silt_results.open(self.case).fields[-1], self.slices("middle")
        across = np.hypot(*np.meshgrid(field.x - 12, field.y - 12, indexing="ij"))[:, :, None]
        away = np.sqrt(across**2 + (field.z - 4)**2)
        expected = np.where(away < 2.6, 1, np.where(across > 10, 2, 0) + 0 * away)
        self.assertEqual(field["solid"].dtype, np.uint8)
        self.assertTrue((field["solid"] == expected).all())
        self.assertTrue((middle["solid"] == expected[:, :, 3:5]).all())
        self.write(CHANNEL.replace("[output]", "[output]\nfields = { every = 1 }"))
        self.silt("run", self.case, "--steps", 1, "--overwrite")
        self.assertNotIn("solid", silt_results.open(self.case).fields[-1].names)

    def test_slices_are_parts_of_the_field(self):
        self.write(BALLS)
        self.silt("run", self.case)
        field = silt_results.open(self.case).fields[-1]
        middle, (corner_start, corner) = self.slices("middle"), self.slices("corner")
        self.assertEqual([s.step for s in middle], [0, 15, 30, 45, 60])
        self.assertEqual((middle[-1].size, middle[-1].y[0]), ((24, 2, 16), 7.5))
        self.assertTrue((middle[-1]["velocity"] == field["velocity"][:, 7:9]).all())
        self.assertTrue((middle[-1]["body-id"] == field["body-id"][:, 7:9]).all())
        self.assertEqual((corner.size, corner.x[0], corner.y[0], corner.z[0]), ((7, 7, 8), 17.5, 3.5, 2.5))
        self.assertTrue((corner["density"] == field["density"][17:24, 3:10, 2:10]).all())
        self.assertTrue((corner["shear-rate"] == field["shear-rate"][17:24, 3:10, 2:10]).all())
        self.assertTrue((corner["vorticity"] == field["vorticity"][17:24, 3:10, 2:10]).all())
        self.assertTrue((self.out / "slice_middle.hdf.series").exists())
        for name in ("slice_middle_000000000060.hdf", "slice_corner_000000000060.hdf"):  # VTK ends the program on what is one point thick
            image = vtkHDFReader()
            image.SetFileName(str(self.out / name))
            image.Update()
            self.assertEqual(image.GetOutput().GetDimensions(), silt_results.Field(self.out / name).size)
            self.assertGreater(image.GetOutput().GetPointData().GetNumberOfArrays(), 1)

    def test_files_over_time(self):
        """They are the same from any ranks. A run that goes on goes on in them, at other times and with other fields too."""
        def of_all():
            return {path.name: path.read_bytes() for path in self.out.glob("*.vtkhdf")}
        self.write(BALLS)
        self.silt("run", self.case)
        one = of_all()
        times = {"fields.vtkhdf": 4, "slice_middle.vtkhdf": 5, "slice_corner.vtkhdf": 2, "bodies.vtkhdf": 10}
        self.assertEqual(over_time.check(self.out), times)
        self.silt("run", self.case, "--overwrite", ranks=3)
        self.assertTrue(of_all() == one)
        with h5py.File(self.out / "fields.vtkhdf") as file:
            self.assertEqual(file["VTKHDF/PointData/velocity"][:4].shape, (4, 16, 16, 24, 3))
        (self.out / "checkpoint_000000000060.h5").unlink()
        self.silt("resume", self.case, "--steps", 70, "--set", "output.fields.every=15")  # from step 50
        self.assertEqual(over_time.check(self.out), times | {"fields.vtkhdf": 5, "slice_middle.vtkhdf": 6, "slice_corner.vtkhdf": 3, "bodies.vtkhdf": 11})
        self.silt("resume", self.case, "--steps", 90, "--set", 'output.fields.quantities=["density"]', "--set", "output.fields.every=10")
        with h5py.File(self.out / "fields.vtkhdf") as file:  # those that the files before have too
            self.assertEqual(list(file["VTKHDF/PointData"]), ["density", "solid"])
        over_time.check(self.out)

    def test_cells_of_several_levels(self):
        """Cells, regions and values are the same on any ranks, and in a run that goes on in the middle."""
        self.write(LEVELS)
        self.silt("run", self.case)
        first, last = silt_results.open(self.case).fields[::2]
        self.assertEqual((last.levels, last.size, list(last.spacing)), (3, (96, 32, 32), [1, 1, 1]))
        level = last["level"]
        self.assertEqual([level[x, 16, 16] for x in (18, 40, 70)], [0, 1, 2])
        self.assertTrue((level[last["body-id"] > 0] == 0).all())
        self.assertFalse((level == first["level"]).all())
        self.assertEqual((abs(np.diff(level, axis=0)).max(), set(np.unique(level))), (1, {0, 1, 2}))
        for box in last.boxes("density"):
            self.assertEqual(list(box.spacing), [2**box.level] * 3)
        middle, = self.slices("middle")[1:]
        self.assertEqual((middle.size, middle.z[0]), ((96, 32, 8), 12.5))
        self.assertTrue((middle["velocity"] == last["velocity"][:, :, 12:20]).all())
        report = silt_results.open(self.case).report
        self.assertEqual([entry["width"] for entry in report["levels"]], [1, 2, 4])
        self.assertEqual([entry["cells"] for entry in report["levels"]], [(level == k).sum() / 8**k for k in range(3)])
        self.assertEqual(report["fluid_cells"], 96 * 32 * 32 - (last["body-id"] > 0).sum())
        other = self.case / "other"
        self.silt("run", self.case, "--out", other, "--steps", 32, ranks=2)
        self.silt("resume", self.case, "--out", other, "--steps", 64)
        again = silt_results.open(other)
        self.assertEqual(again.report["state_hash"], report["state_hash"])
        for here, there in zip(silt_results.open(self.case).fields, again.fields, strict=True):
            for name in [*here.names, "level"]:
                self.assertTrue((here[name] == there[name]).all(), (here.step, name))

    def test_planes_at_sides(self):
        for at, first in ((0, 0), (0.9, 0), (1.6, 1), (15.4, 14), (16, 14)):
            self.write(BALLS.replace("8.2", str(at)))
            self.silt("run", self.case, "--steps", 1, "--overwrite")
            self.assertEqual(self.slices("middle")[0].y[0], first + 0.5)

    def test_same_on_any_ranks(self):
        self.write(BALLS)
        self.silt("run", self.case)
        other = self.case / "other"
        for ranks in (3, 4):
            self.silt("run", self.case, "--out", other, "--overwrite", ranks=ranks)
            for path in [*self.out.glob("fields_*.hdf"), *self.out.glob("slice_*.hdf")]:
                a, b = silt_results.Field(path), silt_results.Field(other / path.name)
                for name in a.names:
                    self.assertTrue((a[name] == b[name]).all(), (ranks, path.name, name))

    def test_mistakes_are_named(self):
        for key, fault in (('name = "a/b"', "letters, digits, dots and hyphens"), ('box = [[0, 17, 0], [24, 17, 16]]', "within the domain"),
                           ('box = [[1.6, 1.6, 1.6], [2.4, 9, 9]]', "holds the centres of two cells"), ('quantities = ["curl"]', "known: velocity, density")):
            name = "" if key.startswith("name") else 'name = "s"\n'
            self.write(CASE + f"[[output.slices]]\n{name}every = 10\n{key}\n")
            self.assertRegex(self.silt("check", self.case, code=2).stderr, fault)


class Mean(SiltTest):
    """output.mean: what numpy makes of the fields at the same times, the same on any ranks and across a restart."""
    FIELDS = 'fields = { every = 3, precision = "double", quantities = ["velocity", "pressure"] }\nmean = { from = 20, every = 3 }'
    TEXT = CASE.replace("fields = { every = 20 }", FIELDS).replace("every = 25, keep = 3", "every = 10, keep = 9")

    def means(self):
        with h5py.File(next(self.out.glob("mean_*.hdf"))) as file:
            return {name: data[()] for name, data in file["VTKHDF/PointData"].items()}

    def test_against_the_fields(self):
        self.write(self.TEXT)
        self.silt("run", self.case)
        means, steps = self.means(), range(21, 61, 3)
        velocities, pressures, solids = [], [], []
        for step in steps:
            with h5py.File(self.out / f"fields_{step:012}.hdf") as file:
                data = file["VTKHDF/PointData"]
                velocities.append(data["velocity"][()]), pressures.append(data["pressure"][()]), solids.append(data["solid"][()] != 0)
        solid, u, p = np.array(solids), np.array(velocities), np.array(pressures)
        self.assertTrue(0 < (solid.any(0) & ~solid.all(0)).sum())  # the balls move
        np.testing.assert_allclose(means["solid-fraction"], solid.mean(0), atol=1e-15)
        times = np.maximum((~solid).sum(0), 1)
        bodies = np.where(solid[..., None], u, 0).sum(0) / np.maximum(solid.sum(0), 1)[..., None]
        np.testing.assert_allclose(means["body-velocity"], bodies, atol=1e-15)
        u[solid], p[solid] = 0, 0
        mean = u.sum(0) / times[..., None]
        np.testing.assert_allclose(means["velocity"], mean, atol=1e-15)
        np.testing.assert_allclose(means["pressure"], p.sum(0) / times, atol=1e-15)
        off = np.where(solid[..., None], 0, u - mean)
        np.testing.assert_allclose(means["velocity-variance"], (off**2).sum(0) / times[..., None], atol=1e-17)
        products = np.stack([off[..., a] * off[..., b] for a, b in ((0, 1), (0, 2), (1, 2))], -1)
        np.testing.assert_allclose(means["velocity-covariance"], products.sum(0) / times[..., None], atol=1e-17)

    def test_the_same_on_any_ranks_and_after_a_restart(self):
        self.write(self.TEXT.replace("fields = { every = 3", "fields = { every = 0").replace("from = 20", "from = 10").replace("steps = 60", "steps = 30"))
        self.silt("run", self.case)
        whole = self.means()
        self.assertGreater(whole["velocity-variance"].max(), 0)
        for ranks in (3, 4):
            self.silt("run", self.case, "--overwrite", ranks=ranks)
            for name, data in self.means().items():
                self.assertTrue((data == whole[name]).all(), (ranks, name))
        for path in (*self.out.glob("checkpoint_*30.h5"), *self.out.glob("mean*")):
            path.unlink()
        self.silt("resume", self.case, ranks=2)  # from step 20
        for name, data in self.means().items():
            self.assertTrue((data == whole[name]).all(), name)


if __name__ == "__main__":
    unittest.main()
