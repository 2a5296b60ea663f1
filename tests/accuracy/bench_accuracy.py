#!/usr/bin/python3
"""scripts/bench accuracy itself, with problems and a program made up for it.

The program "runs" a case by writing a report whose quantity is 1 + h^2, h being the case's fluid.h; it counts its runs
in a file beside it, and does as the case says: fail = true ends with code 3, and so on.
"""
import csv
import json
import pathlib
import stat
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.append(str(ROOT / "tests"))

from run_script import run_script  # noqa: E402

MAIN = ROOT / "scripts" / "accuracy" / "harness" / "main.py"

PROGRAM = '''#!/usr/bin/python3
import json, pathlib, sys, tomllib
command, case, option, out = sys.argv[1:5]
assert (command, option) == ("run", "--out")
text = pathlib.Path(case, "case.toml").read_text()
with open(COUNT, "a") as count:
    count.write("run\\n")
print("the log of", case)
setup = tomllib.loads(text)
if setup.get("fail"):
    print("it blew up in step 7")
    sys.exit(3)
pathlib.Path(out).mkdir()
h = setup["h"]
report = dict(quantities=dict(value=1 + h * h), step_seconds=h**-4, wall_seconds=1.0, steps=10, mlups=5.0, stage_seconds={},
              commit="abc")
pathlib.Path(out, "report.json").write_text(json.dumps(report))
'''

PROBLEM = '''"""A square law. The second line."""
from problem import Curve, Found, Goal, Run
GOALS = [Goal("accuracy.square.d10.error", 1.01), Goal("accuracy.square.d2.error", 20)]

def runs(level):
    return [Run(f"d{D}", f"h = {1 / D}", settings={"scheme": "cli", "D": D}) for D in ((5, 10) if level == "short" else (2, 5, 10))]

def measure(run, outcome):
    return {"error": 100 * (outcome.quantity("value") - 1)}

def figures(measured):
    return {f"accuracy.square.{key}.error": Found(m["error"], (key,)) for key, m in measured.items()}
'''


class Harness(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="silt-accuracy-")
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.out = self.folder / "out"
        self.count = self.folder / "count"
        self.program = self.folder / "silt"
        self.write_program()
        self.write("square", PROBLEM)

    def write_program(self, text=PROGRAM):
        self.program.write_text(text.replace("COUNT", repr(str(self.count))))
        self.program.chmod(self.program.stat().st_mode | stat.S_IXUSR)

    def write(self, name, text):
        path = self.folder / "problems" / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)

    def bench(self, *arguments, code=0):
        done = run_script(MAIN, *arguments, "--silt", self.program, "--folder", self.folder / "problems", "--out", self.out,
                          env={"SILT_COMMIT": "c0ffee"})
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def runs_done(self):
        return len(self.count.read_text().splitlines()) if self.count.exists() else 0

    def summary(self):
        return json.loads((self.out / "summary.json").read_text())

    def test_figures_goals_and_files(self):
        done = self.bench("--json", self.folder / "figures.json")
        self.assertEqual(self.runs_done(), 3)
        summary = self.summary()
        self.assertEqual(summary, json.loads((self.folder / "figures.json").read_text()))
        self.assertEqual(summary["commit"], "c0ffee")
        self.assertAlmostEqual(summary["figures"]["accuracy.square.d10.error"], 1)
        met = {row["figure"]: row["met"] for row in summary["table"]}
        self.assertEqual(met, {"accuracy.square.d2.error": False, "accuracy.square.d5.error": None,
                               "accuracy.square.d10.error": True})
        self.assertIn("1 goals met, 1 missed", done.stdout)
        seconds = {row["figure"]: row["core_seconds"] for row in summary["table"]}
        self.assertAlmostEqual(seconds["accuracy.square.d10.error"], 1e4)
        with open(self.out / "runs.csv") as stream:
            rows = {row["run"]: row for row in csv.DictReader(stream)}
        self.assertEqual(rows["d5"]["scheme"], "cli")
        self.assertAlmostEqual(float(rows["d5"]["error"]), 4)
        self.assertTrue((self.out / "square.png").stat().st_size > 10_000)
        self.assertIn("| `accuracy.square.d2.error`  | 25 ", (self.out / "summary.md").read_text())
        self.assertFalse((self.out / "scratch").exists())

    def test_nothing_is_run_twice(self):
        self.bench()
        self.bench()
        self.assertEqual(self.runs_done(), 3)
        self.assertIn("3 runs, 3 kept", self.bench("--list").stdout)
        self.bench("--rerun")
        self.assertEqual(self.runs_done(), 6)
        self.write_program(PROGRAM + "# another program\n")
        self.bench()
        self.assertEqual(self.runs_done(), 9)
        self.write("square", PROBLEM.replace("100 * (", "1 * 100 * ("))  # another way of measuring
        self.bench()
        self.assertEqual(self.runs_done(), 12)
        self.write("square", PROBLEM.replace("h = {1 / D}", "h = {1 / D} # another case"))
        self.bench()
        self.assertEqual(self.runs_done(), 15)
        self.write("square", PROBLEM.replace("1.01", "0.5"))  # another goal, and the first case again: judged, not run
        self.assertIn("0 goals met, 2 missed", self.bench().stdout)
        self.assertEqual(self.runs_done(), 15)

    def test_an_interrupted_session_goes_on(self):
        self.bench()
        kept = self.out / "results.jsonl"
        lines = kept.read_text().splitlines()
        kept.write_text("\n".join(lines[:2]) + "\n" + lines[2][:40])  # killed while it wrote the third
        self.bench()
        self.assertEqual(self.runs_done(), 4)
        self.assertIn("3 runs, 3 kept", self.bench("--list").stdout)

    def test_a_failing_run_does_not_stop_the_others(self):
        self.write("square", PROBLEM.replace("h = {1 / D}", "h = {1 / D}\\nfail = {str(D == 5).lower()}"))
        done = self.bench(code=1)
        self.assertEqual(self.runs_done(), 3)
        self.assertIn("square d5: silt ended with code 3", done.stderr)
        self.assertIn("it blew up in step 7", done.stderr)
        self.assertEqual(set(self.summary()["figures"]), {"accuracy.square.d2.error", "accuracy.square.d10.error"})
        self.assertTrue((self.out / "scratch" / "square" / "d5" / "case.toml").exists())  # to look at
        self.bench(code=1)
        self.assertEqual(self.runs_done(), 4)  # it is tried again

    def test_a_run_that_cannot_be_measured(self):
        self.write("square", PROBLEM.replace('quantity("value")', 'quantity("valeu")'))
        self.assertIn("KeyError: 'valeu'", self.bench(code=1).stderr)

    def test_a_broken_problem_does_not_stop_the_others(self):
        self.write("broken", "GOALS = []\nimport no_such_module\n")
        self.write("empty", "GOALS = []\n")
        self.write("shared", "raise SystemError('not a problem: nobody loads it')\n")
        done = self.bench(code=1)
        self.assertIn("no_such_module", done.stderr)
        self.assertIn("empty.py has no function runs", done.stderr)
        self.assertIn("accuracy.square.d10.error", self.summary()["figures"])

    def test_short_runs_fail_with_their_goals(self):
        self.bench("--short")
        self.assertEqual(self.runs_done(), 2)
        self.assertNotIn("accuracy.square.d2.error", self.summary()["figures"])  # not among the short runs
        self.write("square", PROBLEM.replace("1.01", "0.99"))
        self.bench("--short", code=1)
        self.bench()  # shown, no failure
        self.write("square", PROBLEM + '\nSHORT_GOALS = [Goal("accuracy.square.d5.error", 4.01)]\n')
        self.bench("--short")
        self.write("square", PROBLEM + '\nSHORT_GOALS = [Goal("accuracy.square.d4.error", 4.01)]\n')
        self.assertIn("not measured", self.bench("--short", code=1).stdout)

    def test_two_at_a_time_give_the_same(self):
        self.bench()
        one = self.summary()
        self.bench("--rerun", "-j", "2")
        self.assertEqual(self.summary(), one)

    def test_usage(self):
        self.assertIn("known: square", self.bench("squaer", code=2).stderr)
        self.assertIn("A square law", self.bench("--list", "square").stdout)
        self.assertEqual(self.runs_done(), 0)
        self.bench("--only", "d5")
        self.assertEqual(self.runs_done(), 1)

    def test_two_runs_of_one_key(self):
        self.write("square", PROBLEM.replace('f"d{D}"', '"d"'))
        self.assertIn("two runs have the key 'd'", self.bench(code=1).stderr)


class Parts(unittest.TestCase):
    def test_slope_of_a_power_law(self):
        from harness import pareto
        self.assertAlmostEqual(pareto.slope([(10.0**k, -(10.0 ** (-k / 2)), "") for k in range(4)]), -0.5)
        self.assertIsNone(pareto.slope([(1, 1, "")]))

    def test_goals(self):
        from problem import Goal
        self.assertTrue(Goal("f", 1).met(-1))
        self.assertFalse(Goal("f", 1).met(float("nan")))
        self.assertTrue(Goal("f", 3, low=2).met(2.5))
        self.assertFalse(Goal("f", 3, low=2).met(1))


if __name__ == "__main__":
    sys.path[:0] = [str(ROOT / "scripts" / "accuracy"), str(ROOT / "scripts")]
    unittest.main()
