#!/usr/bin/python3
"""rotor.py SILT [--json FILE] [--quick] [--triangles N]: what a turning rotor of triangles costs.

Started by scripts/bench rotor. A paddle of four blades and 100 000 triangles, 80 cells across and 10 high,
turns in 128 x 128 x 128 cells with a tip speed of 0.05 cells a step; single precision, one core, walls and
coupling of the default. Figures, medians of runs in turn with the fluid alone: object mapping, and the whole
step, over the step of the fluid alone.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
FLUID = """[units]
system = "lattice"
[domain]
size = [{edge}, {edge}, {edge}]
boundary = "periodic"
[fluid]
relaxation_time = 0.7
[run]
steps = {steps}
"""
ROTOR = """[[walls]]
name = "rotor"
type = "mesh"
file = "rotor.stl"
solid = "inside"
position = [{middle}, {middle}, {middle}]
orientation = [0.1, 0.2, 1]
motion = {{ angular_velocity = {spin}, axis = [0.1, 0.2, 1] }}
"""
ENVIRONMENT = dict(os.environ, SILT_PLAIN="1")


def seconds_by_stage(silt, case):
    """Returns the seconds of a run in each stage."""
    subprocess.run([silt, "run", case], check=True, stdout=subprocess.DEVNULL, stdin=subprocess.DEVNULL, env=ENVIRONMENT)
    stages = json.loads((case / "out/report.json").read_text())["stage_seconds"]
    return {stage: spread["avg"] for stage, spread in stages.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("silt")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE", help="where to leave the figures")
    parser.add_argument("--quick", action="store_true", help="64 cells an edge, a quarter of the triangles, one turn")
    parser.add_argument("--triangles", type=int, metavar="N", help="100 000")
    options = parser.parse_args()
    edge, steps, turns = (64, 100, 1) if options.quick else (128, 300, 5)
    triangles = options.triangles or 100_000 * edge ** 2 // 128 ** 2
    mapping, whole = [], []
    with tempfile.TemporaryDirectory() as folder:
        alone, rotor = pathlib.Path(folder, "alone"), pathlib.Path(folder, "rotor")
        alone.mkdir(), rotor.mkdir()
        radius = 0.3125 * edge
        subprocess.run([sys.executable, ROOT / "scripts/make_mesh", "paddle", rotor / "rotor.stl", "--radius", str(radius),
                        "--height", str(radius / 4), "--thickness", str(radius / 10), "--blades", "4", "--triangles", str(triangles)], check=True)
        text = FLUID.format(edge=edge, steps=steps)
        (alone / "case.toml").write_text(text)
        (rotor / "case.toml").write_text(text + ROTOR.format(middle=edge / 2, spin=0.05 / radius))
        for _ in range(turns):
            fluid = sum(seconds_by_stage(options.silt, alone).values())
            stages = seconds_by_stage(options.silt, rotor)
            mapping.append(stages["object mapping"] / fluid)
            whole.append(sum(stages.values()) / fluid)
            print(f"fluid alone {1e3 * fluid / steps:.3g} ms a step; object mapping {mapping[-1]:.2f} of it, whole step {whole[-1]:.2f}: "
                  + ", ".join(f"{stage} {seconds / fluid:.2f}" for stage, seconds in stages.items() if seconds > 0.005 * fluid), flush=True)
    figures = {"rotor.mapping_over_fluid": statistics.median(mapping), "rotor.over_fluid": statistics.median(whole)}
    print(", ".join(f"{key} {value:.3g}" for key, value in figures.items()))
    if options.json:
        options.json.write_text(json.dumps({"commit": os.environ.get("SILT_COMMIT", "unknown"), "figures": figures}, indent=1) + "\n")


if __name__ == "__main__":
    main()
