#!/usr/bin/python3
"""same_bits_on_every_isa.py SILT CASES: the kernels of every instruction set give the same state, to the bit."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

silt, cases = sys.argv[1], pathlib.Path(sys.argv[2])


def state(case, isa, *options):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        subprocess.run([silt, "run", cases / case, "--out", out, *options], check=True, stdout=subprocess.DEVNULL,
                       env={**os.environ, "SILT_ISA": isa})
        report = json.loads((out / "report.json").read_text())
        return report["instruction_set"], report["state_hash"]


for case, *options in [("segregation", "--set", "run.steps=40"), ("settling-sphere", "--set", "run.steps=60"),
                       ("sphere-array", "--set", "run.steps=200")]:
    found = {isa: state(case, isa, *options) for isa in ("portable", "avx2", "avx512")}
    print(case, found)
    assert found["portable"][0] == "portable"
    assert len({hash_ for _, hash_ in found.values()}) == 1, f"{case}: the state depends on the instruction set"
