#!/usr/bin/python3
"""own_symbols.py PROGRAM LIBRARY...: what the program and the libraries of Silt must not define.

No function of MPI: a host program and its profiler have their own. In the program, code of wide vectors is in functions of its own
alone (namespaces avx2 and avx512; clones are local to their files): an inline function that a kernel's file compiles as well could
serve all files, and a processor without these vectors would stop at it.
"""
import re
import subprocess
import sys

LABEL = re.compile(r"^[0-9a-f]+ <(.*)>:$")


def wide_functions(program):
    """Returns the functions, but for those of wide vectors, with an instruction in their encoding, whose names begin with v."""
    command = ["objdump", "--disassemble", "--demangle", "--no-show-raw-insn", program]
    found, name = set(), ""
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, errors="replace") as lines:
        for line in lines.stdout:
            if label := LABEL.match(line):
                name = label[1]
            elif "\tv" in line and not re.search(r"::avx(2|512)::|\[clone ", name) and not re.search(r"\tver[rw]\b", line):
                found.add(name)
    assert lines.returncode == 0 and name, f"{program}: objdump shows nothing"
    return found


for file in sys.argv[1:]:
    defined = subprocess.run(["nm", "--defined-only", file], capture_output=True, text=True, check=True).stdout
    assert "silt" in defined, f"{file}: nm shows nothing of Silt"
    if of_mpi := re.findall(r" [A-Za-z] (P?MPI_\w+)$", defined, re.MULTILINE):
        sys.exit(f"{file} defines {', '.join(sorted(set(of_mpi)))}")
if wide := wide_functions(sys.argv[1]):
    sys.exit(f"{sys.argv[1]}: instructions of wide vectors are in functions for every processor:\n" + "\n".join(sorted(wide)))
