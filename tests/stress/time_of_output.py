#!/usr/bin/python3
"""time_of_output.py SILT: what `silt check` foresees of the time for output, over that for steps, is within a
factor of 2 of a run, a report costs about a step, and the time foreseen for cases that write much is within a
factor of 2 as well. Of one scene by processor time; a long test, since other work on the machine disturbs
it."""
import pathlib
import resource
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "silt/run"))
import estimates  # noqa: E402
from estimates import number  # noqa: E402
from silt_test import SiltTest  # noqa: E402


class TimeOfOutput(SiltTest):
    LARGE = estimates.Estimates.LARGE

    def processor_time(self, *settings):
        """Returns the least of three runs, in seconds."""
        def once():
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            self.silt("run", self.case, "--overwrite", *settings)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        return min(once() for _ in range(3))

    def test_time_for_output(self):
        steps = 150
        self.write(self.LARGE.replace("[[6, 8, 8], [18, 8, 9]]", "[[30, 40, 40], [90, 40, 45]]").replace("steps = 60", f"steps = {steps}")
                   .replace("fields = { every = 20 }\nbodies = { every = 7 }\ncheckpoint = { every = 25, keep = 3 }\n", ""))
        start = self.processor_time("--steps", 1)
        in_steps = self.processor_time() - start
        for output in ("report = { every = 1 }", "fields = { every = 3 }", "fields = { every = 10, quantities = ['vorticity'] }",
                       "checkpoint = { every = 10 }", "slices = [{ name = 'a', every = 1, box = [[0, 40, 0], [1e4, 40, 1e4]] }]"):
            key, value = output.split(" = ", 1)
            of_output = self.processor_time("--set", f"output.{key}={value}") - start - in_steps
            said = self.silt("check", self.case, "--set", f"output.{key}={value}").stdout
            foreseen = number(said, "  of it for output") / (number(said, "time") - number(said, "  of it for output"))
            found = of_output / in_steps
            print(f"{output}: {found:.2f} of the steps, {foreseen:.2f} foreseen")
            if key == "report":
                self.assertLess(found, 1.3)  # one a step: what it takes over a step of a fluid almost without bodies
            self.assertTrue(0.5 < (1 + foreseen) / (1 + found) < 2, f"{output}: {foreseen} times the steps foreseen, {found} found")

    # steps, and what is written
    CASES = {
        "segregation": (1000, "report = { every = 5 }", "fields = { every = 50 }", "bodies = { every = 5 }", "checkpoint = { every = 200, keep = 2 }"),
        "fluidised-bed": (800, "report = { every = 2 }", "bodies = { every = 10 }", "fields = { every = 100 }"),
        "packing": (1000, "report = { every = 1 }", "bodies = { every = 2 }", "checkpoint = { every = 100, keep = 2 }"),
        "porous-bed": (400, "report = { every = 1 }", "fields = { every = 20 }", "slices = [{ name = 'mid', every = 2, box = [[0, 16, 0], [1e4, 16, 1e4]] }]"),
        "stirred-tank": (600, "report = { every = 2 }", "fields = { every = 25, quantities = ['velocity', 'vorticity'] }",
                         "checkpoint = { every = 100, keep = 2 }"),
        "sheared-suspension": (600, "report = { every = 1 }", "bodies = { every = 1 }", "fields = { every = 20 }"),
        "rotating-drum": (1000, "report = { every = 1 }", "bodies = { every = 5 }"),
    }

    def test_time_of_cases(self):
        cases = pathlib.Path(__file__).resolve().parents[2] / "cases"
        for name, (steps, *outputs) in self.CASES.items():
            settings = ["--set", f"run.steps={steps}"]
            for output in outputs:
                key, value = output.split(" = ", 1)
                settings += ["--set", f"output.{key}={value}"]
            foreseen = number(self.silt("check", cases / name, *settings).stdout, "time")
            begin = time.perf_counter()
            self.silt("run", cases / name, "--out", self.out, "--overwrite", *settings)
            found = time.perf_counter() - begin
            print(f"{name}: {foreseen:.3g} s foreseen, {found:.3g} s found, ratio {foreseen / found:.2f}")
            with self.subTest(name):
                self.assertTrue(0.5 < foreseen / found < 2)


if __name__ == "__main__":
    unittest.main()
