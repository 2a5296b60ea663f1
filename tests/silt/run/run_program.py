#!/usr/bin/python3
"""The program silt as its users meet it: exit codes, texts, folders of results, signals, a full disk.

run_program.py SILT [TEST]
"""
import json
import os
import pathlib
import pty
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

from silt_test import CASE, CHANNEL, ENVIRONMENT, SCRIPTS, SILT, SiltTest
from silt_runs import body_of, domain_of, shape_of  # on the path by silt_test


# A heavy box has come down on a stack, which does not bear it yet, when the run is stopped.
STACK = (domain_of([16, 16, 32], '{ x = "periodic", y = "periodic", z = "no-slip" }') +
         "[gravity]\nacceleration = [0, 0, -1e-3]\n[contacts]\nfriction = 0.5\n" +
         shape_of("box", "box", "edges = [2, 2, 2]") +
         body_of("box", 1, "positions = [[8, 8, 1], [8, 8, 3], [8, 8, 5], [8, 8, 7], [8, 8, 9]]") +
         body_of("box", 100, "position = [8, 8, 11.05]") +
         "[run]\nsteps = 30\n[output]\ncheckpoint = { every = 12 }\n")


class Program(SiltTest):
    def test_a_run_begins_where_another_has_ended(self):
        next_case = self.case.parent / "next"
        next_case.mkdir()
        text = CASE.replace("velocity = [0.02, 0, 0]\npositions = [[6, 8, 8], [18, 8, 9]]", "").replace("0.8", "1.1")
        text += '\n[initial]\nfrom = "../case/out"\n'
        (next_case / "case.toml").write_text(text)
        def fault(*options):
            """Returns what a check and a run of the next case complain of."""
            said = [self.silt(command, next_case, *options, code=2).stderr for command in ("check", "run")]
            self.assertEqual(*said)
            return said[0]
        self.assertRegex(fault("--set", "initial.from='../cse/out'"), "initial.from is '../cse/out', and .*/cse/out does not exist; name the folder of the other run's results")
        self.out.mkdir()
        self.assertRegex(fault(), "case.toml:.*initial.from is '../case/out', and there is no checkpoint in .*output.checkpoint")
        self.out.rmdir()
        self.silt("run", self.case)
        self.assertIn("has not the shape that the case gives 'ball'", fault("--set", "shapes[0].radius=2"))
        for option, what in (("domain.size=[24, 16, 24]", "its populations are of another lattice than the case's"), ("fluid.precision='double'", "its fluid is of single precision, that of the case of double")):
            self.assertRegex(fault("--set", option), f"the case cannot begin with the checkpoint .*: {what}; give the case what that run had, or let it begin with another run")
        for key in ("velocity=[0.01,0,0]", "angular_velocity=[0,0,0.01]", "orientation=[0,1,0,0]", "origin='given'"):
            self.assertIn(f"bodies[0].{key.split('=')[0]} has no effect: an entry without position names bodies of initial.from", fault("--set", "bodies[0]." + key))
        beside = text + '[[bodies]]\nname = "new"\nshape = "ball"\ndensity = 2\nposition = [6.5, 8, 11]\n'
        (next_case / "case.toml").write_text(beside)
        self.assertRegex(fault(), rf"case.toml:{beside.count(chr(10))}:1: bodies\[1\].position: the body at .* overlaps body 1 \('ball'\) of initial.from, at .* by at least .* at the start; move it away")
        (next_case / "case.toml").write_text(text)
        wall = "walls=[{ type='tube', radius=6, axis='z', point=[14.5, 8, 0] }]"
        self.assertIn("its [[walls]] are not where those of the case begin", fault("--set", wall))
        self.assertRegex(fault("--set", wall, "--unset", "fluid", "--unset", "output.fields"), r"body 1 \('ball'\) of initial.from is .*: the body reaches .* into the wall 'walls\[0\]'")
        one_more = "fill=[{ shape='ball', density=2, count=1, box=[[4, 5, 5], [10, 11, 11]] }]"  # where one is
        self.assertIn("only 0 bodies fitted", fault("--set", one_more))
        self.assertRegex(self.silt("check", next_case).stdout, "estimate")
        flow = "fluid.initial={ type='uniform', velocity=[0.01, 0, 0] }"
        self.assertIn("fluid.initial has no effect: initial.from has a fluid", self.silt("check", next_case, "--set", flow).stdout)
        newest = max(self.out.glob("checkpoint_*.h5"))
        whole = newest.read_bytes()
        newest.write_bytes(whole[:-100])
        for command in ("check", "run"):
            said = self.silt(command, next_case)
            self.assertRegex(said.stdout + said.stderr, f"warning: passed over: .*{newest.name}")
        newest.write_bytes(whole)
        self.assertRegex(self.silt("check", next_case).stdout, f"begins at the end of +{newest}")
        self.assertIn(f"begins at the end of {newest}", self.silt("run", next_case, "--steps", "20", "--overwrite").stdout)
        hashes = [json.loads((next_case / "out/report.json").read_text())["state_hash"]]
        self.silt("run", next_case, "--steps", "20", "--overwrite", ranks=3)
        hashes.append(json.loads((next_case / "out/report.json").read_text())["state_hash"])
        self.assertEqual(*hashes)
        self.assertEqual(json.loads((next_case / "out/report.json").read_text())["bodies"], 2)

    def test_run_and_resume_on_other_ranks(self):
        self.silt("run", self.case)
        whole = self.report()
        self.assertEqual(whole["exit_reason"], "completed")
        other = pathlib.Path(self.scratch.name) / "other"
        self.silt("run", self.case, "--out", other, "--steps", 25, ranks=4)
        # the checkpoint knows that this run was to end at 25, which is said as long as it holds
        self.assertIn("it has done 25 of 25 steps, where --set run.steps=25 of the earlier run still holds, until it is set again",
                      self.silt("resume", self.case, "--out", other, ranks=2).stdout)
        said = self.silt("resume", self.case, "--out", other, "--set", "run.steps=60", "--time-limit", 1e-9, ranks=2, code=4).stdout
        self.assertIn("goes on from step 25 to 60\n", said)
        stopped = self.report(other)["steps"]
        said = self.silt("resume", self.case, "--out", other, ranks=2).stdout
        self.assertIn("to 60, where --set run.steps=60 of the earlier run still holds", said)
        resumed = self.report(other)
        for spread in (*resumed["stage_seconds"].values(), resumed["memory_peak_bytes"], resumed["work"]["seconds"]):
            self.assertTrue(spread["min"] <= spread["avg"] <= spread["max"], spread)
        self.assertLess(resumed["memory_peak_bytes"]["min"], resumed["memory_peak_bytes"]["max"])
        self.assertEqual(resumed["resumed_at"], stopped)
        self.assertEqual(resumed["state_hash"], whole["state_hash"])
        self.assertEqual(resumed["quantities"], whole["quantities"])
        self.assertEqual(resumed["uncovered"], whole["uncovered"])
        import h5py
        with h5py.File(self.out / "bodies.h5") as a, h5py.File(other / "bodies.h5") as b:
            self.assertEqual(list(a["step"]), [0, 7, 14, 21, 28, 35, 42, 49, 56, 60])
            # the shorter run also wrote its last step
            self.assertEqual(list(b["step"]), [0, 7, 14, 21, 25, 28, 35, 42, 49, 56, 60])
            self.assertTrue((a["bodies/position"][-2:] == b["bodies/position"][-2:]).all())
            self.assertTrue((a["bodies/force"][-2:] == b["bodies/force"][-2:]).all())
            self.assertTrue((a["bodies/force"][-2:] != 0).any())

    def test_a_loaded_stack_goes_on_with_its_impulses(self):
        """The first step after the checkpoint is one like any other, not a start."""
        self.write(STACK)
        self.silt("run", self.case)
        whole = self.report()["state_hash"]
        other = pathlib.Path(self.scratch.name) / "other"
        self.silt("run", self.case, "--out", other, "--steps", 12)
        self.silt("resume", self.case, "--out", other, "--set", "run.steps=30", ranks=2)
        self.assertEqual(self.report(other)["state_hash"], whole)

    def test_steady_flow_ends_the_run(self):
        """After as many steps on any ranks and across a checkpoint; what is left of the approach is as little
        as asked."""
        self.write(CHANNEL)
        said = self.silt("run", self.case).stdout
        whole = self.report()
        self.assertEqual(whole["exit_reason"], "steady")
        self.assertRegex(said, rf"energy is steady at \S+, to 0.001 of it, and ends the run at step {whole['steps']} of 10000")
        self.assertIn("energy is steady", whole["exit_text"])
        self.assertEqual(whole["steps"] % 100, 0)
        self.assertLess(whole["steps"], 10000)
        self.assertTrue((self.out / f"checkpoint_{whole['steps']:012d}.h5").exists())  # its last step, as of any run
        energy = (1e-6 * 12**2) ** 2 * (1 + 7 / (8 * 12**4)) / (240 * 0.1**2)  # mean of (g y (H - y) / 2 nu)^2 / 2
        left = 1 - whole["quantities"]["energy"] / energy
        self.assertTrue(1e-4 < left < 1.01e-3, left)
        other = pathlib.Path(self.scratch.name) / "other"
        self.silt("run", self.case, "--out", other, "--steps", 550, ranks=4)
        self.assertEqual(self.report(other)["exit_reason"], "completed")
        self.silt("resume", self.case, "--out", other, "--set", "run.steps=10000", ranks=2)
        resumed = self.report(other)
        self.assertEqual((resumed["exit_reason"], resumed["steps"]), ("steady", whole["steps"]))
        self.assertEqual(resumed["state_hash"], whole["state_hash"])
        self.assertIn("energy was steady at step", self.silt("resume", self.case, "--out", other).stdout)
        self.silt("resume", self.case, "--out", other, "--set", "run.steady.change=1e-4")
        self.assertGreater(self.report(other)["steps"], whole["steps"])

    def test_sweeps_that_end_far_from_rest_are_warned_of(self):
        self.write(STACK)
        for sweeps, far in ((1, True), (400, False)):
            said = self.silt("run", self.case, "--overwrite", "--set", f"contacts.sweeps={sweeps}").stdout
            report = self.report()
            self.assertEqual(report["resolver_residual"] > 0.1 * max(report["max_body_velocity"], 1e-3), far, report["resolver_residual"])
            self.assertEqual("warning: contacts.sweeps: the sweeps over the contacts ended far from convergence" in said, far, said)
            self.assertEqual("contacts.sweeps=4" in said, far)

    def test_a_compressed_fluid_is_warned_of_with_the_cure(self):
        def said(text):
            self.write(text)
            found = self.silt("run", self.case, "--overwrite").stdout
            warned = re.search("warning: the density of the fluid deviated by up to (\\S+) %.*: (.*)", found)
            return warned and (float(warned[1]), warned[2])
        box = "boundary = {{ x = \"periodic\", y = \"periodic\", z = \"no-slip\" }}\n"
        # sound goes up and down in a box of 32 cells that is set upright: between nothing and twice 3 g z
        lattice = '[units]\nsystem = "lattice"\n[domain]\nsize = [4, 4, 32]\n' + box + "[fluid]\nrelaxation_time = 0.6\nbody_force = [0, 0, {}]\n[run]\nsteps = 400\n"
        found, cure = said(lattice.format(-5e-4))
        at_rest = 3 * 5e-2 * 32 / 12**0.5
        self.assertTrue(0.9 * at_rest < found < 2 * at_rest, (found, at_rest))
        slower = float(re.search("give all velocities times (\\S+)", cure)[1])
        self.assertTrue(0.8 * found**-0.5 < slower < found**-0.5, (slower, found))
        self.assertIsNone(said(lattice.format(-1e-4)))
        si = '[units]\nsystem = "si"\ncell_size = 1e-3\ntime_step = {}\n[domain]\nsize = [4e-3, 4e-3, 32e-3]\n' + box + "[fluid]\ndensity = 1000\nkinematic_viscosity = 1e-5\nbody_force = [0, 0, -0.5]\n[run]\ntime = 0.4\n"
        found, cure = said(si.format(1e-3))
        shorter = re.search("units.time_step = (\\S+)", cure)[1]
        self.assertLess(float(shorter), 1e-3)
        self.assertIsNone(said(si.format(shorter)))
        self.assertLess(self.report()["density_deviation"], 0.01)

    def test_an_instruction_set_that_there_is_not_is_refused(self):
        for asked in ("avx3", "AVX2"):
            done = subprocess.run([SILT, "check", self.case], capture_output=True, text=True, env={**ENVIRONMENT, "SILT_ISA": asked})
            self.assertEqual((done.returncode, done.stderr), (2, f"silt: the environment variable SILT_ISA is '{asked}'; it must be portable, avx2 or avx512\n"))
        done = subprocess.run([SILT, "check", self.case], capture_output=True, text=True, env={**ENVIRONMENT, "SILT_LAST_CACHE": "nearby"})
        self.assertEqual((done.returncode, done.stderr), (2, "silt: the environment variable SILT_LAST_CACHE is 'nearby'; it must be near or far\n"))

    def test_a_number_of_steps_with_an_exponent_is_whole(self):
        self.silt("run", self.case, "--set", "run.steps=1e1")
        self.assertEqual(self.report()["steps"], 10)
        self.silt("run", self.case, "--overwrite", "--steps", "1.2e1")
        self.assertEqual(self.report()["steps"], 12)
        self.assertIn("run.steps is 12.5; it must be a whole number", self.silt("check", self.case, "--set", "run.steps=1.25e1", code=2).stderr)

    def test_results_are_never_overwritten_silently(self):
        self.silt("run", self.case, "--steps", 5)
        first = self.report()["state_hash"]
        again = self.silt("run", self.case, "--steps", 6)
        self.assertIn("out.1", again.stdout)
        self.assertEqual(self.report(self.case / "out.1")["state_hash"], first)
        self.silt("run", self.case, "--steps", 7, "--overwrite")
        self.assertFalse((self.case / "out.2").exists())
        self.assertEqual(self.report()["steps"], 7)
        (self.out / "notes.txt").write_text("mine")
        self.assertIn("notes.txt", self.silt("run", self.case, code=2).stderr)

    def test_sigterm_on_two_ranks_leaves_a_checkpoint(self):
        self.write(CASE.replace("steps = 60", "steps = 1000000").replace("fields = { every = 20 }\n", ""))
        process = subprocess.Popen(self.command(["run", self.case], 2), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, env=ENVIRONMENT)
        while not (self.out / "checkpoint_000000000025.h5").exists():
            self.assertIsNone(process.poll())
            time.sleep(0.05)
        # mpirun kills its ranks soon after a signal: they are told themselves, as scripts/run does
        for child in pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split():
            os.kill(int(child), signal.SIGTERM)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 4, errors)
        self.assertEqual(errors.count("SIGTERM"), 1, errors)
        step = self.report()["steps"]
        self.assertTrue((self.out / f"checkpoint_{step:012d}.h5").exists())
        self.silt("resume", self.case, "--steps", step + 10)
        self.assertEqual(self.report()["steps"], step + 10)

    def test_time_limit(self):
        self.silt("run", self.case, "--steps", 1000000, "--time-limit", 1, "--set", "output.fields.every=0", code=4)
        self.assertIn("time limit", self.report()["exit_text"])

    def test_guard_of_the_fluid(self):
        self.write(re.sub(r"\[gravity\].*?(?=\[run\])", "", CASE, flags=re.S).replace("0.8", '0.50001\ncollision = "bgk"\n'
                   "body_force = [1e-2, 2e-2, 0]").split("[output]")[0].replace("steps = 60", "steps = 1000"))
        for ranks in (1, 4):
            errors = self.silt("run", self.case, "--overwrite", ranks=ranks, code=3).stderr
            self.assertEqual(errors.count(": the fluid at cell ["), 1, errors)
            self.assertIn("raise fluid.relaxation_time", errors)
            self.assertIn("no checkpoint has been written", errors)
            self.assertEqual(self.report()["exit_reason"], "guard")

    def test_bad_case_and_usage(self):
        self.write(CASE.replace("relaxation_time", "relaxation_tiem"))
        for ranks in (1, 2):
            errors = self.silt("run", self.case, ranks=ranks, code=2).stderr
            self.assertEqual(errors.count("did you mean 'relaxation_time'"), 1, errors)
        self.assertFalse(self.out.exists())
        self.silt("run", code=2)
        self.silt("walk", self.case, code=2)
        errors = self.silt("run", self.case, "--steps", 0, code=2).stderr
        self.assertEqual(errors.splitlines()[0], "--steps: 0 is not a number above 0")
        self.silt("resume", self.case, code=2)
        self.assertIn("did you mean 'case'?", self.silt("resume", self.case.parent / "csae", ranks=2, code=2).stderr)
        self.write(CASE)
        self.assertIn("blocks", self.silt("run", self.case, "--set", "domain.blocks=[24, 16, 16]", ranks=2, code=2).stderr)
        self.assertIn("silt", self.silt("--version").stdout)
        self.assertIn("relaxation time", self.silt("check", self.case).stdout)

    def test_the_table_counts_what_is_written(self):
        table = self.silt("check", self.case).stdout
        self.silt("run", self.case)
        import h5py
        with h5py.File(self.out / "bodies.h5") as f:
            bodies = len(f["step"])
        for name, times in (("fields", len(list(self.out.glob("fields_*.hdf")))), ("bodies", bodies),
                            ("checkpoints", len(list(self.out.glob("checkpoint_*.h5"))))):
            self.assertRegex(table, rf"{name} +every \d+ steps, .*at the end, {times} times\n")

    def test_info(self):
        self.silt("run", self.case, "--steps", 5)
        for name, word in (("bodies.h5", "angular_velocity"), ("fields_000000000000.hdf", "density"),
                           ("checkpoint_000000000005.h5", "populations")):
            said = subprocess.run(["/usr/bin/python3", "-m", "silt_results", self.out / name], cwd=SCRIPTS, capture_output=True,
                                  text=True, check=True).stdout
            self.assertIn(word, said)
            self.assertIn("two balls", said)
        of_case = self.silt("info", self.case).stdout
        for part in ("two balls", "24 x 16 x 16 cells", f"results in {self.out}", "bodies.h5", "checkpoint_000000000005.h5", "2 files, ", "the last fields_000000000005.hdf", "step 5/5"):
            self.assertIn(part, of_case)
        self.assertEqual(self.silt("info", self.case / "case.toml").stdout, of_case)
        of_results = self.silt("info", self.out).stdout
        self.assertTrue(of_case.endswith(of_results) and of_results.startswith("results in"))
        shutil.rmtree(self.out)
        self.assertIn("no results\n", self.silt("info", self.case).stdout)
        self.assertIn("neither a case", self.silt("info", self.scratch.name, code=2).stderr)
        self.assertIn("python3 -m silt_results FILE", self.silt("info", self.case / "reference.toml.h5", code=2).stderr)
        self.write(CASE.replace("0.8", "0.4"))
        self.assertIn("fluid.relaxation_time", self.silt("info", self.case, code=2).stderr)

    def test_lines_are_printed_over_on_a_terminal_only(self):
        """mpirun gives its first rank a terminal, wherever its own output goes."""
        environment = {name: value for name, value in ENVIRONMENT.items() if name != "SILT_PLAIN"}
        for ranks in (1, 2):
            log = pathlib.Path(self.scratch.name) / "log"
            with open(log, "wb") as file:
                subprocess.run(self.command(["run", self.case, "--overwrite"], ranks), stdout=file, check=True, env=environment)
            self.assertNotIn(b"\r", log.read_bytes())
            self.assertIn(b"step 60/60", log.read_bytes())
            above, below = pty.openpty()
            subprocess.run(self.command(["run", self.case, "--overwrite"], ranks), stdout=below, check=True, env=environment)
            os.close(below)
            shown = b""
            while chunk := self.read_of_a_terminal(above):
                shown += chunk
            os.close(above)
            self.assertRegex(shown.replace(b"\r\n", b"\n"), rb"\rstep 60/60")

    @staticmethod
    def read_of_a_terminal(terminal):
        try:
            return os.read(terminal, 65536)
        except OSError:  # nobody writes there any more
            return b""

    def test_full_disk(self):
        """A limit on the size of files, set while the run goes on, stands for a full disk."""
        self.write(CASE.replace("steps = 60", "steps = 1000000").replace("every = 25", "every = 250"))
        ignore = lambda: signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # noqa: E731
        process = subprocess.Popen(self.command(["run", self.case, "--set", "output.fields.every=0"], 1), text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=ENVIRONMENT, preexec_fn=ignore)
        first = self.out / "checkpoint_000000000250.h5"
        while not first.exists():
            self.assertIsNone(process.poll())
            time.sleep(0.02)
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (100_000, 100_000))
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, errors)
        self.assertRegex(errors, r"checkpoint_\d+\.h5|bodies\.h5")
        self.assertIn("last checkpoint", errors)
        self.assertFalse(list(self.out.glob("*.part")))
        step = max(int(path.stem.split("_")[1]) for path in self.out.glob("checkpoint_*.h5"))
        self.silt("resume", self.case, "--steps", step + 10)
        self.assertEqual(self.report()["resumed_at"], step)


class Launcher(unittest.TestCase):
    """scripts/run in a tree of its own, where nothing is built and nothing drawn."""

    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory(prefix="silt-launch-")
        self.root = pathlib.Path(self.scratch.name)
        for folder in ("scripts", "cases/two-balls", "build/release/bin", "elsewhere"):
            (self.root / folder).mkdir(parents=True)
        shutil.copy(SCRIPTS / "run", self.root / "scripts/run")
        self.program("scripts/build", "exit 0")
        (self.root / "build/release/bin/silt").symlink_to(SILT)
        (self.root / "cases/two-balls/case.toml").write_text(CASE)

    def tearDown(self):
        self.scratch.cleanup()

    def program(self, name, text):
        path = self.root / name
        path.unlink(missing_ok=True)
        path.write_text(f"#!/bin/bash\n{text}\n")
        path.chmod(0o755)

    def launch(self, *arguments, code=0):
        result = subprocess.run([self.root / "scripts/run", *map(str, arguments)], capture_output=True, text=True,
                                env=ENVIRONMENT, timeout=120, cwd=self.root / "elsewhere")
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result

    def test_finds_a_case_from_anywhere(self):
        for case in ("two-balls", "cases/two-balls", "../cases/two-balls/", "../cases/two-balls/case.toml"):
            self.launch(case, "--steps", 2, "--out", "out", "--overwrite")
            self.assertTrue((self.root / "elsewhere/out/report.json").exists(), case)

    def test_says_why_it_builds(self):
        for room in ("silt/python", "lbm"):
            (self.root / room).mkdir(parents=True)
        self.program("build/release/bin/silt", "exit 0")
        said = []
        for source in ("silt/python/module.cpp", "lbm/README.md", "lbm/cell.hpp"):
            (self.root / source).touch()
            said.append(self.launch("two-balls").stderr)
        self.assertEqual(said[:2], ["", ""])
        self.assertIn("lbm/cell.hpp is newer than what is built", said[2])
        self.assertEqual(self.launch("two-balls", "--silt", "../build/release/bin/silt").stderr, "")

    def test_says_which_cases_there_are(self):
        errors = self.launch("two-bals", code=2).stderr
        self.assertIn("no case two-bals", errors)
        self.assertIn("among Silt's: two-balls\n", errors)
        self.assertIn("There are: two-balls\n", self.launch(code=2).stderr)

    def test_ctrl_c_is_told_as_such(self):
        for ranks in (1, 2):
            run = subprocess.Popen([self.root / "scripts/run", "two-balls", "-n", str(ranks), "--out", "out", "--overwrite", "--steps", "1000000",
                                    "--set", "output.fields.every=0"], cwd=self.root / "elsewhere", env=ENVIRONMENT, text=True,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
            while not list((self.root / "elsewhere/out").glob("checkpoint_*.h5")):
                self.assertIsNone(run.poll())
                time.sleep(0.05)
            run.send_signal(signal.SIGINT)
            errors = run.communicate(timeout=60)[1]
            self.assertEqual(run.returncode, 4, errors)
            self.assertIn("told to stop by SIGINT (Ctrl-C) at step", errors)
            shutil.rmtree(self.root / "elsewhere/out")

    def test_says_how_to_go_on(self):
        errors = self.launch("two-balls", "-n", 2, "--out", "out", "--steps", 1000000, "--time-limit", 1,
                             "--set", "output.fields.every=0", code=4).stderr
        last = max((self.root / "elsewhere/out").glob("checkpoint_*.h5"))
        command = f"{self.root}/scripts/run two-balls -n 2 --out out --resume"
        self.assertIn(f"go on from out/{last.name} with: {command}\n", errors)
        self.program("build/release/bin/silt", "kill -9 $$")
        errors = self.launch("two-balls", "--out", "out", code=137).stderr
        self.assertIn("killed (SIGKILL)", errors)
        self.assertIn(f"go on from out/{last.name}", errors)


if __name__ == "__main__":
    unittest.main()
