#!/usr/bin/python3
"""time_of_output.py SILT: what `silt check` foresees of the time for output, over that for steps, is within a factor of 2 of a run, and a report
costs about a step. By processor time; a long test, since other work on the machine disturbs it."""
import pathlib
import resource
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "coupler/run"))
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
        steps = 30
        self.write(self.LARGE.replace("[[6, 8, 8], [18, 8, 9]]", "[[30, 40, 40], [90, 40, 45]]").replace("steps = 60", f"steps = {steps}")
                   .replace("fields = { every = 20 }\nbodies = { every = 7 }\ncheckpoint = { every = 25, keep = 3 }\n", ""))
        start = self.processor_time("--steps", 1)
        in_steps = self.processor_time() - start
        for output in ("report = { every = 1 }", "fields = { every = 3 }", "fields = { every = 10, compression = 6, quantities = ['vorticity'] }",
                       "checkpoint = { every = 10 }", "slices = [{ name = 'a', every = 1, axis = 'y', at = 40 }]"):
            key, value = output.split(" = ", 1)
            of_output = self.processor_time("--set", f"output.{key}={value}") - start - in_steps
            said = self.silt("check", self.case, "--set", f"output.{key}={value}").stdout
            foreseen = number(said, "  of it for output") / (number(said, "time") - number(said, "  of it for output"))
            found = of_output / in_steps
            if key == "report":
                self.assertLess(found, 2)  # one a step: what it takes over a step of a fluid almost without bodies
            self.assertTrue(0.5 < (1 + foreseen) / (1 + found) < 2, f"{output}: {foreseen} times the steps foreseen, {found} found")


if __name__ == "__main__":
    unittest.main()
