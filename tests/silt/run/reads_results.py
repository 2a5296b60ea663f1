#!/usr/bin/python3
"""reads_results.py SILT: silt_results gives what is in the files, and the program of its page runs as it stands."""
import contextlib
import io
import re
import subprocess
import types
import unittest

import h5py
import numpy as np
from silt_test import CASE, ROOT, SiltTest, script

import silt_results  # on the path by silt_test
from silt_runs import entry_of
from silt_results import structure


# Bodies whose file's or parts' origin is not their centre of mass come to rest on one another.
SETTLING = """
[units]
system = "si"
cell_size = 0.003
time_step = 0.0007
[domain]
size = [0.096, 0.096, 0.12]
boundary = { x = "periodic", y = "periodic", z = "no-slip" }
[gravity]
acceleration = [0, 0, -3.1]
[contacts]
friction = 0.3
[[shapes]]
name = "rock"
type = "mesh"
file = "rock.obj"
scale = 0.011
[[shapes]]
name = "club"
type = "compound"
parts = [{ type = "sphere", radius = 0.01, position = [0.03, 0, 0] }, { type = "box", edges = [0.03, 0.008, 0.008], position = [0.015, 0, 0] }]
[[shapes]]
name = "ball"
type = "sphere"
radius = 0.009
ROCKS
[[bodies]]
shape = "club"
density = 1500
CLUBS
[[bodies]]
shape = "ball"
density = 2500
BALLS
[run]
steps = 600
[output]
bodies = { every = 200 }
"""
PLACES = {"ROCKS": """[[bodies]]
shape = "rock"
name = "rocks, \\"small\\""
density = 2000
positions = [[0.01, 0.02, 0.02], [0.05, 0.02, 0.02], [0.06, 0.06, 0.02]]
orientation = [1, 1, 3]""", "CLUBS": "positions = [[0.01, 0.03, 0.08], [0.04, 0.07, 0.06]]\nangular_velocity = [1, 2, 3]",
          "BALLS": "positions = [[0.02, 0.08, 0.02], [0.07, 0.05, 0.05], [0.08, 0.08, 0.09]]\nvelocity = [0.1, 0.07, 0]"}


class BodiesOfAnotherRun(SiltTest):
    def test_are_described_as_they_were_there(self):
        """Names, surfaces and sizes, and which kinds do not move freely."""
        sizes = "diameter = { table = [[3, 1], [5, 1]] }"
        begin, end = CASE.split("[[bodies]]")[0], "[run]\nsteps = 2\n[output]\nbodies = { every = 2 }\ncheckpoint = { every = 2 }\n"
        posts, grains = (entry_of("bodies", ['shape = "ball"', "density = 1.5", f'name = "{name}"']) for name in ("posts", "grains"))
        fill = grains.replace("bodies", "fill") + f"count = 8\n{sizes}\n"
        self.write(begin + posts + 'motion = "fixed"\nposition = [12, 8, 8]\n' + fill + end)
        self.silt("run", self.case)
        self.write(begin + posts + 'motion = "fixed"\n' + grains + sizes + f'\n{end}[initial]\nfrom = "out"\n')
        self.silt("run", self.case, "--out", self.case / "next")
        was, now = silt_results.open(self.case), silt_results.open(self.case / "next")
        self.assertEqual(list(now.bodies.kinds), ["posts", "grains"])
        for ours, theirs in zip(was.bodies.meshes, now.bodies.meshes):
            self.assertEqual([len(part["triangles"]) for part in ours], [len(part["triangles"]) for part in theirs])
        self.assertEqual(now.report["sizes"], was.report["sizes"])
        self.assertTrue((now.bodies.at(0)["scale"] == was.bodies.at(-1)["scale"]).all())
        self.assertEqual(sum(count for _, count in now.report["sizes"]["grains"]), 8)
        self.assertEqual((was.scene.driven, now.scene.driven), (["posts"], ["posts"]))


class PositionFiles(SiltTest):
    def test_another_case_begins_with_them(self):
        script("make_mesh", "gear", self.case / "rock.obj")
        corners = (self.case / "rock.obj").read_text().splitlines()
        corners = [f"v {float(w[1]) + 1.5} {float(w[2]) - 0.7} {w[3]}" if w[0] == "v" else " ".join(w) for w in map(str.split, corners)]
        (self.case / "rock.obj").write_text("\n".join(corners) + "\n")
        for system in ("si", "lattice"):
            self.write(self.text(PLACES, system))
            self.silt("run", self.case, "--overwrite")
            bodies = silt_results.open(self.case).bodies
            for index in (-1, 2):
                filed = {}
                for number, (mark, kind) in enumerate(zip(PLACES, bodies.kinds)):
                    bodies.write_positions(self.case / f"{number}.csv", kind, index)
                    filed[mark] = f'positions = "{number}.csv"\norigin = "centre"'
                    if mark == "ROCKS":
                        filed[mark] = f'[[bodies]]\nshape = "rock"\ndensity = 2000\n{filed[mark]}'
                self.write(self.text(filed, system).replace("steps = 600", "steps = 1"))
                for ranks in (1, 3):
                    self.silt("run", self.case, "--out", self.case / "again", "--overwrite", ranks=ranks)
                    self.same(bodies.at(index), silt_results.open(self.case / "again").bodies.at(0), system)

    def text(self, places, system):
        text = SETTLING
        for mark, place in places.items():
            text = text.replace(mark, place)
        if system == "si":
            return text
        text = text.replace('"si"', '"lattice"').replace("cell_size = 0.003\ntime_step = 0.0007\n", "")
        text = re.sub(r"density = (\d)(\d)00", r"density = \1.\2", text).replace("-3.1]", "-5e-4]").replace("velocity = [0.1, 0.07", "velocity = [0.02, 0.01")
        text = text.replace("[1, 2, 3]", "[1e-3, 2e-3, 3e-3]")

        def lengths(found):
            return re.sub(r"\d+\.\d+", lambda m: f"{float(m[0]) / 0.003:.4g}", found[0])
        return re.sub(r"^(size|scale|parts|radius|positions) = .*", lengths, text, flags=re.M)

    def same(self, before, after, system):
        for name in ("position", "orientation", "velocity", "angular_velocity"):
            a, b = before[name], after[name]
            # in SI units a number is divided and multiplied by its unit on the way, each time rounded
            far = np.abs(a - b) > (np.spacing(np.abs(a)) if system == "si" and name != "orientation" else 0)
            self.assertFalse(far.any(), (system, name, a[far], b[far]))
        self.assertTrue((np.abs(before["velocity"]) > 0).any() and (np.abs(before["orientation"][:, 1:]) > 0.01).any())

    def test_what_cannot_be_is_refused(self):
        header = "x,y,z,velocity.x,velocity.y,velocity.z\n"
        for text, key, said in ((header + "6,8,8,1e-3,0,0\n", "velocity = [0, 0, 0]", "velocity is given, and 'p.csv' has columns of it: remove one of the two"),
                                ("x,y,z,velocity.x\n6,8,8,0\n", "", "its headings do not name velocity.y; they must name x, y, z and may name"),
                                ("id,x,y,z\n1,6,8,8\n", "", "its headings name \"id\""),
                                ("id,x,y\n1,6,8\n", "", "its headings name \"id\""),
                                ("x,x,y,z\n6,6,8,8\n", "", "its headings name x twice"),
                                (header + "6,8,8,0,0,0\n18,8,8,0.9,0,0\n", "", "velocity is 0.9 cells a step; it must be at most 0.3"),
                                ("x,y,z," + ",".join(f"orientation.{a}" for a in "wxyz") + "\n6,8,8,0,0,0,0\n", "", "line 2 of p.csv has an orientation of four zeros"),
                                (header + "6,8,8\n", "", 'line 2 of p.csv is "6,8,8": it has 3 numbers; it must be 6 finite numbers')):
            (self.case / "p.csv").write_text(text)
            self.write(CASE.replace("positions = [[6, 8, 8], [18, 8, 9]]", 'positions = "p.csv"').replace("velocity = [0.02, 0, 0]", key))
            self.assertIn(said, self.silt("check", self.case, code=2).stderr)
        (self.case / "p.csv").write_text("z [cells],y (cells),X\n9,8,6\n10,8,18\n")
        self.assertIn("2 lines of numbers, 1 of headings", self.silt("check", self.case).stdout)
        self.silt("run", self.case)
        self.assertEqual(silt_results.open(self.case).bodies.at(0)["position"].tolist(), [[6, 8, 9], [18, 8, 10]])


class Structure(unittest.TestCase):
    def run_of(self, position, size, periodic=(True, True, True), radius=0.5):
        rows = {"position": np.asarray(position, float), "kind": np.arange(len(position)) % 2}
        series = types.SimpleNamespace(domain=np.array([np.zeros(3), size], float), kinds=["even", "odd"], bounding_radius=np.full(2, radius),
                                       at=lambda index: rows)
        return types.SimpleNamespace(bodies=series, scene=types.SimpleNamespace(periodic=list(periodic)))

    def lattice(self, basis, cells=4):
        """Places of a cubic lattice whose nearest neighbours are 1 apart."""
        sites = (np.indices((cells,) * 3).reshape(3, -1).T[:, None] + np.array(basis)).reshape(-1, 3)
        edge = 1 / np.sort(np.linalg.norm(sites[1:] - sites[0], axis=1))[0]
        return edge * sites, np.full(3, edge * cells)

    def test_lattices(self):
        """Neighbours and q4, q6 of the cubic lattices: Steinhardt, Nelson, Ronchetti, Phys. Rev. B 28 (1983) 784."""
        face, body = [[0, 0, 0], [0.5, 0.5, 0], [0.5, 0, 0.5], [0, 0.5, 0.5]], [[0, 0, 0], [0.5, 0.5, 0.5]]
        for basis, touching, q4, q6 in ((face, 12, 0.190941, 0.574524), (body, 8, 0.509175, 0.628539), ([[0, 0, 0]], 6, 0.763763, 0.353553)):
            position, size = self.lattice(basis)
            run = self.run_of(position, size)
            self.assertEqual(set(structure.neighbours(run, gap=1e-9)), {touching})
            self.assertEqual(len(structure.neighbours(run, box=[[0, 0, 0], [1.01] * 3])), (position < 1.02).all(axis=1).sum())
            self.assertEqual(set(structure.neighbours(run, gap=1e-9, box=[[0, 0, 0], [1.01] * 3])), {touching})  # some are outside it
            for order, q in ((4, q4), (6, q6)):
                self.assertTrue(np.allclose(structure.bond_order(run, 1.01, order), q, atol=1e-6), (touching, order))
            r, g = structure.radial_distribution(run, reach=1.1, bins=110)
            density = len(position) / size.prod() * (1 - 1 / len(position))
            self.assertAlmostEqual((g * density * 4 / 3 * np.pi * np.diff(np.linspace(0, 1.1, 111)**3)).sum(), touching, delta=1e-9)
            self.assertTrue(0.98 < r[g.argmax()] < 1.02)

    def test_bodies_at_random(self):
        """g is 1 within what so many pairs scatter, over periodic sides, between walls, of a kind and in a
        part of the domain."""
        position = np.random.default_rng(1).uniform(0, [2, 3, 1.5], (3000, 3))
        for periodic, options in (((True, True, True), {}), ((False, False, False), {}), ((True, False, True), {"kind": "odd"}),
                                  ((True, True, True), {"box": [[0.2, 0, 0.1], [1.6, 3, 1.5]]})):
            run = self.run_of(position, [2, 3, 1.5], periodic)
            r, g = structure.radial_distribution(run, 0.7, bins=14, **options)
            lower, upper = options.get("box", [[0, 0, 0], [2, 3, 1.5]])
            inside = ((position >= lower) & (position <= upper)).all(axis=1).sum() / (2 if "kind" in options else 1)
            pairs = inside**2 / 2 * 4 * np.pi * r**2 * 0.05 / np.prod(np.subtract(upper, lower)) * 0.5
            self.assertTrue((np.abs(g - 1) < 4 / np.sqrt(pairs) + 2e-3).all(), (periodic, options, g))

    def test_pairs_are_those_of_a_search_through_all(self):
        position = np.random.default_rng(2).uniform(0, [1, 1.3, 0.9], (200, 3))
        for periodic in ((True, False, True), (False, False, False)):
            run = self.run_of(position, [1, 1.3, 0.9], periodic, radius=0.06)
            away = position[:, None] - position
            away -= np.array(periodic) * [1, 1.3, 0.9] * np.round(away / [1, 1.3, 0.9])
            distance = np.linalg.norm(away, axis=2) + np.eye(200)
            for reach in (0.13, 0.3, 0.44):
                self.assertEqual(structure.neighbours(run, gap=reach - 0.12).tolist(), (distance <= reach).sum(axis=1).tolist())
        with self.assertRaisesRegex(ValueError, "reach is 0.5; along a periodic axis it must be at most half a period, 0.45"):
            structure.radial_distribution(self.run_of(position, [1, 1.3, 0.9]), 0.5)
        with self.assertRaisesRegex(ValueError, "no kind ball; there are even, odd"):
            structure.neighbours(run, kind="ball")


class Results(SiltTest):
    def setUp(self):
        super().setUp()
        self.write(CASE.replace("[output]", "[output]\nreport = { every = 20 }"))
        self.silt("run", self.case)
        self.results = silt_results.open(self.case)

    def test_case_and_folder_are_the_same(self):
        self.assertEqual(silt_results.open(self.out).report, self.results.report)
        self.assertEqual(self.results.report, self.report())

    def test_fields_are_by_x_y_z(self):
        field = self.results.fields[-1]
        self.assertEqual((field.step, field.time, field.size), (60, 60.0, (24, 16, 16)))
        with h5py.File(field.path) as file:
            raw = file["VTKHDF/PointData/velocity"][...]  # [z, y, x]
        self.assertTrue((field["velocity"] == raw.transpose(2, 1, 0, 3)).all())
        self.assertTrue((field.slice("velocity", y=3) == field["velocity"][:, 3]).all())
        self.assertTrue((field.slice("density", x=-1) == field["density"][-1]).all())
        self.assertEqual([len(field.x), field.x[0], field.upper[0]], [24, 0.5, 24])
        with self.assertRaisesRegex(KeyError, "vorticity.*has density, solid, velocity"):
            field["vorticity"]

    def test_fluid_in_a_body_moves_as_it_does(self):
        """So axes and bodies agree: cells near the centre of a body have its velocity."""
        field, bodies = self.results.fields[-1], self.results.bodies.at(-1)
        for x, v in zip(bodies["position"], bodies["velocity"]):
            cell = tuple(int(c) for c in x)
            self.assertTrue(np.allclose(field["velocity"][cell], v, atol=1e-3 + 0.01 * np.linalg.norm(v)), (cell, v))

    def test_structure(self):
        self.assertEqual(structure.neighbours(self.results, gap=2, index=[0, 1, 2]).tolist(), [0] * 6)
        self.assertTrue(np.isnan(structure.bond_order(self.results, reach=7)).all())
        self.assertEqual(structure.radial_distribution(self.results, reach=8)[1].sum(), 0)

    def test_scalars(self):
        series = self.results.series
        self.assertEqual(list(series["steps"]), [0, 20, 40, 60])
        self.assertEqual(series["energy.bodies"][-1], self.report()["energy"]["bodies"])
        self.assertTrue(np.isnan(series["momentum_drift"]).all())
        with open(self.out / "series.csv", "a") as stream:
            stream.write("80,80")  # cut off
        self.assertEqual(len(silt_results.Scalars(self.out / "series.csv")), 4)

    def test_what_is_missing_is_named(self):
        (self.out / "bodies.h5").unlink()
        with self.assertRaisesRegex(FileNotFoundError, r"bodies.h5: not there; .*output.bodies = \{ every = N \}"):
            silt_results.open(self.out).bodies

    def test_without_h5py(self):
        done = subprocess.run(["/usr/bin/python3", "-S", "-c", "import silt_results"], cwd=ROOT / "scripts", capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^silt_results: No module named 'h5py' \(/usr/bin/python3\); use /usr/bin/python3, with Debian's python3-h5py")

    def test_the_program_of_the_page(self):
        self.silt("run", ROOT / "cases" / "segregation", "--out", self.case / "segregation", "--set", "run.steps=4",
                  "--set", "output.bodies.every=2")
        page = (ROOT / "scripts" / "silt_results" / "README.md").read_text()
        program = re.search(r"\n\n((?:    .*\n|\n)+)", page[page.index("ten lines"):])[1]
        program = re.sub("^    ", "", program, flags=re.M).replace('"cases/segregation"', repr(str(self.case / "segregation")))
        with contextlib.redirect_stdout(io.StringIO()) as said:
            exec(program, {})  # noqa: S102
        self.assertIn("completed", said.getvalue())
        self.assertIn("(3, 200, 3) times, bodies, axes", said.getvalue())


if __name__ == "__main__":
    unittest.main()
