#!/usr/bin/python3
"""sweeps.py SILT: scripts/sweep runs a case with each choice of values once, goes on with what was broken
off, and says what came out."""
import csv
import json
import pathlib
import re
import signal
import subprocess
import sys
import time
import unittest
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.append(str(ROOT / "tests"))

from run_script import run_script  # noqa: E402
from silt_test import CASE, ENVIRONMENT, SILT, SiltTest  # noqa: E402

SWEEP = ROOT / "scripts/sweep"


class Sweeps(SiltTest):
    def setUp(self):
        super().setUp()
        self.write(CASE.replace("[output]", "[output]\nreport = { every = 10 }").replace("steps = 60", "steps = 30"))
        self.folder = self.case / "sweep"

    def sweep(self, *arguments, code=0):
        done = run_script(SWEEP, self.case, "--silt", SILT, *arguments, "--no-pictures", env=ENVIRONMENT)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def table(self):
        with open(self.folder / "sweep.csv", newline="") as stream:
            return list(csv.DictReader(stream))

    def test_each_choice_is_run_once(self):
        said = self.sweep("--vary", "fluid.relaxation_time=0.7,0.9", "--jobs", 2)
        self.assertEqual(said.count(": begins"), 2)
        rows = self.table()
        self.assertEqual([row["fluid.relaxation_time"] for row in rows], ["0.7", "0.9"])
        for row in rows:
            report = self.report(self.folder / row["folder"])
            self.assertEqual(report["overrides"], [f"fluid.relaxation_time={row['fluid.relaxation_time']}"])
            self.assertEqual((float(row["height"]), row["exit_reason"], row["steps"]), (report["quantities"]["height"], "completed", "30"))
        page = (self.folder / "sweep.html").read_text()
        links = [urllib.parse.unquote(link) for link in re.findall('href="([^"#]+)"', page)]
        self.assertTrue(all((self.folder / link).exists() for link in links) and len(links) == 2, links)
        figures = re.findall("<figure>(<svg.*?</svg>)", page, flags=re.S)
        self.assertTrue(all("relaxation_time=0.7" in f and "relaxation_time=0.9" in f for f in figures[1:]) and len(figures) > 4)
        self.assertIn(">fluid.relaxation_time<", figures[0])  # the axis of the quantity over the key
        said = self.sweep("--vary", "fluid.relaxation_time=0.7,0.9,0.8")
        self.assertEqual((said.count("was completed before"), said.count(": begins")), (2, 1))
        self.assertEqual(len(self.table()), 3)
        said = self.sweep("--vary", "fluid.relaxation_time=0.7", "--set", "run.steps=20", code=2)
        self.assertIn("has runs with another --set or --unset: choose another folder with --out, or begin again with --overwrite", said)

    def test_warnings_of_its_runs_are_said(self):
        said = self.sweep("--vary", "shapes[0].radius=2.5,3")
        self.assertEqual(re.findall("    (warning: .*below 6 its drag is inaccurate)", said), ["warning: bodies[0].shape: shape 'ball' is 5 cells across; below 6 its drag is inaccurate"])

    def test_a_run_that_was_broken_off_goes_on(self):
        text = CASE.replace("steps = 60", "steps = 1200").replace("every = 25", "every = 300").replace("fields = { every = 20 }\nbodies = { every = 7 }\n", "")
        self.write(text)
        self.silt("run", self.case, "--set", "gravity.acceleration=[0, 0, -1e-5]")
        command = [SWEEP, self.case, "--silt", SILT, "--no-pictures", "--vary", "gravity.acceleration=[0, 0, -1e-5],[0, 0, 1e-5]"]
        begun = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
        while not list(self.folder.glob("*/checkpoint_*.h5")):
            time.sleep(0.02)
        begun.send_signal(signal.SIGINT)
        said, wrong = begun.communicate(timeout=60)
        self.assertEqual(begun.returncode, 4, said + wrong)
        self.assertIn("the same command goes on", wrong)
        self.assertEqual([row["exit_reason"] for row in self.table()], ["interrupted", "not run"])
        self.write(text + "\n")
        self.assertIn("has runs with another case.toml", self.sweep(*command[5:], code=2))
        self.write(text)
        said = self.sweep(*command[5:])
        self.assertEqual((said.count(": goes on"), said.count(": begins")), (1, 1), said)
        first = self.report(self.folder / self.table()[0]["folder"])
        self.assertGreater(first["resumed_at"], 0)
        self.assertEqual(first["state_hash"], self.report()["state_hash"])

    def test_what_cannot_be_run_is_told_before_anything_is(self):
        for vary, text in (("fluid.relaxation_time=0.7,0.4", r"relaxation_time=0.4 cannot be run\n--set fluid.relaxation_time=0.4: .*it must be above 0.5"),
                           ("fluid.relaxation_time", "it must be a key and its values, as in"),
                           ("fluid.relaxation_time=0.7,0.7", "a value is given twice")):
            self.assertRegex(self.sweep("--vary", vary, code=2), text)
        self.assertFalse(list(self.folder.glob("*/")))
        self.assertIn("is given twice: give all its values at once", self.sweep("--vary", "run.steps=1", "--vary", "run.steps=2", code=2))
        self.assertIn("unrecognized arguments: --time", self.sweep("--vary", "run.steps=1", "--time", "1", code=2))
        self.assertIn("nor has Silt a case of that name", run_script(SWEEP, "nowhere", "--vary", "run.steps=1").stderr)

    def test_a_run_that_stops_is_told_and_the_others_go_on(self):
        vary = ("--vary", "bodies[0].density=0.05,1.5", "--set", 'coupling.time="explicit"', "--set", "bodies[0].velocity=[0.05, 0, 0]")
        self.sweep(*vary, "--collect")
        self.assertEqual([row["exit_reason"] for row in self.table()], ["not run", "not run"])
        said = self.sweep(*vary, code=1)
        self.assertEqual([row["exit_reason"] for row in self.table()], ["guard", "completed"], said)
        self.assertRegex(said, "density=0.05: guard")

    def test_slurm_gets_a_script_for_each(self):
        options = ("--slurm", "--time", "00:20:00", "--partition", "short", "--no-submit", "-n", 2)
        self.sweep("--vary", "fluid.relaxation_time=0.7", *options)
        script = self.folder / "fluid.relaxation_time=0.7.sh"
        self.assertRegex(script.read_text(), r"(?s)--partition=short.*mpirun -n 2 .*silt run .*sweep/fluid.relaxation_time=0.7 .*--set fluid.relaxation_time=0.7")
        self.silt("run", self.case, "--out", script.with_suffix(""), "--set", "fluid.relaxation_time=0.7", "--time-limit", 1e-9, code=4)
        self.sweep("--vary", "fluid.relaxation_time=0.7", *options)
        self.assertIn(" resume ", script.read_text())
        self.assertEqual(json.loads((self.folder / "sweep.json").read_text())["options"], [])


if __name__ == "__main__":
    unittest.main()
