#!/usr/bin/python3
"""case_commands.py SILT: scripts/clean, new-case and compare do what they say, and nothing else; every
command explains itself at once."""
import os
import pathlib
import re
import shutil
import subprocess
import time
import unittest

from silt_test import SCRIPTS, SILT, SiltTest, script


class Commands(SiltTest):
    def test_clean(self):
        self.silt("run", self.case)
        self.silt("run", self.case)  # the first is in out.1 now
        self.assertIn("would delete", script("clean", self.case))
        self.assertTrue((self.out / "report.json").exists())
        self.assertIn("deleted", script("clean", self.case, "--yes"))
        self.assertFalse(self.out.exists())
        self.assertTrue((self.case / "out.1").exists())
        (self.case / "out.1" / "notes.txt").write_text("mine")
        self.assertIn("notes.txt is no result", script("clean", self.case, "--all", "--yes", code=1))
        self.assertTrue((self.case / "out.1" / "report.json").exists())
        (self.case / "out.1" / "notes.txt").unlink()
        script("clean", self.case, "--all", "--yes")
        self.assertEqual([path.name for path in self.case.iterdir()], ["case.toml"])

    def test_clean_keeps_a_link(self):
        disk = pathlib.Path(self.scratch.name) / "disk"
        disk.mkdir()
        self.out.symlink_to(disk)
        for _ in range(2):
            self.silt("run", self.case, "--steps", 1)
        script("clean", self.case, "--yes")
        self.assertEqual([path.name for path in disk.iterdir()], ["out.1"])
        script("clean", self.case, "--all", "--yes")
        self.assertEqual([path.name for path in self.out.iterdir()], [])

    def test_clean_leaves_a_run_alone(self):
        run = subprocess.Popen(self.command(["run", self.case, "--steps", 1000000], 1), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            while not (self.out / "run.log").exists():
                time.sleep(0.05)
            self.assertIn("a run is writing there", script("clean", self.case, "--yes", code=1))
            self.assertTrue((self.out / "run.log").exists())
        finally:
            run.kill()
            run.wait()

    def test_new_case(self):
        made = pathlib.Path(self.scratch.name) / "my-tank"
        self.assertIn("case.toml, from settling-sphere", script("new-case", made, "--from", "settling-sphere"))
        self.assertIn("my tank", self.silt("check", made).stdout)
        self.assertEqual([path.name for path in made.iterdir()], ["case.toml"])
        self.assertIn("is there already", script("new-case", made, code=2))
        self.assertIn("Silt's cases are", script("new-case", f"{made}2", "--from", "setling", code=2))
        self.assertFalse(pathlib.Path(f"{made}2").exists())

    def test_new_case_takes_its_files(self):
        for case in sorted((SCRIPTS.parent / "cases").glob("*/case.toml")):
            made = pathlib.Path(self.scratch.name) / case.parent.name
            script("new-case", made, "--from", case.parent.name)
            self.silt("check", made)

    def test_compare(self):
        other, third = (pathlib.Path(self.scratch.name) / name for name in ("other", "third"))
        self.silt("run", self.case)
        self.silt("run", self.case, "--out", other, ranks=2)
        said = script("compare", self.case, other)
        self.assertIn("ranks", said)
        self.assertIn("the states are the same to the bit", said)
        unread, end = os.pipe()
        os.close(unread)  # as `| head` does that has seen enough
        self.assertEqual(subprocess.run([SCRIPTS / "compare", self.case, other], stdout=end, stderr=subprocess.PIPE).stderr, b"")
        os.close(end)
        self.silt("run", self.case, "--out", third, "--set", "fluid.relaxation_time=0.9")
        said = script("compare", self.case, third, code=1)
        self.assertIn("+# --set fluid.relaxation_time=0.9", said)
        self.assertIn("quantities.height", said)
        self.assertIn("largest difference in velocity", said)
        page = pathlib.Path(self.scratch.name) / "runs.html"
        said = script("compare", self.case, other, third, "--page", page, code=1)
        self.assertIn(f"bodies at the end of {third}", said)
        self.assertNotIn(f"bodies at the end of {other}", said)
        self.assertRegex(said, rf"relaxation_time.*\n|ranks +1 +2 +1\n")
        figure = re.search("<figure>.*?</figure>", page.read_text(), flags=re.S)[0]
        self.assertTrue(all(str(run) in figure for run in (self.case, other, third)))
        self.assertIn("name two or more", script("compare", self.case, code=2))
        self.assertIn("report.json: not there", script("compare", self.case, self.scratch.name, code=1))
        report = other / "report.json" if (other / "report.json").exists() else other / "out/report.json"
        report.write_text(report.read_text()[:200])
        self.assertRegex(script("compare", self.case, other, code=1), "report.json: not whole: .*; let the run write it again")

    def test_compare_of_runs_of_different_lengths(self):
        other = pathlib.Path(self.scratch.name) / "other"
        self.silt("run", self.case, "--set", "output.report.every=20")
        self.silt("run", self.case, "--out", other, "--set", "output.report.every=20", "--steps", 50)
        page = pathlib.Path(self.scratch.name) / "runs.html"
        said = script("compare", self.case, other, "--page", page, code=1)
        self.assertIn("the runs end at different times, 60, 50: results are compared at 40, the last time that all have in series.csv", said)
        self.assertNotIn("results\n", said)
        self.assertNotIn("bodies at", said)
        self.assertIn("The runs end at different times", page.read_text())
        (other / "series.csv").unlink()
        self.assertIn("and their results are not compared", script("compare", self.case, other, code=1))

    def test_every_command_explains_itself(self):
        for path in sorted(SCRIPTS.iterdir()):
            if path.is_file() and os.access(path, os.X_OK):
                start = time.monotonic()
                self.assertGreater(len(script(path.name, "--help")), 60, path.name)
                self.assertLess(time.monotonic() - start, 5, path.name)

    def test_completion(self):
        def completed(function, *words, folder=SCRIPTS.parent):
            quoted = " ".join(f"'{word}'" for word in words)
            done = subprocess.run(
                ["bash", "-c", f"source '{SCRIPTS}/completion.bash'; COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; {function}; "
                               "printf '%s\\n' \"${COMPREPLY[@]}\""], capture_output=True, text=True, check=True, cwd=folder)
            return done.stdout.split()

        program = SILT
        self.assertEqual(completed("_silt", program, "r"), ["run", "resume"])
        self.assertEqual(completed("_silt", program, "run", "--ov"), ["--overwrite"])
        self.assertEqual(completed("_silt", program, "run", "--backend", "bu"), ["bullet"])
        self.assertEqual(completed("_silt", program, "check", "case", folder=self.scratch.name), ["case"])
        self.assertEqual(completed("_silt", program, "run", "--set", "contacts.fr"), ["contacts.friction="])
        self.assertEqual(completed("_silt", program, "run", "--unset", "run.bal"), ["run.balance", "run.balance.every"])
        self.assertEqual(completed("_silt_script", "scripts/run", "settling-sphere-"), ["settling-sphere-e1", "settling-sphere-levels"])
        self.assertEqual(completed("_silt_script", "scripts/run", "cases/bouncing"), ["cases/bouncing-ball"])
        self.assertIn("--hostfile", completed("_silt_script", "scripts/run", "--"))
        self.assertEqual(completed("_silt_script", "/bin/run", "--"), [])

    def test_run_takes_another_program(self):
        said = script("run", self.case, "--silt", SILT)
        self.assertIn("report.html", said)
        self.assertIn("no such program", script("run", self.case, "--silt", "/nowhere/silt", code=2))

    @unittest.skipUnless(os.geteuid() == 0 and shutil.which("setpriv"), "only root can act as somebody else")
    def test_run_in_a_tree_of_somebody_else(self):
        folder = pathlib.Path(self.scratch.name)
        (folder / "tree" / "scripts").mkdir(parents=True)
        shutil.copy(SCRIPTS / "run", folder / "tree" / "scripts")
        (folder / "bin").mkdir()
        for path in (folder, folder / "tree", folder / "tree" / "scripts", folder / "bin"):
            path.chmod(0o755)

        def run():
            path = f"{folder}/bin:/usr/bin:/bin"
            return subprocess.run(["setpriv", "--reuid", "65534", "--clear-groups", folder / "tree" / "scripts" / "run", self.case],
                                  capture_output=True, text=True, cwd="/", env={"PATH": path})

        refused = run()
        self.assertEqual(refused.returncode, 2)
        self.assertRegex(refused.stderr, "tree cannot be written to.*scripts/build, or use --silt")
        (folder / "bin" / "silt").write_text("#!/bin/sh\necho installed: $1\n")
        (folder / "bin" / "silt").chmod(0o755)
        self.assertEqual(run().stdout, "installed: run\n")

    def tiny_tree(self):
        """A tree whose build takes a second and fails where two do it at once."""
        tree = pathlib.Path(self.scratch.name) / "tree"
        (tree / "scripts").mkdir(parents=True)
        shutil.copy(SCRIPTS / "build", tree / "scripts")
        (tree / "scripts/setup").write_text("#!/bin/sh\n")
        (tree / "scripts/setup").chmod(0o755)
        (tree / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.22...3.25)\nproject(tiny NONE)\nadd_custom_target(short ALL COMMAND mkdir "
                                             "busy COMMAND ${CMAKE_COMMAND} -E sleep 1 COMMAND rmdir busy)\n")
        (tree / "CMakePresets.json").write_text('{"version": 3, "configurePresets": [{"name": "release", "generator": "Ninja", '
                                                '"binaryDir": "${sourceDir}/build/release"}]}')
        return tree

    def test_build_lets_go_of_the_pipe_that_it_writes_to(self):
        begun = time.monotonic()
        done = subprocess.run([self.tiny_tree() / "scripts/build"], capture_output=True, text=True, check=False)  # reads until nobody writes
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertLess(time.monotonic() - begun, 8)  # it tells how far it is each 10 s

    def test_build_says_how_silt_is_found_from_anywhere(self):
        tree = self.tiny_tree()
        (tree / "build/release/bin").mkdir(parents=True)
        silt = tree / "build/release/bin/silt"
        silt.write_text("#!/bin/sh\necho it is $1\n")
        silt.chmod(0o755)
        said = subprocess.run([tree / "scripts/build"], capture_output=True, text=True, check=True).stdout
        command = said.removeprefix("build: silt is found from anywhere after: ")
        self.assertNotEqual(command, said)
        done = subprocess.run(["bash", "-c", f"{command}silt here; {tree}/scripts/build"], capture_output=True, text=True, cwd="/")
        self.assertEqual((done.stdout, done.stderr), ("it is here\n", ""))
        of_one = subprocess.run([tree / "scripts/build", "release", "short"], capture_output=True, text=True, check=True)
        self.assertEqual(of_one.stdout, "")

    def test_two_builds_of_a_tree_come_one_after_the_other(self):
        command = [self.tiny_tree() / "scripts/build"]
        builds = [subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(2)]
        said = sorted(build.communicate(timeout=60)[1] for build in builds)
        self.assertEqual([build.returncode for build in builds], [0, 0], said)
        self.assertEqual(said, ["", "build: waits until another build of this tree has ended\n"])

    def test_a_wrong_word_gets_the_nearest(self):
        self.assertIn("did you mean 'check'?", self.silt("chek", self.case, code=2).stderr)
        self.assertIn("no key of a case begins with 'flud'", self.silt("keys", "flud", code=2).stderr)
        self.assertIn("fluid.density", self.silt("keys", "fluid").stdout)
        self.assertRegex(self.silt("--version").stdout, r"silt .*\n.*Open MPI.*HDF5.*Bullet.*FCL")


if __name__ == "__main__":
    unittest.main()
