#!/usr/bin/python3
"""estimates.py SILT: what `silt check` foresees of memory and disk is within a factor of 2 of a run, and it
foresees time for output (how much: tests/stress/time_of_output.py). More than the disk has, or years, are
warned of, and a pressure that compresses the fluid, and heat carried too fast."""
import math
import re
import resource
import statistics
import unittest

from silt_test import CASE, SiltTest, script
from silt_runs import fill_of, shape_of  # on the path by silt_test


def number(said, name):
    value, unit = re.search(rf"^  {name} +([0-9.]+) (MB|GB|TB|s)", said[said.index("estimate ("):], re.M).groups()
    return float(value) * {"MB": 1e6, "GB": 1e9, "TB": 1e12, "s": 1}[unit]


class Estimates(SiltTest):
    LARGE = CASE.replace("[24, 16, 16]", "[120, 80, 80]").replace("blocks = [6, 8, 16]\n", "").replace("radius = 2.5", "radius = 5")

    def test_memory_and_disk_of_a_run(self):
        self.write(self.LARGE.replace("[[6, 8, 8], [18, 8, 9]]", "[[30, 40, 40], [90, 40, 45]]"))
        said = self.silt("check", self.case).stdout
        self.silt("run", self.case)
        files = sum(path.stat().st_size for path in self.out.iterdir())
        for found, foreseen in ((self.report()["memory_peak_bytes"]["max"], number(said, "memory")), (files, number(said, "disk"))):
            self.assertLess(found / 2, foreseen)
            self.assertLess(foreseen, 2 * found)
        self.assertGreater(number(said, "time"), 0)
        self.assertIn("on 1 rank of this machine, on idle cores)", said)

    def test_heat_takes_memory(self):
        """Seven numbers a cell: those of a run, less those of one without heat."""
        self.write(self.LARGE.replace("[[6, 8, 8], [18, 8, 9]]", "[[30, 40, 40], [90, 40, 45]]"))
        found, foreseen = [], []
        for heat in ([], ["--set", "heat.prandtl=1"]):
            foreseen.append(number(self.silt("check", self.case, *heat).stdout, "memory"))
            self.silt("run", self.case, "--overwrite", *heat)
            found.append(self.report()["memory_peak_bytes"]["max"])
        for memory in (found, foreseen):
            self.assertAlmostEqual((memory[1] - memory[0]) / (7 * 4 * 120 * 80 * 80), 1, delta=0.15)

    # Nine spheres of 8 cells in a column, a cell apart, in the stream of an inlet; 20 % solid in between.
    COLUMN = """[units]
system = "lattice"
[domain]
size = [12, 12, 100]
boundary = { x = "periodic", y = "periodic", z = [{ type = "velocity-inlet", velocity = [0, 0, %g] }, "pressure-outlet"] }
[fluid]
relaxation_time = 0.8
initial = { type = "uniform", velocity = [0, 0, %g] }
[gravity]
acceleration = [0, 0, -1e-5]
[[shapes]]
name = "ball"
type = "sphere"
radius = 4
[[bodies]]
shape = "ball"
density = 1.5
motion = "%s"
positions = [%s]
[run]
steps = 4000
"""
    FORESEEN = r"warning: the bodies that stand in the stream from \S+ let the pressure fall .* the density (\S+) % higher .*: give all velocities times (\S+)"

    def column(self, speed, motion="fixed"):
        self.write(self.COLUMN % (speed, speed, motion, ", ".join(f"[6, 6, {12 + 9 * k}]" for k in range(9))))
        return re.search(self.FORESEEN, self.silt("check", self.case).stdout)

    def test_a_pressure_that_compresses_the_fluid(self):
        foreseen = self.column(0.02)
        self.silt("run", self.case)
        found = 100 * (self.report()["max_density"] - 1)
        self.assertLess(abs(float(foreseen[1]) / found - 1), 0.35, f"foreseen {foreseen[1]} %, found {found} %")
        self.assertIsNone(self.column(0.02 * float(foreseen[2])**2))  # drag here is of the first power of the speed
        self.assertIsNone(self.column(0.02, "free"))  # they weigh less than that

    def test_bodies_that_fall_compress_it_by_their_weight(self):
        """However slow the stream is: they hang in the fluid, spread over the column, until they have settled."""
        self.write((self.COLUMN % (1e-3, 1e-3, "free", ", ".join(f"[6, 6, {12 + 9 * k}]" for k in range(9)))).replace("-1e-5", "-1.2e-3"))
        foreseen = float(re.search(self.FORESEEN, self.silt("check", self.case).stdout)[1])
        weight = 9 * 4 / 3 * math.pi * 4**3 * 0.5 * 1.2e-3
        self.assertLess(abs(foreseen / (100 * 3 * weight / 144) - 1), 0.02)
        self.silt("run", self.case, "--steps", 1300, "--set", "output.report={ every = 50 }")  # twice the time of sound there and back
        found = 100 * (statistics.mean(float(row["max_density"]) for row in self.rows("series.csv")) - 1)
        self.assertLess(abs(foreseen / found - 1), 0.35, f"foreseen {foreseen} %, found {found} %")

    def test_heat_that_a_ball_carries_too_far(self):
        """It is warned of before the run, for the ball, and after it, for the fluid that the ball moves."""
        for diffusivity, far in ((1e-4, True), (0.1, False)):
            heat = f"[heat]\nthermal_diffusivity = {diffusivity}\n[gravity]"
            self.write(CASE.replace("[gravity]", heat).replace("velocity = [0.02, 0, 0]\n", "").replace("-1e-4", "-1e-3"))
            said = self.silt("run", self.case, "--overwrite", "--steps", 1000).stdout
            self.assertEqual(self.report()["max_velocity_lattice"] > 30 * diffusivity, far)
            for warned in ("bodies.0. comes to", "the fluid came to"):
                self.assertEqual(bool(re.search(warned + ".* above 30 waves of temperature grow", said)), far, said)

    def test_bodies_that_cover_an_inlet(self):
        """As much less flows in as is foreseen, and none of a ball that leaves half a diameter."""
        covered = r"warning: bodies cover (\d+) % of the inlet domain.boundary.z\[0\]"
        for height, wanted in ((4, True), (9, False)):
            self.write(self.COLUMN % (0.01, 0.01, "fixed", f"[6, 6, {height}]") + '[[quantities]]\nname = "rate"\ntype = "flow-rate"\nat = 20\n')
            foreseen = re.search(covered, self.silt("check", self.case).stdout)
            run = self.silt("run", self.case, "--overwrite", "--steps", 8000)
            self.assertEqual((bool(foreseen), bool(re.search(covered, run.stdout + run.stderr))), (wanted, wanted))
            found = 100 * (1 - self.report()["quantities"]["rate"] / (0.01 * 144))
            self.assertLess(abs(found - float(foreseen[1] if foreseen else 0)), 2.5, found)
        self.write((self.COLUMN % (1e-3, 1e-3, "free", "[6, 6, 9]")).replace("-1e-5", "-1.2e-3"))  # it falls onto the inlet
        self.assertNotRegex(self.silt("check", self.case).stdout, covered)
        self.assertRegex(self.silt("run", self.case, "--overwrite").stdout, covered)

    def test_output_takes_time(self):
        """Whatever is written adds to what is foreseen."""
        self.write(self.LARGE.replace("fields = { every = 20 }\nbodies = { every = 7 }\ncheckpoint = { every = 25, keep = 3 }\n", ""))
        alone = number(self.silt("check", self.case).stdout, "  of it for output")
        for output in ("report={ every = 1 }", "fields={ every = 3 }", "checkpoint={ every = 1 }", "slices=[{ name = 'a', every = 1, box = [[0, 40, 0], [1e4, 40, 1e4]] }]"):
            said = self.silt("check", self.case, "--set", f"output.{output}").stdout
            self.assertGreater(number(said, "  of it for output"), alone, output)
        stress = "quantities=[{ name = 'a', type = 'viscous-stress', component = 'xz', over = [0, 1e4] }]"
        self.assertGreater(number(self.silt("check", self.case, "--set", stress).stdout, "  of it for output"), 10 * alone)

    def test_contacts_of_meshes_take_time(self):
        """A bed of rings takes hundreds of times as long as one of balls, by its contacts of triangles."""
        script("make_mesh", "torus", self.case / "ring.stl", "--radius", 3, "--tube", 1.2, "--triangles", 800)
        dry = CASE.split("[fluid]")[0].replace("[24, 16, 16]", "[60, 60, 60]").replace("blocks = [6, 8, 16]\n", "")
        dry += "[gravity]\nacceleration = [0, 0, -1e-4]\n" + fill_of("ring", 2, 60) + "[run]\nsteps = 1000\n"
        took = []
        for ring in (shape_of("ring", "sphere", "radius = 4.2"), shape_of("ring", "mesh", 'file = "ring.stl"')):
            self.write(dry + ring)
            took.append(number(self.silt("check", self.case).stdout, "time"))
        self.assertGreater(took[1], 30 * took[0])

    def test_shares_of_ranks(self):
        """All the work that is no cell's is in one corner: of two equal halves one has nearly all of it, of
        cut ones none has much more."""
        self.write(CASE.split("[fluid]")[0].replace("blocks = [6, 8, 16]\n", "").replace("[24, 16, 16]", "[96, 48, 48]") + """
[[shapes]]
name = "ball"
type = "sphere"
radius = 1
[[fill]]
shape = "ball"
density = 1
count = 800
box = [[0, 0, 0], [24, 48, 48]]
[run]
steps = 10
""")
        for settings, low, high in ((["--set", "domain.blocks=[48, 48, 48]"], 1.99, 2), ([], 1, 1.1)):
            said = self.silt("check", self.case, "-n", 2, *settings).stdout
            found = float(re.search(r"largest over mean +([0-9.]+)", said)[1])
            self.assertTrue(low <= found <= high, said)
        self.assertNotIn("largest over mean", self.silt("check", self.case).stdout)

    def test_a_large_domain_takes_no_longer(self):
        """The work of a domain is estimated from boxes and bodies: at ten times the length a walk over cells
        would take a thousand times as long."""
        dry = CASE[:CASE.index("[fluid]")].replace("blocks = [6, 8, 16]\n", "") + CASE[CASE.index("[[shapes]]"):CASE.index("[output]")]

        def seconds(size):
            self.write(dry.replace("[24, 16, 16]", f"[{size}, {size}, {size}]").replace("radius = 2.5", f"radius = {size / 50}")
                       .replace("[[6, 8, 8], [18, 8, 9]]", f"[[{size // 4}, {size // 2}, {size // 2}]]"))
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            self.silt("check", self.case, "-n", 2)
            return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        self.assertLess(seconds(10000), seconds(1000) + 1)

    def test_what_no_disk_and_nobody_has_is_warned_of(self):
        settings = ["--set", "run.steps=10000000000000", "--set", "output.fields.every=1"]
        said = self.silt("check", self.case, *settings).stdout
        self.assertRegex(said, r"case.toml:\d+:\d+: warning: the files of the run take about .* TB, and .* left: write less often")
        self.assertRegex(said, r"--set run.steps=10000000000000: warning: run.steps is 10000000000000 steps, which take about .* years")
        self.assertNotIn("warning: the files", self.silt("check", self.case).stdout)


if __name__ == "__main__":
    unittest.main()
