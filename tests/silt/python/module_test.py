"""The tests of the module `silt` share this. The arguments of a test are the program and the folder of the module; without
a folder there is no module: skipped."""
import pathlib
import subprocess
import sys
import textwrap
import warnings

if len(sys.argv) < 3:
    print("skipped: built without pybind11, so there is no module")
    sys.exit(77)
MODULE = pathlib.Path(sys.argv.pop(2)).resolve()
ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(MODULE), str(ROOT / "scripts"), str(ROOT / "tests/silt/run")]

import silt  # noqa: E402
from silt_test import ENVIRONMENT, SiltTest  # noqa: E402
from silt_runs import MPIRUN  # noqa: E402


class ModuleTest(SiltTest):
    def setUp(self):
        super().setUp()
        warnings.simplefilter("ignore")

    def simulation(self, text, **options):
        self.write(text)
        return silt.Simulation(self.case, **options)

    def script(self, program, ranks):
        """Runs a program with the module on so many ranks."""
        file = self.case / "program.py"
        file.write_text(textwrap.dedent(program))
        command = (MPIRUN + ["-np", str(ranks)] if ranks > 1 else []) + ["/usr/bin/python3", str(file)]
        return subprocess.run(command, capture_output=True, text=True, timeout=60, cwd=self.case,
                              env=dict(ENVIRONMENT, PYTHONPATH=str(MODULE), PYTHONWARNINGS="ignore"))
