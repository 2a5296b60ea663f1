#!/usr/bin/python3
"""compiles_for_arm.py ROOT EIGEN: what knows of instruction sets compiles for 64-bit ARM. Exit code 77,
"Skipped", without Debian's g++-aarch64-linux-gnu. scripts/cross-arm builds and runs everything there."""
import concurrent.futures
import pathlib
import shutil
import subprocess
import sys

COMPILER = "aarch64-linux-gnu-g++"
root, eigen = pathlib.Path(sys.argv[1]), sys.argv[2]
if not shutil.which(COMPILER):
    print(f"there is no {COMPILER}")
    sys.exit(77)
files = [root / "cpu/isa.cpp", *sorted((root / "rigid/math").glob("*.cpp"))]
for folder in ("lbm", "rigid", "coupler", "silt", "tests"):
    files += sorted((root / folder).rglob("*_kernel.cpp"))


def complaint(file):
    done = subprocess.run([COMPILER, "-std=gnu++20", "-fsyntax-only", "-Wall", "-Wextra", "-DSILT_BUILD=portable", f"-I{root}",
                           f"-isystem{eigen}", file], capture_output=True, text=True)
    return done.stderr


with concurrent.futures.ThreadPoolExecutor(2) as pool:
    found = list(filter(None, pool.map(complaint, files)))
print("\n".join(found))
sys.exit(bool(found) or not files)
