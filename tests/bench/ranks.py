#!/usr/bin/python3
"""ranks.py SILT [--json FILE] [--quick]: whole runs of cases on two ranks over one, in turn.

Started by scripts/bench ranks. Each scene runs on one rank and on two, `turns` times, one after the other; the figure
is the median of the ratios of their times (of two ranks over one, smaller is better; without the start of the program
and its files). The last scene runs on two ranks with and without another process that takes half of a core's time in
slices of 20 ms: the ratio of its speed disturbed over undisturbed, where 0.75 is all that is left of two cores.
"""
import argparse
import contextlib
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FEW = ["fill[0].count=63", "fill[0].box=[[0, 0, 1], [64, 64, 61]]"]
DOUBLE, SINGLE = ['fluid.precision="double"'], ['fluid.precision="single"']
# key: case, steps, settings
SCENES = {
    "segregation": ("segregation", 3000, []),
    "bed225.single": ("fluidised-bed", 300, SINGLE),
    "bed225.double": ("fluidised-bed", 200, DOUBLE),
    "bed63.single": ("fluidised-bed", 500, SINGLE + FEW),
    "bed63.double": ("fluidised-bed", 400, DOUBLE + FEW),
    "packing": ("packing", 3000, []),
    "hopper": ("hopper", 1200, []),
}
DISTURBED = "bed225.double"
SPIN = "import time\nwhile True:\n  t = time.perf_counter()\n  while time.perf_counter() - t < 0.02: pass\n  time.sleep(0.02)\n"


def seconds(silt, scene, ranks, quick):
    """Returns what a run of a scene took, by its own report: of its steps alone."""
    case, steps, settings = SCENES[scene]
    with tempfile.TemporaryDirectory() as folder:
        command = [silt, "run", ROOT / "cases" / case, "--out", f"{folder}/out", "--steps", str(steps // (10 if quick else 1))]
        for setting in settings:
            command += ["--set", setting]
        environment = dict(os.environ, SILT_PLAIN="1")
        if ranks > 1:
            command = ["mpirun", "-n", str(ranks), "--quiet", "--allow-run-as-root", *command]
        subprocess.run(command, check=True, env=environment, stdout=subprocess.DEVNULL)
        return json.loads(Path(folder, "out", "report.json").read_text())["wall_seconds"]


@contextlib.contextmanager
def half_a_core_taken():
    process = subprocess.Popen([sys.executable, "-c", SPIN])
    try:
        yield
    finally:
        process.kill()
        process.wait()


def ratio(name, first, second, turns):
    """Returns the median of second over first, each measured `turns` times in turn; prints all."""
    found = []
    for _ in range(turns):
        a, b = first(), second()
        found.append(b / a)
    median = statistics.median(found)
    print(f"{name:30} {median:6.3f}   ({', '.join(f'{x:.3f}' for x in found)})", flush=True)
    return median


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("silt")
    parser.add_argument("--json", metavar="FILE", help="where to leave the figures")
    parser.add_argument("--quick", action="store_true", help="a tenth of the steps, one turn")
    parser.add_argument("--only", nargs="+", choices=[*SCENES, "disturbed"], default=[*SCENES, "disturbed"])
    arguments = parser.parse_args()
    turns = 1 if arguments.quick else 3
    figures = {}

    def run(scene, ranks):
        return lambda: seconds(arguments.silt, scene, ranks, arguments.quick)

    def disturbed():
        with half_a_core_taken():
            return run(DISTURBED, 2)()

    print("time of two ranks over one     median (each turn)", flush=True)
    for scene in arguments.only:
        if scene != "disturbed":
            figures[f"ranks.{scene}"] = ratio(scene, run(scene, 1), run(scene, 2), turns)
    if "disturbed" in arguments.only:
        print("speed with half of a core taken, over without", flush=True)
        figures["ranks.disturbed"] = ratio(DISTURBED, disturbed, run(DISTURBED, 2), turns)
    if arguments.json:
        Path(arguments.json).write_text(json.dumps({"commit": os.environ.get("SILT_COMMIT", "unknown"), "figures": figures}, indent=1) + "\n")


if __name__ == "__main__":
    main()
