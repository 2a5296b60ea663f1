#!/usr/bin/python3
"""The dependency rule, read from the includes: cpu -> (std); lbm -> (cpu, MPI, std); rigid -> (cpu, Eigen, std); adapters -> rigid or lbm
types, never the coupler; engine headers only inside their adapter's folder; a coupler includes factory headers."""
import pathlib
import re
import sys

ENGINES = r"(bt[A-Z]|BulletCollision|LinearMath|fcl/|ccd/|hdf5|H5|toml|libqhull|pybind11)"
FORBIDDEN = {  # folder: pattern of includes it must not have
    "cpu": rf"(lbm/|rigid/|coupler/|adapters/|Eigen|mpi\.h|fmt/|iostream|cstdio|{ENGINES})",
    "lbm": rf"(rigid/|coupler/|adapters/|Eigen|fmt/|iostream|cstdio|{ENGINES})",
    "rigid": rf"(lbm/|coupler/|adapters/|mpi\.h|fmt/|iostream|cstdio|{ENGINES})",
    "adapters": r"coupler/",
    "coupler": ENGINES,
    "tests": r"(bt[A-Z]|BulletCollision|LinearMath|fcl/|ccd/)",
}
EXCEPT = {"tests/bench/bullet_world.cpp",  # what Silt is measured against
          "coupler/python/silt_module.cpp"}


def violations(root):
    for folder, pattern in FORBIDDEN.items():
        for file in sorted((root / folder).rglob("*.[hc]pp")):
            if str(file.relative_to(root)) in EXCEPT:
                continue
            for number, line in enumerate(file.read_text().splitlines(), 1):
                include = re.match(r'\s*#\s*include\s*[<"]([^>"]+)', line)
                if include and re.match(pattern, include[1]):
                    yield f"{file.relative_to(root)}:{number}: {folder}/ must not include {include[1]}"


def files_seen(root):
    return sum(1 for folder in FORBIDDEN for _ in (root / folder).rglob("*.[hc]pp"))


root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
found = list(violations(root))
print("\n".join(found))
if not files_seen(root):
    sys.exit("layering: no sources found under " + str(root))
sys.exit(1 if found else 0)
