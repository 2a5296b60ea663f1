#!/usr/bin/python3
"""same_bits_of_every_libm.py SILT CASES: no state depends on how the C library rounds sines, logarithms and
the like. glibc has others for processors without fused multiply-add, and can be told to take them. Exit code
77, "Skipped", where they round alike."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

ALIKE = 77
silt, cases = sys.argv[1], pathlib.Path(sys.argv[2])
WITHOUT = {**os.environ, "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2", "SILT_ISA": "portable"}
WITH = {**os.environ, "SILT_ISA": "portable"}
SINES = "import math; print(hash(tuple(f(1e-3 * k) for f in (math.sin, math.cos, math.log1p, math.exp) for k in range(3000))))"


def sines(environment):
    return subprocess.run(["/usr/bin/python3", "-c", SINES], env=environment, check=True, capture_output=True).stdout


def state(case, options, environment):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        command = [silt, "run", cases / case, "--out", out, "--unset", "output"]
        subprocess.run([*command, *(word for option in options for word in ("--set", option))], check=True,
                       stdout=subprocess.DEVNULL, env=environment)
        return json.loads((out / "report.json").read_text())["state_hash"]


if sines(WITH) == sines(WITHOUT):
    print("the C library of this machine rounds alike with and without fused multiply-add")
    sys.exit(ALIKE)
failed = 0
for case, *options in [("packing", "run.steps=20"), ("packing-ellipsoids", "run.steps=5"), ("hopper", "run.steps=20"),
                       ("segregation-mixed", "run.steps=2"), ("wet-rebound", "run.steps=20"),
                       ("taylor-green", "run.steps=5"), ("funnel", "run.steps=20"), ("wall-of-boxes", "run.steps=20")]:
    one, other = state(case, options, WITH), state(case, options, WITHOUT)
    print(f"{case}: with {one}, without {other}")
    failed += one != other
sys.exit(f"{failed} states depend on the C library" if failed else 0)
