"""The tests of the program silt share this: cases, and a scratch folder with one of them for each test. The first
argument of the test is the program."""
import csv
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))
from silt_runs import ENVIRONMENT, ROOT, SCRIPTS, WALLS_ACROSS_Z, body_of, command, domain_of, shape_of  # noqa: E402, F401

SILT = os.path.abspath(sys.argv.pop(1))

CASE = ('title = "two balls"\n' + domain_of([24, 16, 16], WALLS_ACROSS_Z) +
        "blocks = [6, 8, 16]\n[fluid]\nrelaxation_time = 0.8\n" +
        "[gravity]\nacceleration = [0, 0, -1e-4]\n" + shape_of("ball", "sphere", "radius = 2.5") +
        body_of("ball", 1.5, "velocity = [0.02, 0, 0]", "positions = [[6, 8, 8], [18, 8, 9]]") +
        "[run]\nsteps = 60\n" + "[output]\nfields = { every = 20 }\nbodies = { every = 7 }\n" +
        "checkpoint = { every = 25, keep = 3 }\n" +
        '[[quantities]]\nname = "height"\ntype = "mean-height"\n')

# Light bodies whose drag acts a step too late: a guard stops the run after two steps.
UNSTABLE = CASE.replace("density = 1.5", "density = 0.05").replace("[gravity]", '[coupling]\ntime = "explicit"\n[gravity]')
UNSTABLE = UNSTABLE.replace("velocity = [0.02, 0, 0]", "velocity = [0.05, 0, 0]")

CHANNEL = (domain_of([8, 8, 12], '{ x = "periodic", y = "periodic", z = "no-slip" }') +
           "blocks = [4, 4, 6]\n" + '[fluid]\nrelaxation_time = 0.8\nmagic = 0.1875\nprecision = "double"\n' +
           "body_force = [1e-6, 0, 0]\n" +
           '[run]\nsteps = 10000\nsteady = { quantity = "energy", change = 1e-3, every = 100 }\n' +
           "[output]\ncheckpoint = { every = 250 }\n" +
           '[[quantities]]\nname = "energy"\ntype = "kinetic-energy"\n')


def script(name, *arguments, code=0, **options):
    """Runs a script of scripts/; returns what it says. File names that are no UTF-8 stay what they are."""
    done = subprocess.run([SCRIPTS / name, *map(str, arguments)], capture_output=True, text=True, errors="surrogateescape",
                          stdin=subprocess.DEVNULL, **options)
    assert done.returncode == code, (name, arguments, done.returncode, done.stdout, done.stderr)
    return done.stdout + done.stderr


def module_of(name):
    """Returns a script of scripts/ as a module."""
    loader = importlib.machinery.SourceFileLoader(name, str(SCRIPTS / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    sys.dont_write_bytecode = True
    loader.exec_module(module)
    return module


class SiltTest(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory(prefix="silt-run-")
        self.case = pathlib.Path(self.scratch.name) / "case"
        self.out = self.case / "out"
        self.case.mkdir()
        self.write(CASE)

    def tearDown(self):
        self.scratch.cleanup()

    def write(self, text):
        (self.case / "case.toml").write_text(text)

    def command(self, arguments, ranks):
        return command(SILT, *arguments, ranks=ranks)

    def run_silt(self, *arguments, ranks=1, **options):
        return subprocess.run(self.command(arguments, ranks), capture_output=True, text=True, env=ENVIRONMENT, timeout=120,
                              **options)

    def silt(self, *arguments, ranks=1, code=0, **options):
        result = self.run_silt(*arguments, ranks=ranks, **options)
        if code is not None:
            self.assertEqual(result.returncode, code, f"{arguments}\n{result.stdout}{result.stderr}")
        return result

    def report(self, out=None):
        return json.loads(((out or self.out) / "report.json").read_text())

    def rows(self, name, folder=None):
        """Returns the lines of a CSV file of the results as dictionaries."""
        with open((folder or self.out) / name, newline="") as stream:
            return list(csv.DictReader(stream))

    def forget(self, *steps):
        """Removes the checkpoints of these steps."""
        for step in steps:
            (self.out / f"checkpoint_{step:012}.h5").unlink()
