#!/usr/bin/python3
"""The reference problems as far as they can be tested without running them: goals that a figure can meet,
cases that are cases, references read rightly.

problems.py [SILT]   # with the program, each case is also checked by it
"""
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
FOLDER = ROOT / "scripts" / "accuracy"
sys.path[:0] = [str(FOLDER), str(FOLDER.parent)]
SILT = sys.argv.pop(1) if sys.argv[1:] and pathlib.Path(sys.argv[1]).is_file() else None

from harness import problems  # noqa: E402
from harness.judge import as_found  # noqa: E402

MODULES = {name: problems.load(FOLDER, name) for name in problems.names(FOLDER)}
# whose figures make something of any numbers
OF_WHATEVER = ("arrays", "bed", "cavity", "conduction_arrays", "frontier", "heated_cavity", "heated_sphere", "inertial_arrays",
               "moving_array", "moving_hot_array", "taylor_green", "thermal_front")


class Whatever(dict):
    """Measurements of a run with any name, always the same number."""

    def __init__(self):
        super().__init__(error=0.9)

    def __missing__(self, name):
        return self["error"]


class Problems(unittest.TestCase):
    def for_each(self, look, names=MODULES):
        for name in names:
            with self.subTest(name):
                module, fault = MODULES[name]
                self.assertIsNone(fault)
                look(module)

    def test_every_goal_has_a_figure(self):
        """Figures come from runs that measured something, whatever it was."""
        def look(module):
            for level in ("short", "full"):
                if level == "full" or hasattr(module, "SHORT_GOALS"):
                    measured = {run.key: Whatever() for run in problems.runs_of(module, level)}
                    figures = {name: as_found(value) for name, value in module.figures(measured).items()}
                    self.assertLessEqual({goal.figure for goal in problems.goals_of(module, level)}, set(figures), level)
        self.for_each(look, OF_WHATEVER)

    def test_there_is_always_a_short_form_with_a_goal(self):
        def look(module):
            measured = {run.key: Whatever() for run in problems.runs_of(module, "short")}
            self.assertTrue({goal.figure for goal in problems.goals_of(module, "short")} & set(module.figures(measured)))
        self.for_each(look, OF_WHATEVER)

    def test_figures_without_runs(self):
        self.for_each(lambda module: self.assertEqual(module.figures({}), {}), OF_WHATEVER)

    def test_docstrings_say_what_it_is(self):
        self.for_each(lambda module: self.assertGreater(len(problems.summary(module)), 20))

    def test_every_goal_is_described(self):
        def look(module):
            for goal in (*module.GOALS, *getattr(module, "SHORT_GOALS", ())):
                claim = problems.claim_of(module, goal.figure)
                self.assertTrue(claim and claim.quantity and claim.regime and claim.resolution and claim.source, goal.figure)
                self.assertIn(claim.kind, ("theory", "experiment", "computation", "convergence"), goal.figure)
        self.for_each(look)

    @unittest.skipUnless(SILT, "needs the program")
    def test_cases_are_accepted(self):
        def look(module):
            for run in problems.runs_of(module, "short"):
                with tempfile.TemporaryDirectory() as folder:
                    for name, text in {"case.toml": run.case, **run.files}.items():
                        pathlib.Path(folder, name).write_text(text)
                    checked = subprocess.run([SILT, "check", folder], capture_output=True, text=True)
                self.assertEqual(checked.returncode, 0, f"{run.key}: {checked.stderr}")
        self.for_each(look)


class References(unittest.TestCase):
    def test_drag_of_arrays(self):
        """Table and series are two computations; Zick and Homsy's printed values a third."""
        import periodic_array
        self.assertAlmostEqual(periodic_array.exact_drag(0.064), 2.8102, places=4)
        self.assertAlmostEqual(periodic_array.exact_drag(0.064 * (1 + 1e-9)), periodic_array.exact_drag(0.064), places=6)
        for fraction, printed in ((0.125, 4.292), (0.343, 15.4), (0.45, 28.1)):
            self.assertLess(abs(periodic_array.exact_drag(fraction) / printed - 1), 1e-3)

    def test_cubes_have_the_solid_fraction(self):
        import periodic_array
        for fraction in (0.008, 0.064, 0.45):
            edge, diameter = periodic_array.cube_of(fraction, 8)
            self.assertAlmostEqual(math.pi / 6 * diameter**3 / edge**3, fraction)
            self.assertLess(abs(diameter - 8), 0.5)

    def test_cavity_lines(self):
        """Cubics between cells are exact; lid and far walls are where they belong."""
        import cavity
        import numpy as np
        middles = (np.arange(9) + 0.5) / 9
        for x in (0.01, 0.3, 0.77, 0.99):
            self.assertAlmostEqual(cavity.interpolated(middles**3 - 2 * middles, (0, -1), x), x**3 - 2 * x)
        for shape in ("cube", "square"):
            across, along = cavity.reference(shape)
            self.assertEqual(dict(across)[0], 1)   # the lid's velocity at the lid
            self.assertEqual(dict(across)[1], 0)
            self.assertEqual(dict(along)[0], 0)
            # what the lid drives to the far wall turns away from the lid there, and comes back to it at the near one
            self.assertGreater(max(along, key=lambda p: p[1])[0], 0.5)
            self.assertLess(min(along, key=lambda p: p[1])[0], 0.5)

    def test_energy_falls_by_what_is_dissipated(self):
        import taylor_green
        table = taylor_green.reference()
        for t in (1.0, 5.0, 9.0):
            loss = (table[t - 0.25][0] - table[t + 0.25][0]) / 0.5
            self.assertAlmostEqual(loss / table[t][1], 1, places=2)
        self.assertAlmostEqual(taylor_green.at(table, 5.0)[0], table[5.0][0])

    def test_arrays_have_their_solid_fraction_and_do_not_overlap(self):
        import inertial_arrays
        import numpy as np
        for lattice in inertial_arrays.MEMBERS:
            for phi in inertial_arrays.FRACTIONS:
                edge, diameter, centres = inertial_arrays.spheres_of(lattice, phi, 12, 1)
                self.assertAlmostEqual(len(centres) * math.pi / 6 * diameter**3 / edge**3, phi)
                self.assertLess(abs(diameter - 12), 0.6)
                away = centres[:, None] - centres[None]
                distance = np.linalg.norm(away - edge * np.round(away / edge), axis=-1) + 99 * np.eye(len(centres))
                self.assertGreater(min(distance.min(), edge), diameter)
                if lattice == "fcc":
                    self.assertAlmostEqual(distance.min(), edge / math.sqrt(2))

    def test_a_run_that_failed_is_not_the_best(self):
        """The worst of several errors is none where a run is missing."""
        import inertial_arrays
        measured = {run.key: Whatever() for run in inertial_arrays.runs("full")}
        worst = "accuracy.inertial_arrays.fcc.d12.worst_error"
        self.assertIn(worst, inertial_arrays.figures(measured))
        del measured["fcc.phi0.3.re50.d12.1"]
        self.assertNotIn(worst, inertial_arrays.figures(measured))

    def test_spheres_of_a_packing_rest_on_three(self):
        import numpy as np
        import packing
        bed = packing.packing(60, 4, 0)
        away = packing.across(bed[:, None] - bed[None], 4)
        distance = np.linalg.norm(away, axis=-1) + 9 * np.eye(len(bed))
        self.assertGreater(distance.min(), 1 + packing.GAP / 2)
        touching = distance < 1 + 2 * packing.GAP
        for sphere in np.flatnonzero(bed[:, 2]):
            supports = away[sphere][touching[sphere] & (away[sphere][:, 2] > 0)]  # from them to it
            self.assertGreaterEqual(len(supports), 3)
            angles = np.sort(np.arctan2(supports[:, 1], supports[:, 0]))
            self.assertLess(np.diff(angles, append=angles[0] + 2 * math.pi).max(), math.pi)  # on all sides of its weight
        self.assertAlmostEqual(packing.solid_fraction(bed, 4, -1, 9) * 10 * 16, 60 * math.pi / 6, places=3)
        top = bed[:, 2].max()
        self.assertTrue(0.55 < packing.solid_fraction(bed, 4, 0.5, top - 0.5) < 0.64)  # loose to close random packing

    def test_ergun(self):
        """His law for the bed, against the law written with the superficial velocity, the porosity and lengths in SI units."""
        import bed
        import packing
        viscosity, density, D = 1e-3, 998.0, 4e-3
        solid = packing.solid_fraction(bed.centres(), 4, 3, bed.centres()[:, 2].max() - 0.5)
        height = 60 * math.pi / 6 * D**3 / (16 * D**2) / solid
        for Re in bed.PASSING:
            U = Re * viscosity / (density * D)
            gradient = 150 * viscosity * solid**2 * U / ((1 - solid)**3 * D**2) + 1.75 * density * solid * U**2 / ((1 - solid)**3 * D)
            self.assertAlmostEqual(bed.ergun(Re) * density * U**2 / (gradient * height), 1)

    def test_a_front_spreads_by_its_diffusivity(self):
        """The error function is the front without an inlet near it."""
        import numpy as np
        import thermal_front
        x = np.arange(thermal_front.LENGTH) + 0.5
        front = lambda t: np.array([0.5 * math.erfc((place - 0.1 * t) / math.sqrt(4 * 0.05 * t)) for place in x])  # noqa: E731
        (x0, v0), (x1, v1) = (thermal_front.moments(front(t)) for t in (900, 1500))
        self.assertAlmostEqual(x1 - x0, 0.1 * 600, places=6)
        self.assertAlmostEqual(v1 - v0, 2 * 0.05 * 600, places=6)

    def test_images_of_a_charge_in_a_cube(self):
        """Madelung's constant by Evjen's sum over cubes, whose outermost charges count by the part that lies in the cube."""
        import heated_sphere
        import numpy as np
        n = 12
        i = np.arange(-n, n + 1)
        part = np.where(abs(i) == n, 0.5, 1)
        x, y, z = np.meshgrid(i, i, i, indexing="ij")
        r = np.sqrt(x**2 + y**2 + z**2)
        r[n, n, n] = math.inf
        charges = (-1.0)**(x + y + z + 1) * part[:, None, None] * part[:, None] * part
        self.assertAlmostEqual((charges / r).sum(), heated_sphere.MADELUNG, places=3)
        self.assertAlmostEqual(heated_sphere.in_cube(1e6), 2, places=5)

    def test_layers_of_arrays_are_all_spheres(self):
        """A sphere on a plane counts by its half; heights and places are symmetric about the middle."""
        import conduction_arrays
        for name, places in conduction_arrays.PLACES.items():
            layers = conduction_arrays.layers_of(name)
            self.assertEqual(sum(0.5 if height in (0, 1) else 1 for height, _ in layers), len(places))
            self.assertEqual(sorted(layers), sorted((1 - height, place) for height, place in layers))

    def test_the_largest_between_cells(self):
        import heated_cavity
        import numpy as np
        x = (np.arange(20) + 0.5) / 20
        place, value = heated_cavity.largest(3 - (x - 0.317)**2)
        self.assertAlmostEqual(place, 0.317)
        self.assertAlmostEqual(value, 3)
        self.assertAlmostEqual(heated_cavity.at_middle(x**3 - x), 0.5**3 - 0.5)


if __name__ == "__main__":
    unittest.main()
