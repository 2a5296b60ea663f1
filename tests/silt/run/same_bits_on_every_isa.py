#!/usr/bin/python3
"""same_bits_on_every_isa.py SILT CASES: the kernels of every instruction set of this machine give the same state
as the portable ones, to the bit. Exit code 77 where the machine has the portable ones only: the ctest entry then
reads "Skipped"."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

LACKING = 77
silt, cases = sys.argv[1], pathlib.Path(sys.argv[2])
wider = ["avx2", "avx512"]


def state(case, asked, *options):
    """The instruction set that ran and the state it led to."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out"
        subprocess.run([silt, "run", cases / case, "--out", out, *options], check=True, stdout=subprocess.DEVNULL,
                       env={**os.environ, "SILT_ISA": asked})
        report = json.loads((out / "report.json").read_text())
        return report["instruction_set"], report["state_hash"]


for case, *options in [("segregation", "--set", "run.steps=40"), ("settling-sphere", "--set", "run.steps=60"),
                       ("sphere-array", "--set", "run.steps=200")]:
    plain, expected = state(case, "portable", *options)
    assert plain == "portable", plain
    for isa in list(wider):
        ran, found = state(case, isa, *options)
        if ran != isa:
            print(f"this machine has no {isa}: silt ran with {ran}")
            wider.remove(isa)
            continue
        print(f"{case}: portable {expected}, {isa} {found}")
        assert found == expected, f"{case}: the state depends on the instruction set"
sys.exit(0 if wider else LACKING)
