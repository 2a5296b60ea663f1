#!/usr/bin/python3
"""stability_map SILT [--all]: what `silt check` calls safe was measured to last (scripts/stability/map.csv),
and what a guard advises cures."""
import concurrent.futures
import csv
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from silt_runs import ROOT, run_text  # noqa: E402, I001

sys.path.insert(0, str(ROOT / "scripts" / "stability"))
from scenes import MODELS, SCENES  # noqa: E402

SILT = sys.argv.pop(1)
ALL = "--all" in sys.argv
sys.argv = [word for word in sys.argv if word != "--all"]


def silt(command, text, *options):
    done = run_text(SILT, text, *options, command=command, code=None)[0]
    return done.returncode, done.stdout + done.stderr


class Map(unittest.TestCase):

    def test_every_point_that_check_calls_safe_is(self):
        with open(ROOT / "scripts" / "stability" / "map.csv") as stream:
            all_rows = list(csv.DictReader(stream))
        # what did not last must be warned of; that much of the rest is not is seen on an eighth of it
        rows = [row for row in all_rows if row["verdict"] != "stable"][::1 if ALL else 2]
        rows += [row for row in all_rows if row["verdict"] == "stable"][::1 if ALL else 8]
        safe = {model: 0 for model in MODELS}
        texts = [SCENES[row["scene"]](row["model"], float(row["tau_less_half"]), float(row["velocity"])) for row in rows]
        with concurrent.futures.ThreadPoolExecutor(12) as pool:  # a check waits most of its time for MPI
            answers = list(pool.map(lambda text: silt("check", text), texts))
        for row, (code, said) in zip(rows, answers):
            if code == 0 and "warning" not in said:
                safe[row["model"]] += 1
                self.assertEqual(row["verdict"], "stable", row)
        self.assertGreater(safe["trt"], 5)
        self.assertGreater(safe["regularised"], 10)


class Cure(unittest.TestCase):

    def test_regularised_cures_what_the_guard_says_it_does(self):
        for scene in ("layer", "cavity"):
            with self.subTest(scene):
                text = SCENES[scene]("trt", 0.001, 0.1)
                code, said = silt("run", text)
                self.assertEqual(code, 3, said)
                self.assertIn('use fluid.collision = "regularised"', said)
                code, said = silt("run", text, "--set", "fluid.collision=regularised")
                self.assertEqual(code, 0, said)

    def test_what_is_too_fast_for_regularised_lasts_at_the_speed_that_check_asks_for(self):
        code, said = silt("run", SCENES["towed"]("regularised", 0.01, 0.2))
        self.assertEqual(code, 3, said)
        self.assertIn("lower what drives it (", said)
        code, said = silt("run", SCENES["towed"]("regularised", 0.01, 0.1))
        self.assertEqual(code, 0, said)

    def test_auto_takes_regularised_where_trt_does_not_last(self):
        for scene, excess, expected in (("layer", 0.001, "regularised"), ("layer", 0.1, "trt")):
            code, said = silt("check", SCENES[scene]("auto", excess, 0.1))
            self.assertEqual(code, 0, said)
            self.assertRegex(said, rf"collision +{expected}, .*\(auto: u/nu = ")


if __name__ == "__main__":
    unittest.main()
