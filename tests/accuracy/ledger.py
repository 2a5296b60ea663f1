#!/usr/bin/python3
"""scripts/ledger with a problem and a program made up for it (bench_accuracy.py), and what docs/ledger.csv says."""
import csv
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "tests/accuracy"), str(ROOT / "scripts")]

import bench_accuracy  # noqa: E402
import claims  # noqa: E402
from run_script import run_script  # noqa: E402

CLAIMS = '''
from problem import Claim
SHORT_GOALS = [Goal("accuracy.square.d5.error", 5)]
CLAIMS = {"accuracy.square.d{D}.error": Claim("value of the square", "h = 1/{D}", "D = {D}", "arithmetic", doi="10.1000/182", kind="theory",
                                               expected=lambda D: 2.0, uncertainty="0", note="so few")}
'''


class Ledger(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="silt-ledger-")
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.stored, self.problem, self.silt = self.folder / "ledger.csv", self.folder / "problems/square.py", self.folder / "silt"
        self.problem.parent.mkdir()
        self.problem.write_text(bench_accuracy.PROBLEM + CLAIMS)
        self.silt.write_text(bench_accuracy.PROGRAM.replace("COUNT", repr(str(self.folder / "count"))))
        self.silt.chmod(0o755)

    def ledger(self, *arguments, code=0):
        done = run_script(ROOT / "scripts/ledger", *arguments, "--silt", self.silt, "--folder", self.problem.parent, "--stored", self.stored,
                          "--out", self.folder / "out")
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout

    def rows(self, path=None):
        with open(path or self.stored, newline="") as stream:
            return {row["claim"]: row for row in csv.DictReader(stream)}

    def test_full_form_is_stored_and_a_miss_stays(self):
        self.assertIn("missed: accuracy.square.d2.error: 2.5, expected 2, error +25 %, tolerance 20 %: so few", self.ledger("--full", "square"))
        rows = self.rows()
        row = rows["accuracy.square.d10.error"]
        wanted = dict(problem="square", form="full", regime="h = 1/10", resolution="D = 10", source="arithmetic", doi="10.1000/182", expected="2",
                      uncertainty="0", measured="2.02", error="+1 %", tolerance="1.01 %", verdict="within", core_seconds="1e+04", commit="abc")
        self.assertEqual({name: row[name] for name in wanted}, wanted)
        self.assertEqual(rows["accuracy.square.d2.error"]["verdict"], "missed")
        self.assertEqual((rows["accuracy.square.d5.error"]["form"], rows["accuracy.square.d5.error"]["verdict"]), ("short", "within"))
        self.assertEqual(rows["settling-sphere.max_settling_velocity"]["verdict"], "not measured")
        text = self.stored.with_suffix(".html").read_text()
        for part in ("<span class=missed>missed</span>", "https://doi.org/10.1000/182", "<svg", "So few"):
            self.assertTrue(part in text, part)
        for part in ("<script", "src=", "url(", "<link"):
            self.assertFalse(part in text, part)
        self.ledger("--check")
        self.problem.write_text(self.problem.read_text().replace("20)", "30)"))  # another tolerance: judged anew, not run
        self.assertIn("ledger.csv is not what", self.ledger("--check", code=1))
        self.ledger()
        self.assertEqual(self.rows()["accuracy.square.d2.error"]["verdict"], "within")
        self.problem.write_text(self.problem.read_text().replace("30)", "20)").replace(', note="so few"', ""))
        self.assertIn("NO NOTE", self.ledger(code=1))

    def test_short_form_fails_with_its_goals(self):
        self.ledger("--short", "square")
        self.assertFalse(self.stored.exists())
        rows = self.rows(self.folder / "out/ledger.csv")
        self.assertEqual({name: row["verdict"] for name, row in rows.items()}, {"accuracy.square.d5.error": "within"})
        self.problem.write_text(self.problem.read_text().replace("error\", 5)", "error\", 3)"))
        self.ledger("--short", "--collect", "square", code=1)

    def test_usage(self):
        self.ledger("--full", code=2)
        self.ledger("--short", "squaer", code=2)


class Stored(unittest.TestCase):
    def test_is_what_problems_and_cases_claim(self):
        done = subprocess.run([ROOT / "scripts/ledger", "--check"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_cases(self):
        quantity = dict(name="v", value=2.0, tolerance=0.1, relative=True, kind="theory", source="s")
        row = claims.case_row(ROOT / "cases/settling-sphere", quantity, "full", claims.Measured(2.1))
        self.assertEqual((row.claim, row.verdict, row.error, row.resolution), ("settling-sphere.v", "within", "+5.00 %", "D = 9"))
        self.assertAlmostEqual(row.margin, 0.5)
        row = claims.case_row(ROOT / "cases/torus", dict(name="v", between=[1, 3], kind="theory", source="s"), "short", claims.Measured(4))
        self.assertEqual((row.claim, row.verdict, row.error, row.margin), ("torus.short.v", "missed", "outside", 2))


if __name__ == "__main__":
    unittest.main()
