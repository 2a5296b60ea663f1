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
OF_WHATEVER = ("arrays", "cavity", "frontier", "moving_array", "taylor_green")


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


if __name__ == "__main__":
    unittest.main()
