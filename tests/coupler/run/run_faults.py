#!/usr/bin/python3
"""The program silt where something is in its way: another run in its folder, leftovers of a killed one, signals, files
that are none, long paths. run_faults.py SILT [TEST]"""
import os
import pathlib
import signal
import subprocess
import time
import unittest

from silt_test import CASE, ENVIRONMENT, SiltTest

ENDLESS = CASE.replace("steps = 60", "steps = 100000000").replace("fields = { every = 20 }\n", "").replace(
    "every = 25, keep = 3", "every = 250, keep = 3")


class Faults(SiltTest):
    def start(self, *arguments, ranks=1, **options):
        """Starts a run; it is killed at the end of the test, if it is there then."""
        process = subprocess.Popen(self.command(arguments, ranks), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=ENVIRONMENT, **options)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def wait_for(self, path, process):
        for _ in range(3000):
            if path.exists():
                return
            self.assertIsNone(process.poll())
            time.sleep(0.02)
        self.fail(f"no {path}")

    def test_a_second_run_is_refused(self):
        self.write(ENDLESS)
        for ranks in (1, 2):
            first = self.start("run", self.case, "--overwrite", ranks=ranks)
            self.wait_for(self.out / "checkpoint_000000000250.h5", first)
            holder = (self.out / "run.lock").read_text().split()
            for command in (["run"], ["run", "--overwrite"], ["resume"]):
                errors = self.silt(command[0], self.case, *command[1:], ranks=3 - ranks, code=2).stderr
                self.assertIn(f"{self.out}: a run is writing here: process {holder[1]} on {os.uname().nodename}", errors)
                self.assertIn("--out", errors)
            os.kill(int(holder[1]), signal.SIGKILL)  # and the lock is nobody's
            first.wait(60)
            self.silt("resume", self.case, "--time-limit", 0.1, code=4)
            self.assertFalse((self.out / "run.lock").exists())
        self.assertFalse((self.case / "out.1").exists())

    def test_a_guard_speaks_beside_leftovers(self):
        """Its ranks agree by this file who speaks."""
        self.write(CASE.replace("-1e-4", "-1"))
        self.silt("run", self.case, "--steps", 1)
        (self.out / "report.json.part").write_text("of a killed run")
        (self.out / "bodies.h5.journal.part").write_text("of a killed run")
        (self.out / "checkpoint_000000000009.h5.part.metadata.0").write_text("of its MPI")
        errors = self.silt("resume", self.case, "--set", "run.steps=60", ranks=4, code=3).stderr
        self.assertRegex(errors, r"step \d+: body [12] \(rank \d\) moves")
        self.assertEqual(self.report()["exit_reason"], "guard")
        self.assertFalse(list(self.out.glob("*.part*")))

    def test_signals_leave_a_checkpoint(self):
        self.write(ENDLESS)
        for name in ("HUP", "INT", "USR1", "USR2", "XCPU"):
            process = self.start("run", self.case, "--overwrite")
            self.wait_for(self.out / "checkpoint_000000000250.h5", process)
            process.send_signal(getattr(signal, f"SIG{name}"))
            _, errors = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 4, errors)
            self.assertIn(f"told to stop (SIG{name}) at step", errors)
            self.assertTrue((self.out / f"checkpoint_{self.report()['steps']:012d}.h5").exists())

    def test_nobody_needs_to_read_what_a_run_prints(self):
        read, write = os.pipe()
        os.close(read)
        result = subprocess.run(self.command(["run", self.case], 1), stdout=write, stderr=subprocess.PIPE, env=ENVIRONMENT,
                                timeout=60, preexec_fn=lambda: signal.signal(signal.SIGPIPE, signal.SIG_DFL))
        os.close(write)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.report()["exit_reason"], "completed")

    def test_a_run_that_has_not_begun_ends_at_once(self):
        """Bodies of half a minute's work to place."""
        fill = '[[fill]]\nshape = "ball"\ndensity = 1.5\ncount = 1500000\ngap = 0.1\n'
        self.write(CASE.replace("[24, 16, 16]", "[1200, 800, 800]").replace("[run]", fill + "[run]").replace(
            "blocks = [6, 8, 16]", "").replace("[fluid]\nrelaxation_time = 0.8\n", "").replace("fields = { every = 20 }", ""))
        process = self.start("run", self.case)
        time.sleep(1)
        self.assertIsNone(process.poll())
        process.send_signal(signal.SIGTERM)
        begin = time.time()
        process.wait(60)
        self.assertEqual(process.returncode, -signal.SIGTERM)
        self.assertLess(time.time() - begin, 2)
        self.assertFalse(self.out.exists())

    def test_pipes_are_no_files(self):
        pipe = self.case / "pipe.toml"
        os.mkfifo(pipe)
        self.assertIn("no such file", self.silt("run", pipe, code=2).stderr)
        self.assertIn("regular file", self.silt("info", pipe, code=2).stderr)
        os.mkfifo(self.case / "ball.stl")
        self.write(CASE.replace('type = "sphere"\nradius = 2.5', 'type = "polyhedron"\nfile = "ball.stl"'))
        self.assertIn("no such file", self.silt("check", self.case, code=2).stderr)
        self.write(CASE)
        self.silt("run", self.case, "--steps", 25)
        os.mkfifo(self.out / "checkpoint_000000000030.h5")
        self.silt("resume", self.case, "--steps", 30)
        self.assertIn("regular file", self.silt("resume", self.case, "--steps", 40, "--checkpoint", pipe, code=2).stderr)

    def test_what_cannot_be_run_is_refused(self):
        for setting, text in {
                "fluid.body_force=[1e308,0,0]": "fluid.body_force adds 1e+308 cells a step to a velocity",
                "fluid.body_force=[-1,0,0]": "fluid.body_force adds 1 cells",
                "gravity.acceleration=[0,0,-1e14]": "gravity.acceleration adds 1e+14 cells",
                "fluid.magic=1e308": "fluid.magic is 1e+308; at most 1000",
                "run.steps=9223372036854775807": "the run has 9223372036854775807 steps; at most 1e+15"}.items():
            errors = self.silt("check", self.case, "--set", setting, code=2).stderr
            self.assertIn(text, errors)
            self.assertIn(f"--set {setting}: ", errors)  # its place
        self.assertIn("1 time", self.silt("check", self.case, "--set", "output.checkpoint.every=9223372036854775807").stdout)
        for ranks in (1, 2):
            errors = self.silt("run", self.case, "--set", "domain.size=[20000,20000,20000]", ranks=ranks, code=2).stderr
            self.assertRegex(errors, r"the fluid needs \d+ GB, and the machines of this run have \d+ GB together")
        self.write(CASE.replace("density = 1.5", "density = 1e30"))
        self.assertIn("bodies[0].density is 1e+30 times", self.silt("check", self.case, code=2).stderr)
        self.write(CASE)
        for option in ("--time-limit", "--steps"):
            self.assertIn("nan is not a number above 0", self.silt("run", self.case, option, "nan", code=2).stderr)
        self.silt("run", self.case, "--steps", "99999999999999999999", code=2)

    def test_long_paths(self):
        out = pathlib.Path(self.scratch.name, *3 * ["a" * 100])
        self.silt("run", self.case, "--steps", 25, "--out", out)
        self.silt("resume", self.case, "--set", "run.steps=30", "--out", out, ranks=3)
        self.assertEqual(self.report(out)["steps"], 30)
        self.assertIn("name too long", self.silt("run", self.case, "--out", "a" * 300, code=1).stderr)

    def test_results_that_cannot_be_written(self):
        for ranks in (1, 2):
            errors = self.silt("run", self.case, "--out", "/proc/silt", ranks=ranks, code=1).stderr
            self.assertIn("/proc/silt: cannot be made: No such file", errors)
            errors = self.silt("run", self.case, "--out", self.case / "case.toml", ranks=ranks, code=1).stderr
            self.assertIn("is a file; the results need a folder", errors)


if __name__ == "__main__":
    unittest.main()
