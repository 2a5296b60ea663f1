#!/usr/bin/python3
"""reads_results.py SILT: silt_results gives what is in the files, and the program of its page runs as it stands."""
import contextlib
import io
import pathlib
import re
import sys
import unittest

import h5py
import numpy as np
from silt_test import CASE, SiltTest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "scripts"))

import silt_results  # noqa: E402


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
