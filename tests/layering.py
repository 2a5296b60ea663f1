#!/usr/bin/python3
"""The dependency rule, read from the includes: cpu -> (std); parallel -> (MPI, std); device -> (cpu, std,
CUDA in its .cu files); lbm -> (cpu, parallel, device, std); rigid -> (cpu, Eigen, std, the counts of
parallel/traffic.hpp); adapters -> rigid or lbm types, never the coupler; coupler -> all of these
but adapters, and nothing of a case; silt, the application -> everything; engine headers only inside their adapter's folder. And no function of the C library whose last bit depends
on the machine; no message between ranks but by parallel/; and no two types of one name in headers of one
namespace, which files that see one of them each would take for the same."""
import pathlib
import re
import sys

ENGINES = r"(bt[A-Z]|BulletCollision|LinearMath|fcl/|ccd/|hdf5|H5|toml|libqhull|pybind11)"
FORBIDDEN = {  # folder: pattern of includes it must not have
    "cpu": rf"(parallel/|lbm/|rigid/|coupler/|silt/|adapters/|Eigen|mpi\.h|fmt/|iostream|cstdio|{ENGINES})",
    "parallel": rf"(cpu/|lbm/|rigid/|coupler/|silt/|adapters/|Eigen|fmt/|iostream|cstdio|{ENGINES})",
    "device": rf"(parallel/|lbm/|rigid/|coupler/|silt/|adapters/|Eigen|mpi\.h|fmt/|iostream|cstdio|{ENGINES})",
    "lbm": rf"(rigid/|coupler/|silt/|adapters/|Eigen|fmt/|iostream|cstdio|{ENGINES})",
    "rigid": rf"(parallel/(?!traffic\.hpp)|lbm/|coupler/|silt/|adapters/|mpi\.h|fmt/|iostream|cstdio|{ENGINES})",
    "adapters": r"(coupler|silt)/",
    "coupler": rf"(silt/|adapters/|{ENGINES})",
    "silt": ENGINES,
    "tests": r"(bt[A-Z]|BulletCollision|LinearMath|fcl/|ccd/)",
}
EXCEPT = {"tests/bench/bullet_world.cpp",  # what Silt is measured against
          "silt/python/silt_module.cpp", "silt/python/live_simulation.hpp", "silt/python/live_simulation.cpp"}


def violations(root):
    for folder, pattern in FORBIDDEN.items():
        for file in sorted((root / folder).rglob("*.[hc]pp")):
            if str(file.relative_to(root)) in EXCEPT:
                continue
            for number, line in enumerate(file.read_text().splitlines(), 1):
                include = re.match(r'\s*#\s*include\s*[<"]([^>"]+)', line)
                if include and re.match(pattern, include[1]):
                    yield f"{file.relative_to(root)}:{number}: {folder}/ must not include {include[1]}"


# These functions of the C library round otherwise on other machines: rigid/math/elementary.hpp has it for all
# that a state depends on.
UNEQUAL = r"std::(sin|cos|tan|a?sinh?|a?cosh?|a?tanh?|atan2|exp2?|expm1|log(2|10|1p)?|pow|cbrt|hypot|fma)\("
ONLY_SAID = {f"silt/{name}.cpp" for name in ("case/derived_table", "case/driving", "case/case_check", "run/foreseen_pressure")}


def calls_of_unequal(root):
    for folder in ("parallel", "lbm", "rigid", "adapters", "coupler", "silt"):
        for file in sorted((root / folder).rglob("*.[hc]pp")):
            name = str(file.relative_to(root))
            for number, line in enumerate(file.read_text().splitlines(), 1):
                if name not in ONLY_SAID and (call := re.search(UNEQUAL, line)):
                    yield f"{name}:{number}: {call[0]}...) rounds otherwise on other machines: rigid/math/elementary.hpp has it"


# These calls say something to another rank, or wait for one. parallel/ counts it (parallel/traffic.hpp).
MESSAGES = r"P?MPI_(I?[bsr]?send|I?m?recv|I?m?probe|Sendrecv|Wait|Test|Start|Barrier|Ibarrier|Bcast|Ibcast|Put|Get\(|Accumulate|" \
    r"I?(all)?(reduce|gather|scatter|toall)|I?(ex)?scan|Neighbor|Ineighbor)"


def messages_elsewhere(root):
    for folder in ("lbm", "rigid", "adapters", "coupler", "silt"):
        for file in sorted((root / folder).rglob("*.[hc]pp")):
            for number, line in enumerate(file.read_text().splitlines(), 1):
                if call := re.search(MESSAGES, line.split("//")[0], re.IGNORECASE):
                    yield f"{file.relative_to(root)}:{number}: {call[0]}... is a message that nobody counts: use parallel/"


TYPE = re.compile(r"(?:struct|class|enum class|enum|union) (?:alignas\([^)]*\) )?(\w+)(?: final)?(?: :[^:].*)? ?\{")


def types_of_one_name(root):
    """Types at the level of a namespace, which are not indented. A build has either cpu/lanes.hpp or, in its
    place, cpu/scalar.hpp."""
    places = {}
    for folder in FORBIDDEN:
        for file in sorted(set((root / folder).rglob("*.hpp")) - {root / "cpu/scalar.hpp"}):
            namespace = ""
            for number, line in enumerate(file.read_text().splitlines(), 1):
                if entered := re.match(r"namespace ([\w:]+) \{", line):
                    namespace = entered[1]
                elif found := TYPE.match(line):
                    places.setdefault((namespace, found[1]), []).append(f"{file.relative_to(root)}:{number}")
    for (namespace, name), several in places.items():
        if len(several) > 1:
            yield f"{', '.join(several)}: two types {namespace}::{name}: give one of them another name"


def files_seen(root):
    return sum(1 for folder in FORBIDDEN for _ in (root / folder).rglob("*.[hc]pp"))


root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
found = [*violations(root), *messages_elsewhere(root), *calls_of_unequal(root), *types_of_one_name(root)]
print("\n".join(found))
if not files_seen(root):
    sys.exit("layering: no sources found under " + str(root))
sys.exit(1 if found else 0)
