#!/usr/bin/python3
"""same_bits_on_every_processor.py SILT CASES: the kernels of every instruction set of this machine give the same
state as the portable ones, and no state depends on how the C library rounds sines, logarithms and the like: glibc
has others for processors without fused multiply-add, and can be told to take them. Exit code 77 where this machine
has nothing else: the ctest entry then reads "Skipped"."""
import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))
from silt_runs import report_of, run  # noqa: E402

LACKING = 77
silt, cases = sys.argv[1], pathlib.Path(sys.argv[2])
PORTABLE = {**os.environ, "SILT_ISA": "portable"}
WITHOUT_FMA = {**PORTABLE, "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2"}
SINES = "import math; print(hash(tuple(f(1e-3 * k) for f in (math.sin, math.cos, math.log1p, math.exp) for k in range(3000))))"
OF_KERNELS = {"segregation": 40, "settling-sphere": 60, "sphere-array": 200}  # steps
OF_LIBRARY = {"packing": 20, "packing-ellipsoids": 5, "hopper": 20, "segregation-mixed": 2, "wet-rebound": 20, "taylor-green": 5,
              "funnel": 20, "wall-of-boxes": 20}


def sines(environment):
    return subprocess.run(["/usr/bin/python3", "-c", SINES], env=environment, check=True, capture_output=True).stdout


def state(case, steps, environment):
    """Returns the instruction set that ran and the state it led to."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        run(silt, "run", cases / case, "--out", out, "--steps", steps, env=environment)
        report = report_of(out)
        return report["instruction_set"], report["state_hash"]


others = {}
for isa in ("avx2", "avx512"):
    environment = {**os.environ, "SILT_ISA": isa}
    if (ran := state("sphere-array", 1, environment)[0]) == isa:
        others[isa] = environment, OF_KERNELS
    else:
        print(f"this machine has no {isa}: silt ran with {ran}")
if sines(PORTABLE) != sines(WITHOUT_FMA):
    others["the other rounding"] = WITHOUT_FMA, OF_LIBRARY
failed = 0
for case, steps in (OF_KERNELS | OF_LIBRARY).items():
    asked = {what: environment for what, (environment, of) in others.items() if case in of}
    if not asked:
        continue
    isa, expected = state(case, steps, PORTABLE)
    assert isa == "portable", isa
    for what, environment in asked.items():
        found = state(case, steps, environment)[1]
        print(f"{case}: portable {expected}, {what} {found}")
        failed += found != expected
sys.exit(f"{failed} states depend on the processor" if failed else 0 if others else LACKING)
