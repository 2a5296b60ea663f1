#!/usr/bin/python3
"""output_page.py SILT: cases/OUTPUT.md names every file, key, column and data set of a run, and none that is
not there."""
import csv
import json
import re
import subprocess
import unittest

import h5py
from silt_test import CASE, CHANNEL, ROOT, SiltTest

import silt_results  # on the path by silt_test

PAGE = ROOT / "cases" / "OUTPUT.md"

# of a run that was stopped, of one that went on, with coarser cells, with bodies of many sizes, on a graphics processor
SOMETIMES = {"exit_text", "resumed_at", "levels", "sizes", "bodies/scale", "bodies/spring_force", "bodies/spring_torque", "card", "bus", "bus.bytes_per_body_and_step", "bus.pages_touched_per_step"}


def section(name):
    """Returns the names in backquotes in the first cells of a section's table."""
    text = PAGE.read_text()
    begin = text.index(f"## `{name}`")
    end = text.find("\n## ", begin + 1)
    rows = re.findall(r"^\| (`[^|]*?) \|", text[begin:end if end > 0 else None], re.M)
    return {word for row in rows for word in re.findall(r"`([^`]+)`", row)}


def data_sets(path):
    found = set()
    with h5py.File(path) as file:
        file.visititems(lambda name, item: found.add(name) if isinstance(item, h5py.Dataset) else None)
    return found


class Page(SiltTest):
    def setUp(self):
        super().setUp()
        fields = 'fields = { every = 20, quantities = ["velocity", "density", "pressure", "shear-rate", "vorticity", "body-id"] }'
        text = CASE.replace("[output]", "[output]\nreport = { every = 20 }").replace("fields = { every = 20 }", fields)
        self.write(text.replace("every = 7 }", "every = 7, contacts = true }"))
        self.silt("run", self.case)

    def test_names_every_file(self):
        text = PAGE.read_text()
        for path in self.out.iterdir():
            name = re.sub(r"_\d+\.", "_STEP.", path.name)
            self.assertIn(f"`{name}`", text)

    def test_report(self):
        self.assertEqual(set(self.report()), section("report.json") - SOMETIMES)

    def test_data_sets(self):
        self.assertEqual(data_sets(self.out / "bodies.h5"), section("bodies.h5") - SOMETIMES)
        self.assertEqual(data_sets(next(self.out.glob("fields_*.hdf"))), section("fields_STEP.hdf"))
        with h5py.File(self.out / "scene.h5") as file:
            self.assertLessEqual(set(file.attrs) | set(file), section("scene.h5"))

    def test_columns(self):
        text = PAGE.read_text()
        with open(self.out / "series.csv", newline="") as stream:
            names = next(csv.reader(stream))
        for name in names:
            name = re.sub(r"^(momentum.*)\.[yz]$", r"\1.x", name)
            name = re.sub(r"^stage_seconds\..*\.avg$", "stage_seconds.STAGE.avg", re.sub(r"^quantities\..*", "quantities.NAME", name))
            self.assertIn(f"`{name}`", text)


class Series(SiltTest):
    """series.csv against report.json, bodies.h5 and what mechanics says."""
    REPORTS = CASE.replace("[output]", "[output]\nreport = { every = 20 }").replace("every = 7 }", "every = 20 }")

    def test_last_row_is_the_report(self):
        self.write(self.REPORTS)
        self.silt("run", self.case)
        rows, report = self.rows("series.csv"), self.report()
        self.assertEqual([row["steps"] for row in rows], ["0", "20", "40", "60"])
        self.assertEqual(float(rows[-1]["quantities.height"]), report["quantities"]["height"])
        self.assertEqual(float(rows[-1]["momentum.fluid.z"]), report["momentum"]["fluid"][2])
        self.assertEqual(rows[-1]["momentum_drift"], "")

    def test_means_say_so(self):
        """A quantity is that of its step; the mean over the steps from its time on has a column of its own."""
        self.write(CHANNEL.replace("steps = 10000\nsteady = { quantity = \"energy\", change = 1e-3, every = 100 }", "steps = 40")
                   .replace("checkpoint = { every = 250 }", "report = { every = 1 }\ncheckpoint = { every = 17 }") + """
[[quantities]]
name = "drag"
type = "wall-stress"
side = "z-low"
axis = "x"
time = 20
""")
        self.silt("run", self.case, "--steps", 34)
        self.silt("resume", self.case, "--set", "run.steps=40")
        rows, report = self.rows("series.csv"), self.report()
        now = [float(row["quantities.drag"] or "nan") for row in rows]
        self.assertEqual(len(now), 41)
        self.assertGreater(now[19], 0)  # before its time, too
        for step, row in enumerate(rows):
            if step < 20:
                self.assertEqual(row["means.drag"], "")
            else:
                self.assertAlmostEqual(float(row["means.drag"]), sum(now[20:step + 1]) / (step - 19), delta=1e-12 * now[step])
        self.assertEqual(report["quantities"]["drag"], float(rows[-1]["means.drag"]))
        self.assertEqual(report["quantities_in_last_step"]["drag"], now[-1])
        self.assertEqual(report["quantity_types"]["drag"]["type"], "wall-stress")

    def test_energy_and_momentum_of_bodies(self):
        import math
        self.write(self.REPORTS)
        self.silt("run", self.case)
        mass = 1.5 * 4 / 3 * math.pi * 2.5**3
        inertia = 0.4 * mass * 2.5**2
        with h5py.File(self.out / "bodies.h5") as file:
            v = file["bodies/velocity"][:].reshape(-1, 2, 3)
            w = file["bodies/angular_velocity"][:].reshape(-1, 2, 3)
        for row, v, w in zip(self.rows("series.csv"), v, w):
            self.assertAlmostEqual(float(row["energy.bodies"]), 0.5 * (mass * (v**2).sum() + inertia * (w**2).sum()), delta=1e-12)
            self.assertAlmostEqual(float(row["momentum.bodies.x"]), mass * v[:, 0].sum(), delta=1e-11)

    def test_same_on_any_ranks(self):
        self.write(self.REPORTS)
        self.silt("run", self.case)
        alone = self.rows("series.csv")
        self.silt("run", self.case, ranks=4)
        clocks = re.compile("seconds|mlups")
        for a, b in zip(alone, self.rows("series.csv")):
            self.assertEqual({k: x for k, x in a.items() if not clocks.search(k)}, {k: x for k, x in b.items() if not clocks.search(k)})

    def test_goes_on_where_the_run_does(self):
        self.write(self.REPORTS)
        self.silt("run", self.case, "--steps", 50)
        with open(self.out / "series.csv", "a") as stream:  # of a run that was killed later on
            stream.write(self.rows("series.csv")[-1]["steps"].join(["", "9,1,"]) + "\n70,1,2")
        self.silt("resume", self.case, "--set", "run.steps=60")
        self.assertEqual([row["steps"] for row in self.rows("series.csv")], ["0", "20", "40", "50", "60"])

    def test_odd_names(self):
        """Names with what CSV takes for its own: read by Python's csv, by silt_results, by the pages, and by
        a run that goes on."""
        names = ["drag, total", 'say "x"', "a\nb", "c\rd\r\ne", '"', ",", "'", " ü ", "a.b", "torque.max", "low.min", "=1+1", "$x^", "_1",
                 "\u2028\u0085\x0b", "#", "\\", "<b>&amp;"]
        quantities = "".join(f"[[quantities]]\nname = {json.dumps(name)}\ntype = \"mean-height\"\n" for name in names)
        self.write(self.REPORTS + quantities)
        self.silt("run", self.case, "--steps", 50)
        self.silt("resume", self.case, "--set", "run.steps=60")
        report, rows = self.report(), self.rows("series.csv")
        self.assertEqual(list(report["quantities"]), ["height", *names])
        self.assertEqual([row["steps"] for row in rows], ["0", "20", "40", "50", "60"])
        series = silt_results.open(self.out).series
        for name in names:
            column = f"quantities.{name}"
            self.assertEqual([float(row[column]) for row in rows], list(series[column]))
            self.assertEqual(float(rows[-1][column]), report["quantities"][name])
            self.assertEqual({len(row) for row in rows}, {len(series.names)})
        for script in ("plot", "report"):
            done = subprocess.run([ROOT / "scripts" / script, self.case], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("&lt;b&gt;&amp;amp;", (self.out / "report.html").read_text())

    def test_other_columns_begin_another_file(self):
        self.write(self.REPORTS)
        self.silt("run", self.case, "--steps", 50)
        text = (self.out / "series.csv").read_text()
        (self.out / "series.csv").write_text(text.replace("quantities.height", "quantities.depth"))
        self.silt("resume", self.case, "--set", "run.steps=60")
        self.assertEqual([row["steps"] for row in self.rows("series.csv")], ["60"])
        self.assertEqual(len((self.out / "series.1.csv").read_text().splitlines()), 5)


if __name__ == "__main__":
    unittest.main()
