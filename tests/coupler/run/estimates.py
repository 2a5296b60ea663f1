#!/usr/bin/python3
"""estimates.py SILT: what `silt check` foresees of memory and disk, and of the time for output over that for steps, is within a factor of 2 of
a run; times themselves depend on what else the machine does. A report costs about a step. More than the disk has, or years, are warned
of."""
import re
import resource
import unittest

from silt_test import CASE, SiltTest


def number(said, name):
    value, unit = re.search(rf"^  {name} +([0-9.]+) (MB|GB|TB|s)", said[said.index("estimate ("):], re.M).groups()
    return float(value) * {"MB": 1e6, "GB": 1e9, "TB": 1e12, "s": 1}[unit]


class Estimates(SiltTest):
    LARGE = CASE.replace("[24, 16, 16]", "[120, 80, 80]").replace("blocks = [6, 8, 16]\n", "").replace("radius = 2.5", "radius = 5")

    def test_memory_and_disk_of_a_run(self):
        self.write(self.LARGE.replace("[[6, 8, 8], [18, 8, 9]]", "[[30, 40, 40], [90, 40, 45]]"))
        said = self.silt("check", self.case).stdout
        self.silt("run", self.case)
        files = sum(path.stat().st_size for path in self.out.iterdir())
        for found, foreseen in ((self.report()["memory_peak_bytes"]["max"], number(said, "memory")), (files, number(said, "disk"))):
            self.assertLess(found / 2, foreseen)
            self.assertLess(foreseen, 2 * found)
        self.assertGreater(number(said, "time"), 0)

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

    def test_shares_of_ranks(self):
        """All the work that is no cell's is in one corner: of two equal halves one has nearly all of it, of cut ones none has much more."""
        self.write(CASE.split("[fluid]")[0].replace("blocks = [6, 8, 16]\n", "").replace("[24, 16, 16]", "[96, 48, 48]") + """
[[shapes]]
name = "ball"
type = "sphere"
radius = 1
[[fill]]
shape = "ball"
density = 1
count = 800
box = [[0, 0, 0], [24, 48, 48]]
[run]
steps = 10
""")
        for settings, low, high in ((["--set", "domain.blocks=[48, 48, 48]"], 1.99, 2), ([], 1, 1.1)):
            said = self.silt("check", self.case, "-n", 2, *settings).stdout
            found = float(re.search(r"largest over mean +([0-9.]+)", said)[1])
            self.assertTrue(low <= found <= high, said)
        self.assertNotIn("largest over mean", self.silt("check", self.case).stdout)

    def test_a_large_domain_takes_no_longer(self):
        """Its work is estimated from boxes and bodies: at ten times the length a walk over cells would take a thousand times as long."""
        dry = CASE[:CASE.index("[fluid]")].replace("blocks = [6, 8, 16]\n", "") + CASE[CASE.index("[[shapes]]"):CASE.index("[output]")]

        def seconds(size):
            self.write(dry.replace("[24, 16, 16]", f"[{size}, {size}, {size}]").replace("radius = 2.5", f"radius = {size / 50}")
                       .replace("[[6, 8, 8], [18, 8, 9]]", f"[[{size // 4}, {size // 2}, {size // 2}]]"))
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            self.silt("check", self.case, "-n", 2)
            return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        self.assertLess(seconds(10000), seconds(1000) + 1)

    def test_what_no_disk_and_nobody_has_is_warned_of(self):
        settings = ["--set", "run.steps=10000000000000", "--set", "output.fields.every=1"]
        said = self.silt("check", self.case, *settings).stdout
        self.assertRegex(said, r"case.toml:\d+:\d+: warning: the files of the run take about .* TB, and .* left: write less often")
        self.assertRegex(said, r"--set run.steps=10000000000000: warning: run.steps is 10000000000000 steps, which take about .* years")
        self.assertNotIn("warning: the files", self.silt("check", self.case).stdout)


if __name__ == "__main__":
    unittest.main()
