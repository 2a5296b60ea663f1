#!/usr/bin/python3
"""same_bits_on_every_isa.py SILT CASES ISA: the kernels of an instruction set and the portable ones give the
same state, to the bit. Exit code 77 where this machine lacks the instruction set: its ctest entry then reads
"Skipped"."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

LACKING = 77
silt, cases, isa = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]


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
    ran, found = state(case, isa, *options)
    assert plain == "portable", plain
    if ran != isa:
        print(f"this machine has no {isa}: silt ran with {ran}")
        sys.exit(LACKING)
    print(f"{case}: portable {expected}, {isa} {found}")
    assert found == expected, f"{case}: the state depends on the instruction set"
