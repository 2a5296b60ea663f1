#!/usr/bin/python3
"""Runs small scenes from slow to fast and from thick to thin, and says of each collision model where they last.

A point is "stable" if the run ends by itself and no fluid was three times as fast as the velocity given, "stopped" if a guard ended it,
"wrong" otherwise. What was run is kept in OUT/results.jsonl by case text and program: nothing is run twice. OUT gets map.csv and
map.png; those of this folder are what the page shows and `silt check` is tested against.
"""
import argparse
import concurrent.futures
import csv
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile

FOLDER = pathlib.Path(__file__).resolve().parent
ROOT = FOLDER.parent.parent
sys.path[:0] = [str(FOLDER), str(FOLDER.parent / "accuracy"), str(FOLDER.parent)]

from harness.results import Results, digest  # noqa: E402
from scenes import EXCESSES, FASTEST, MODELS, SCENES, VELOCITIES, cell_reynolds  # noqa: E402

GUARD = 3  # exit code of silt where a guard ends a run
QUICK = {"scenes": ("layer", "cavity"), "excesses": (1e-3, 0.03), "velocities": (0.1,)}


def points(quick):
    for model in MODELS:
        for scene in QUICK["scenes"] if quick else SCENES:
            for excess in QUICK["excesses"] if quick else EXCESSES:
                for u in QUICK["velocities"] if quick else VELOCITIES:
                    yield model, scene, excess, u


def verdict(silt, text, u):
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        (folder / "case.toml").write_text(text)
        done = subprocess.run([silt, "run", folder, "--out", folder / "out"], stdin=subprocess.DEVNULL, capture_output=True, text=True)
        if done.returncode == GUARD:
            return "stopped"
        if done.returncode != 0:
            raise RuntimeError(f"silt ended with code {done.returncode}:\n{done.stderr}\n{text}")
        report = json.loads((folder / "out" / "report.json").read_text())
        return "stable" if report["max_velocity_lattice"] <= FASTEST * u else "wrong"


def measure(results, silt, program, point):
    model, scene, excess, u = point
    text = SCENES[scene](model, excess, u)
    key = digest(text, program)
    if not (kept := results.get(key)):
        kept = {"fingerprint": key, "verdict": verdict(silt, text, u)}
        results.add(kept)
    return kept["verdict"]


def write_csv(path, found):
    with open(path, "w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["model", "scene", "tau_less_half", "velocity", "cell_reynolds", "verdict"])
        for (model, scene, excess, u), word in found.items():
            writer.writerow([model, scene, f"{excess:g}", f"{u:g}", f"{cell_reynolds(excess, u):.4g}", word])


def draw(path, found):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(len(MODELS), len(SCENES), figsize=(13, 7.5), sharex=True, sharey=True, layout="constrained")
    styles = {"stable": ("o", "#2c7fb8"), "wrong": ("s", "#f0a30a"), "stopped": ("x", "#c23b22")}
    for row, model in zip(axes, MODELS):
        for axis, scene in zip(row, SCENES):
            for word, (mark, colour) in styles.items():
                at = [p[2:] for p, w in found.items() if p[:2] == (model, scene) and w == word]
                axis.scatter([a for a, _ in at], [u for _, u in at], marker=mark, color=colour, label=word)
            excess = [min(EXCESSES), max(EXCESSES)]
            for number in (1, 20, 100, 1000):
                axis.plot(excess, [number * e / 3 for e in excess], color="0.75", lw=0.8, zorder=0)
            axis.set(xscale="log", yscale="log", xlim=(5e-5, 4), ylim=(0.006, 0.35), title=f"{model}: {scene}")
    for axis in axes[-1]:
        axis.set_xlabel("$\\tau - 1/2$")
    for row in axes:
        row[0].set_ylabel("velocity, cells a step")
    handles = [plt.Line2D([], [], marker=m, color=c, ls="", label=w) for w, (m, c) in styles.items()]
    figure.legend(handles=[*handles, plt.Line2D([], [], color="0.75", label="$u/\\nu$ = 1, 20, 100, 1000, from right to left")],
                  loc="outside lower center", ncols=4)
    figure.savefig(path, dpi=110)


def largest_safe(found, model, scenes):
    """Returns the largest cell Reynolds number such that no point with one as large or smaller fails, in any of the scenes."""
    failing = [cell_reynolds(e, u) for (m, s, e, u), w in found.items() if m == model and s in scenes and w != "stable"]
    held = [cell_reynolds(e, u) for (m, s, e, u), w in found.items() if m == model and s in scenes and w == "stable"]
    return max((r for r in held if r < min(failing, default=float("inf"))), default=0)


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench stability", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="twelve points")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE", help="also write the figures there")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "stability-out", metavar="DIR")
    parser.add_argument("-j", "--jobs", type=int, default=1, metavar="N")
    parser.add_argument("--silt", type=pathlib.Path, metavar="PROGRAM", help="use this one; build nothing")
    options = parser.parse_args()
    silt = options.silt.resolve() if options.silt else ROOT / "build/release/coupler/silt"
    if not options.silt:
        subprocess.run([ROOT / "scripts/build", "release", "silt"], check=True)
    options.out.mkdir(parents=True, exist_ok=True)
    program = hashlib.sha256(silt.read_bytes()).hexdigest()
    results = Results(options.out / "results.jsonl")
    wanted = list(points(options.quick))
    found = {}
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for i, (point, word) in enumerate(zip(wanted, pool.map(lambda p: measure(results, silt, program, p), wanted)), 1):
            found[point] = word
            if word != "stable" or i % 20 == 0:
                print(f"{i} of {len(wanted)}: {point[0]}, {point[1]}, tau - 1/2 = {point[2]:g}, {point[3]:g} cells a step: {word}", flush=True)
    write_csv(options.out / "map.csv", found)
    if not options.quick:
        draw(options.out / "map.png", found)
    scenes = {scene for _, scene, _, _ in found}
    figures = {f"stability.{model}.{scene}": largest_safe(found, model, {scene}) for model in MODELS for scene in SCENES if scene in scenes}
    for name, value in figures.items():
        print(f"{name:32} stable up to u / nu = {value:.4g}")
    if options.json:
        options.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n")


if __name__ == "__main__":
    main()
