#!/usr/bin/python3
"""output.py SILT [--json FILE] [--quick] [--ranks N] [--folder DIR]: what writing results costs.

Started by scripts/bench output. 128 x 128 x 128 cells with 250 spheres of 10 cells, single precision: fields
every 100 steps, bodies every 10. Figures, medians of runs in turn: the time that a run with outputs spends
outside its steps, less that of one without, over its steps; and the bytes a second of that time over those of
one plain sequential write of as much into the same folder.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import tempfile
import time

SCENE = """[units]
system = "lattice"
[domain]
size = [{edge}, {edge}, {edge}]
boundary = "periodic"
[fluid]
relaxation_time = 0.7
[gravity]
acceleration = [0, 0, -1e-5]
[[shapes]]
name = "ball"
type = "sphere"
diameter = 10
[[fill]]
shape = "ball"
density = 1.5
count = {count}
[run]
steps = {steps}
"""
OUTPUT = "[output]\nfields = { every = 100 }\nbodies = { every = 10 }\n"
ENVIRONMENT = dict(os.environ, SILT_PLAIN="1")


def run(silt, text, ranks, parent):
    """Returns (seconds in steps, seconds beside them, bytes of results) of a run."""
    with tempfile.TemporaryDirectory(dir=parent) as folder:
        case = pathlib.Path(folder)
        (case / "case.toml").write_text(text)
        launch = ["mpirun", "-n", str(ranks), "--quiet", "--allow-run-as-root"] if ranks > 1 else []
        subprocess.run([*launch, silt, "run", case], check=True, stdout=subprocess.DEVNULL, stdin=subprocess.DEVNULL, env=ENVIRONMENT)
        report = json.loads((case / "out/report.json").read_text())
        files = sum(path.stat().st_size for path in (case / "out").iterdir())
        return report["step_seconds"], report["wall_seconds"] - report["step_seconds"], files


def plain_write(size, parent):
    """Returns the seconds that a file of so many bytes takes, 8 MB at a time."""
    piece = os.urandom(1 << 23)
    with tempfile.NamedTemporaryFile(dir=parent, buffering=0) as file:
        start = time.perf_counter()
        for _ in range(size // len(piece)):
            file.write(piece)
        file.write(piece[:size % len(piece)])
        return time.perf_counter() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("silt")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE", help="where to leave the figures")
    parser.add_argument("--quick", action="store_true", help="64 cells an edge, one turn")
    parser.add_argument("--ranks", type=int, default=1, metavar="N")
    parser.add_argument("--folder", type=pathlib.Path, metavar="DIR", help="where to write (that of temporary files)")
    options = parser.parse_args()
    text = SCENE.format(edge=64 if options.quick else 128, count=30 if options.quick else 250, steps=400)
    shares, speeds = [], []
    for _ in range(1 if options.quick else 3):
        _, idle, _ = run(options.silt, text, options.ranks, options.folder)
        steps, beside, size = run(options.silt, text + OUTPUT, options.ranks, options.folder)
        plain = plain_write(size, options.folder)
        shares.append((beside - idle) / steps)
        speeds.append(plain / (beside - idle))
        print(f"steps {steps:.3g} s, beside them {beside:.3g} s (without outputs {idle:.3g} s), {size / 1e6:.4g} MB, plainly written in {plain:.3g} s: "
              f"{100 * shares[-1]:.2g} % of the time, {speeds[-1]:.2f} of the speed of a plain write", flush=True)
    figures = {"output.share": statistics.median(shares), "output.over_plain_write": statistics.median(speeds)}
    print(", ".join(f"{key} {value:.3g}" for key, value in figures.items()))
    if options.json:
        options.json.write_text(json.dumps({"commit": os.environ.get("SILT_COMMIT", "unknown"), "figures": figures}, indent=1) + "\n")


if __name__ == "__main__":
    main()
