#!/usr/bin/python3
"""departures.py SILT: who leaves is in departures.csv, run.log, report.json and series.csv, the same on any
ranks and across a restart."""
import unittest

from silt_test import SiltTest
from silt_runs import body_of, domain_of, shape_of  # on the path by silt_test

# Three balls fly out: at 0.25 cells a step from 20, radius 2, one is wholly beyond 24 after 25 steps; one a
# step later; one into the outflow.
CASE = (domain_of([24, 24, 24], '{ x = "periodic", y = ["no-slip", { type = "no-slip", solid_for_bodies = false }], z = ["no-slip", { type = "no-slip", solid_for_bodies = false }] }') +
        "[[outflow]]\nbox = [[0, 0, 0], [24, 24, 4]]\n" + shape_of("ball", "sphere", "radius = 2") +
        body_of("ball", 2, "position = [6, 6, 20]", "velocity = [0, 0, 0.25]") +
        body_of("ball", 2, "position = [6, 19.75, 12]", "velocity = [0, 0.25, 0]") +
        body_of("ball", 2, "position = [18, 6, 12]", "velocity = [0, 0, -0.25]") + "[run]\nsteps = 60\n" +
        "[output]\nreport = { every = 20 }\ncheckpoint = { every = 30 }\nbodies = { every = 10 }\n")
LINES = [["25", "1", "z-high"], ["26", "2", "y-high"], ["32", "3", "outflow[0]"]]


class Departures(SiltTest):
    def test_all_files_tell(self):
        files = []
        for ranks in (1, 2, 3):
            self.write(CASE)
            self.silt("run", self.case, "--overwrite", ranks=ranks)
            self.assertEqual([[row["step"], row["id"], row["by"]] for row in self.rows("departures.csv")], LINES)
            self.assertEqual(float(self.rows("departures.csv")[0]["z"]), 26.25)
            files.append((self.out / "departures.csv").read_bytes())
            report = self.report()
            self.assertEqual(report["bodies_left"], 3)
            self.assertEqual(report["bodies_left_by"], {"y-high": 1, "z-high": 1, "outflow": 1})
            self.assertIn("2 by y-high; 1 by z-high", (self.out / "run.log").read_text())
        self.assertEqual(len(set(files)), 1)
        self.assertEqual([row["bodies_left_by.z-high"] for row in self.rows("series.csv")], ["0", "0", "1", "1"])

    def test_a_run_that_goes_on_tells_once(self):
        self.write(CASE)
        self.silt("run", self.case)
        whole = (self.out / "departures.csv").read_bytes()
        for path in self.out.glob("checkpoint_*60.h5"):
            path.unlink()
        self.silt("resume", self.case, ranks=2)
        self.assertEqual((self.out / "departures.csv").read_bytes(), whole)
        self.assertEqual(self.report()["bodies_left_by"], {"y-high": 1, "z-high": 1, "outflow": 1})


if __name__ == "__main__":
    unittest.main()
