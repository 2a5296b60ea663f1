#!/usr/bin/python3
"""own_symbols.py FILE...: no program or library of Silt defines a function of MPI: a host program and its
profiler have their own."""
import re
import subprocess
import sys

for file in sys.argv[1:]:
    defined = subprocess.run(["nm", "--defined-only", file], capture_output=True, text=True, check=True).stdout
    assert "silt" in defined, f"{file}: nm shows nothing of Silt"
    if of_mpi := re.findall(r" [A-Za-z] (P?MPI_\w+)$", defined, re.MULTILINE):
        sys.exit(f"{file} defines {', '.join(sorted(set(of_mpi)))}")
