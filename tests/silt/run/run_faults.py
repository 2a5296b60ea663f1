#!/usr/bin/python3
"""The program silt where something is in its way: another run in its folder, leftovers of a killed one, signals, files
that are none, long paths. run_faults.py SILT [TEST]"""
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import time
import unittest

from silt_test import CASE, ENVIRONMENT, SILT, UNSTABLE, SiltTest, script

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
            shutil.rmtree(self.out, ignore_errors=True)  # its checkpoint would be taken for that of the next run
            first = self.start("run", self.case, ranks=ranks)
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

    def test_resume_beside_a_run_before_its_first_checkpoint(self):
        self.write(ENDLESS.replace("every = 250", "every = 100000000"))
        first = self.start("run", self.case)
        self.wait_for(self.out / "run.lock", first)
        self.assertIn(f"{self.out}: a run is writing here", self.silt("resume", self.case, code=2).stderr)
        first.kill()
        first.wait(60)

    def test_a_guard_speaks_beside_leftovers(self):
        """The ranks of a guard agree by this file who speaks."""
        self.write(UNSTABLE)
        self.silt("run", self.case, "--steps", 1)
        (self.out / "report.json.part").write_text("of a killed run")
        (self.out / "bodies.h5.part").write_text("of a killed run")
        (self.out / "checkpoint_000000000009.h5.part.metadata.0").write_text("of its MPI")
        errors = self.silt("resume", self.case, "--set", "run.steps=60", ranks=4, code=3).stderr
        self.assertRegex(errors, r"step \d+: body [12] moves")
        self.assertEqual(self.report()["exit_reason"], "guard")
        self.assertFalse(list(self.out.glob("*.part*")))

    def test_signals_leave_a_checkpoint(self):
        self.write(ENDLESS)
        for name, why in (("HUP", " (the terminal was closed)"), ("INT", " (Ctrl-C)"), ("USR1", ""), ("USR2", ""), ("XCPU", "")):
            shutil.rmtree(self.out, ignore_errors=True)
            process = self.start("run", self.case, "--overwrite")
            self.wait_for(self.out / "checkpoint_000000000250.h5", process)
            process.send_signal(getattr(signal, f"SIG{name}"))
            _, errors = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 4, errors)
            self.assertIn(f"told to stop by SIG{name}{why} at step", errors)
            self.assertTrue((self.out / f"checkpoint_{self.report()['steps']:012d}.h5").exists())

    def test_the_signal_of_scancel_that_submit_names_comes_to_ranks_by_mpirun(self):
        """The ranks stand still for longer than mpirun waits before it kills."""
        name, = re.findall(r"scancel\s--signal=(\w+)\s--batch", script("submit", "--help"))
        self.write(ENDLESS)
        process = self.start("run", self.case, ranks=2)
        self.wait_for(self.out / "bodies.h5", process)
        ranks = [int(child) for child in pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()]
        for rank in ranks:
            os.kill(rank, signal.SIGSTOP)
        process.send_signal(getattr(signal, f"SIG{name}"))
        time.sleep(3)
        self.assertIsNone(process.poll())
        for rank in ranks:
            os.kill(rank, signal.SIGCONT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 4, errors)
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
                "fluid.magic=1e308": "fluid.magic is 1e+308; it must be above 0 and at most 1000",
                "run.steps=9223372036854775807": "the run has 9223372036854775807 steps; at most 1e+15"}.items():
            errors = self.silt("check", self.case, "--set", setting, code=2).stderr
            self.assertIn(text, errors)
            self.assertIn(f"--set {setting}: ", errors)  # its place
        self.assertIn("1 time", self.silt("check", self.case, "--set", "output.checkpoint.every=9223372036854775807").stdout)
        large = ["--set", "domain.size=[20000,20000,20000]", "--unset", "domain.blocks"]
        for ranks in (1, 2):
            for command in ("run", "check"):
                errors = self.silt(command, self.case, *large, ranks=ranks, code=2).stderr
                self.assertRegex(errors, r"the fluid needs \d+ GB, and the machines of this run have \d+ GB together")
        # with more ranks than one machine has cores, on as many machines like this one as it takes
        large[1] = "domain.size=[5000,5000,5000]"
        self.assertIn("the fluid needs", self.silt("check", self.case, *large, code=2).stderr)
        self.assertIn("estimate", self.silt("check", self.case, *large, "-n", 100000).stdout)
        self.write(CASE.replace("density = 1.5", "density = 1e30"))
        self.assertIn("bodies[0].density is 1e+30 times", self.silt("check", self.case, code=2).stderr)
        self.write(CASE)
        for option in ("--time-limit", "--steps"):
            self.assertIn("nan is not a number above 0", self.silt("run", self.case, option, "nan", code=2).stderr)
        self.silt("run", self.case, "--steps", "99999999999999999999", code=2)

    def test_what_cannot_be_cut_is_told_by_check_too(self):
        self.write(CASE.replace("blocks = [6, 8, 16]", "blocks = [24, 16, 16]"))
        self.silt("check", self.case)
        found = self.silt("run", self.case, ranks=3, code=2).stderr
        self.assertIn(found.strip().splitlines()[0], self.silt("check", self.case, ranks=3, code=2).stderr)

    def test_line_breaks_in_names_and_values(self):
        errors = self.silt("run", self.case, "--set", "domain.size=[24,\n16, 16]", code=2).stderr
        self.assertIn("must be of one line", errors)
        self.write(CASE.replace('type = "sphere"\nradius = 2.5', 'type = "polyhedron"\nfile = "a\\nb.stl"'))
        (self.case / "a\nb.stl").write_text("solid\nendsolid\n")
        self.assertIn("rename it", self.silt("check", self.case, code=2).stderr)

    def test_a_value_of_several_lines_may_change_where_values_may(self):
        quantity = '[[quantities]]\nname = "density"\ntype = "packing-fraction"\nbox = [\n  [0, 0, 0],\n  [%d, 8, 8]\n]\n'
        self.write(CASE + quantity % 8)
        self.silt("run", self.case, "--steps", 25)
        self.write(CASE + quantity % 9)
        self.silt("resume", self.case, "--set", "run.steps=30")
        self.write((CASE + quantity % 8).replace("blocks = [6, 8, 16]", "blocks = [\n6,\n8, 8]"))
        self.assertIn("has changed", self.silt("resume", self.case, "--set", "run.steps=35", code=2).stderr)

    def test_what_to_go_on_with_can_be_pasted(self):
        strange = pathlib.Path(self.scratch.name) / "a b$(touch touched)'c"
        self.case.rename(strange)
        self.case, self.out = strange, strange / "out"
        self.write(ENDLESS)
        errors = self.silt("run", self.case, "--time-limit", 0.1, code=4).stderr
        command = errors.split("go on with: silt ")[1].strip()
        subprocess.run(f"{SILT} {command} --time-limit 0.1", shell=True, cwd=self.scratch.name, env=ENVIRONMENT, timeout=60,
                       capture_output=True)
        self.assertGreater(self.report()["steps"], int(errors.split("at step ")[1].split(";")[0]))
        self.assertFalse((pathlib.Path(self.scratch.name) / "touched").exists())

    def test_names_too_long_or_too_many_are_refused(self):
        self.write(CASE.replace("two balls", "b" * 70000))
        self.assertIn("title has 70000 bytes", self.silt("check", self.case, code=2).stderr)
        many = "".join(f'[[fill]]\nname = "f{i}"\nshape = "ball"\ndensity = 1\ncount = 0\n' for i in range(5000))
        self.write(CASE.replace("[run]", many + "[run]"))
        self.assertIn("more than 4000 names", self.silt("check", self.case, code=2).stderr)

    def test_a_damaged_checkpoint_is_passed_over(self):
        self.silt("run", self.case)
        newest, before = (self.out / f"checkpoint_{step:012d}.h5" for step in (60, 50))
        reference = self.report()["state_hash"]
        for ranks in (1, 2):
            content = bytearray(newest.read_bytes())
            content[len(content) // 2] ^= 1
            newest.write_bytes(content)
            said = self.silt("resume", self.case, ranks=ranks).stdout
            self.assertIn(f"passed over: cannot use the checkpoint {newest}", said)
            self.assertIn("goes on from step 50", said)
            self.assertEqual(self.report()["state_hash"], reference)
        said = self.silt("resume", self.case, "--out", self.out / "none at all", code=2).stderr
        self.assertIn(f"no checkpoint to go on from; start the run with: silt run {self.case} --out '{self.out}/none at all'", said)
        newest.write_bytes(b"no checkpoint")
        self.assertIn(str(before), self.silt("resume", self.case, "--checkpoint", newest, code=2).stderr)

    def test_a_guard_leaves_what_it_stopped_at(self):
        self.write(UNSTABLE)
        for ranks in (1, 3):
            errors = self.silt("run", self.case, "--overwrite", "--set", "run.steps=400", ranks=ranks, code=3).stderr
            state, = self.out.glob("stopped_*.h5")
            self.assertIn(f"the state it stopped in: {state}", errors)
            step = self.report()["steps"]
            self.assertEqual(state.name, f"stopped_{step:012d}.h5")
            self.assertTrue((self.out / f"fields_{step:012d}.hdf").exists())
            self.assertNotIn(str(state), self.silt("resume", self.case, "--set", "run.steps=400", ranks=ranks, code=None).stdout)
            self.silt("resume", self.case, "--checkpoint", state, "--set", f"run.steps={step + 1}", code=None)

    def test_a_guard_leaves_a_state_whose_forces_are_no_numbers(self):
        light = UNSTABLE.replace('type = "sphere"\nradius = 2.5', 'type = "box"\nedges = [7, 5, 6]').replace("density = 0.05", "density = 0.5")
        self.write(light.replace("[0.05, 0, 0]", "[0.02, 0, 0]").replace("relaxation_time = 0.8", "relaxation_time = 0.6"))
        self.assertIn('bodies[0].density is 0.5 times the fluid\'s; with coupling.time = "explicit" shape \'ball\' is stable from about 8.2 on: '
                      'use coupling.time = "implicit"', self.silt("check", self.case).stdout)
        self.assertNotIn("explicit", self.silt("check", self.case, "--set", "bodies[0].density=9").stdout)
        for ranks in (1, 3):
            errors = self.silt("run", self.case, "--overwrite", ranks=ranks, code=3).stderr
            self.assertIn("the fluid at cell", errors)
            self.assertIn('use coupling.time = "implicit" (light bodies need it)', errors)
            state, = self.out.glob("stopped_*.h5")
            self.assertIn(f"the state it stopped in: {state}", errors)

    def test_too_little_memory_ends_with_an_error(self):
        """The limits begin where the program's libraries are not even loaded to where it runs, in steps of 4
        MB: an error, no crash; but octomap, of FCL, takes memory and aborts without it before main()."""
        self.write(CASE.replace("[gravity]", '[contacts]\nbackend = "bullet"\n[gravity]'))
        codes = set()
        for megabytes in range(40, 130, 4):
            def limit():
                resource.setrlimit(resource.RLIMIT_AS, 2 * (megabytes << 20,))
            result = self.run_silt("run", self.case, "--steps", 2, "--overwrite", preexec_fn=limit)
            before_main = result.returncode == -signal.SIGABRT and codes <= {127} and "silt" not in result.stderr
            if not before_main:
                self.assertIn(result.returncode, (0, 1, 2, 127), f"{megabytes} MB: {result.stderr}")
                codes.add(result.returncode)
        self.assertLessEqual({0, 127}, codes)
        self.assertTrue(codes & {1, 2}, codes)

    def test_long_paths(self):
        out = pathlib.Path(self.scratch.name, *3 * ["a" * 100])
        self.silt("run", self.case, "--steps", 25, "--out", out)
        self.silt("resume", self.case, "--set", "run.steps=30", "--out", out, ranks=3)
        self.assertEqual(self.report(out)["steps"], 30)
        self.assertIn("name too long", self.silt("run", self.case, "--out", "a" * 300, code=1).stderr)

    def test_results_go_where_a_link_points(self):
        target = pathlib.Path(self.scratch.name) / "disk" / "results"
        target.mkdir(parents=True)
        (target / "notes.txt").write_text("mine")
        self.out.symlink_to("../disk/results")
        self.silt("run", self.case, "--steps", 25)
        first = self.report(target)
        self.assertIn(f"the earlier results are now in {self.out / 'out.1'}", self.silt("run", self.case, "--steps", 30).stdout)
        self.assertEqual(self.report(target / "out.1"), first)
        self.assertEqual(self.report(target)["steps"], 30)
        for extra, steps in ((["resume"], 35), (["run", "--overwrite"], 40), (["run"], 45)):
            self.silt(extra[0], self.case, *extra[1:], "--set", f"run.steps={steps}", ranks=2)
            self.assertEqual(self.report(target)["steps"], steps)
        self.assertEqual(self.report(target / "out.1"), first)
        self.assertEqual(self.report(target / "out.2")["steps"], 40)
        self.assertTrue(self.out.is_symlink())
        self.assertEqual([path.name for path in target.parent.iterdir()], ["results"])
        self.assertEqual((target / "notes.txt").read_text(), "mine")
        self.assertEqual(sorted(path.name for path in self.case.iterdir()), ["case.toml", "out"])

    def test_links_that_lead_to_no_folder(self):
        (self.case / "loop").symlink_to("out")
        for target, text, ranks in (("../scratch/gone", "is a link to ../scratch/gone, which is not there: make that folder", 2),
                                    ("loop", "is a link that leads back to itself", 1),
                                    ("case.toml", "is a link to case.toml, a file; the results need a folder", 1),
                                    ("/proc/self", "run.lock: cannot be made: ", 1)):
            self.out.symlink_to(target)
            self.assertIn(text, self.silt("run", self.case, ranks=ranks, code=1).stderr)
            self.assertIn(f"{self.out}", self.silt("resume", self.case, code=None).stderr)
            self.assertTrue(self.out.is_symlink())
            self.out.unlink()

    def test_results_in_a_folder_that_cannot_be_moved(self):
        """The working folder, and a disk of its own where the test may mount one."""
        self.out.mkdir()
        for steps in (25, 30):
            self.silt("run", self.case, "--out", ".", "--steps", steps, cwd=self.out)
        self.assertEqual([self.report(self.out / below)["steps"] for below in (".", "out.1")], [30, 25])
        mount = ["unshare", "--mount", "bash", "-c"]
        if os.geteuid() == 0 and subprocess.run([*mount, "mount -t tmpfs tmpfs /mnt"], capture_output=True).returncode == 0:
            volume = self.case / "volume"
            volume.mkdir()
            runs = " && ".join(f"mkdir -p {volume}/lost+found && {SILT} run {self.case} --out {volume} {options}"
                               for options in ("--steps 25", "--steps 30", "--steps 35 --overwrite", "--steps 40"))
            result = subprocess.run([*mount, f"mount -t tmpfs tmpfs {volume} && {runs} && cat {volume}/volume.1/report.json "
                                     f"{volume}/volume.2/report.json {volume}/report.json && ls {self.case}"],
                                    capture_output=True, text=True, env=ENVIRONMENT, timeout=60)
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            self.assertEqual(re.findall(r'^  "steps": (\d+)', result.stdout, re.MULTILINE), ["25", "35", "40"])
            self.assertNotIn("volume.", result.stdout.splitlines()[-2:])

    def test_a_limit_of_file_sizes_is_told(self):
        for limit in (0, 30000, 300000):
            result = self.run_silt("run", self.case, "--overwrite",
                                   preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertRegex(result.stderr, rf"{self.out}/[\w.]+: .*File too large .*ulimit -f")

    def test_rows_and_report_of_a_run_that_was_complete(self):
        """A run that was killed after its last checkpoint may have left them so."""
        self.write(CASE.replace("[output]", "[output]\nreport = { every = 20 }"))
        self.silt("run", self.case)
        whole, rows = self.report(), (self.out / "series.csv").read_text().splitlines()
        (self.out / "report.json").write_text((self.out / "report.json").read_text().replace('"completed"', '"running"'))
        (self.out / "series.csv").write_text("".join(row + "\n" for row in rows[:-1]) + rows[-1][:7])
        self.assertIn("the run is complete", self.silt("resume", self.case).stdout)
        self.assertEqual([self.report()[key] for key in ("exit_reason", "state_hash")], ["completed", whole["state_hash"]])
        there = (self.out / "series.csv").read_text().splitlines()
        self.assertEqual([row.split(",")[:2] for row in there], [row.split(",")[:2] for row in rows])
        content = (self.out / "report.json").read_text()
        self.silt("resume", self.case)
        self.assertEqual((self.out / "report.json").read_text(), content)
        for begun in (None, rows[0][:30]):  # a series that was deleted, or killed in its first line
            (self.out / "series.csv").unlink()
            if begun:
                (self.out / "series.csv").write_text(begun)
            self.silt("resume", self.case, "--set", f"run.steps={80 if begun else 70}")
            there = (self.out / "series.csv").read_text().splitlines()
            self.assertEqual([there[0], len(there)], [rows[0], 2])
        self.assertFalse((self.out / "series.1.csv").exists())

    def test_results_that_cannot_be_written(self):
        for ranks in (1, 2):
            errors = self.silt("run", self.case, "--out", "/proc/silt", ranks=ranks, code=1).stderr
            self.assertIn("/proc/silt: cannot be made: No such file", errors)
            errors = self.silt("run", self.case, "--out", self.case / "case.toml", ranks=ranks, code=1).stderr
            self.assertIn("is a file; the results need a folder", errors)


if __name__ == "__main__":
    unittest.main()
