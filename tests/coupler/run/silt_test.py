"""What the tests of the program silt share: cases, and a scratch folder with one of them for each test. The first
argument of the test is the program."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SILT = os.path.abspath(sys.argv.pop(1))
MPIRUN = ["mpirun", "--oversubscribe", "--allow-run-as-root", "--quiet"]
ENVIRONMENT = dict(os.environ, OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_rmaps_base_oversubscribe="1", SILT_PLAIN="1")

CASE = """
title = "two balls"
[units]
system = "lattice"
[domain]
size = [24, 16, 16]
boundary = { x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] }
blocks = [6, 8, 16]
[fluid]
relaxation_time = 0.8
[gravity]
acceleration = [0, 0, -1e-4]
[[shapes]]
name = "ball"
type = "sphere"
radius = 2.5
[[bodies]]
shape = "ball"
density = 1.5
velocity = [0.02, 0, 0]
positions = [[6, 8, 8], [18, 8, 9]]
[run]
steps = 60
[output]
fields = { every = 20 }
bodies = { every = 7 }
checkpoint = { every = 25, keep = 3 }
[[quantities]]
name = "height"
type = "mean-height"
"""

# Light bodies whose drag acts a step too late: a guard stops the run after two steps.
UNSTABLE = CASE.replace("density = 1.5", "density = 0.05").replace("[gravity]", '[coupling]\ntime = "explicit"\n[gravity]')
UNSTABLE = UNSTABLE.replace("velocity = [0.02, 0, 0]", "velocity = [0.05, 0, 0]")

CHANNEL = """
[units]
system = "lattice"
[domain]
size = [8, 8, 12]
boundary = { x = "periodic", y = "periodic", z = "no-slip" }
blocks = [4, 4, 6]
[fluid]
relaxation_time = 0.8
magic = 0.1875
precision = "double"
body_force = [1e-6, 0, 0]
[run]
steps = 10000
steady = { quantity = "energy", change = 1e-3, every = 100 }
[output]
checkpoint = { every = 250 }
[[quantities]]
name = "energy"
type = "kinetic-energy"
"""


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
        return (MPIRUN + ["-np", str(ranks)] if ranks > 1 else []) + [SILT] + [str(a) for a in arguments]

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
