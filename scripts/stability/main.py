#!/usr/bin/python3
"""Runs small scenes from slow to fast and from thick to thin, and says of each collision model where they last.

A point is "stable" if the run ends by itself and no fluid was three times as fast as the velocity given, "stopped" if a guard ended it,
"wrong" otherwise. What was run is kept in OUT/results.jsonl by case text and program: nothing is run twice. OUT gets map.csv and
map.png; those of this folder are what the page shows and `silt check` is tested against.
"""
import argparse
import csv
import json
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER))

from kept_runs import KeptRuns, add_options  # noqa: E402
from scenes import EXCESSES, FASTEST, MODELS, SCENES, VELOCITIES, cell_reynolds  # noqa: E402

DOUBTFUL = 0.1  # cells a step: no model is safe around bodies above
QUICK = {"scenes": ("layer", "cavity"), "excesses": (1e-3, 0.03), "velocities": (0.1,)}


def points(quick):
    for model in MODELS:
        for scene in QUICK["scenes"] if quick else SCENES:
            for excess in QUICK["excesses"] if quick else EXCESSES:
                for u in QUICK["velocities"] if quick else VELOCITIES:
                    yield model, scene, excess, u


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
    figure, axes = plt.subplots(len(MODELS), len(SCENES), figsize=(13, 7.5), sharex=True, sharey=True)
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
                  loc="lower center", ncols=4)
    figure.tight_layout(rect=(0, 0.05, 1, 1))
    figure.savefig(path, dpi=110)


def largest_safe(found, model, scenes):
    """Returns the largest cell Reynolds number such that no point with one as large or smaller fails, in any of the scenes."""
    failing = [cell_reynolds(e, u) for (m, s, e, u), w in found.items() if m == model and s in scenes and w != "stable"]
    held = [cell_reynolds(e, u) for (m, s, e, u), w in found.items() if m == model and s in scenes and w == "stable"]
    return max((r for r in held if r < min(failing, default=float("inf"))), default=0)


def main():
    if sys.argv[1:2] == ["contacts"]:
        import contacts
        return contacts.main(sys.argv[2:])
    parser = argparse.ArgumentParser(prog="scripts/bench stability [contacts]", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    add_options(parser)
    options = parser.parse_args()

    def judge(report, _, point):
        return "stable" if report["max_velocity_lattice"] <= FASTEST * point[3] else "wrong"

    found = KeptRuns(options, judge).verdicts(
        list(points(options.quick)), lambda p: SCENES[p[1]](p[0], p[2], p[3]),
        lambda p: f"{p[0]}, {p[1]}, tau - 1/2 = {p[2]:g}, {p[3]:g} cells a step")
    write_csv(options.out / "map.csv", found)
    if not options.quick:
        draw(options.out / "map.png", found)
    scenes = {scene for _, scene, _, _ in found}
    figures = {f"stability.{model}.{scene}": largest_safe(found, model, {scene}) for model in MODELS for scene in SCENES if scene in scenes}
    slow = {point: word for point, word in found.items() if point[3] <= DOUBTFUL}
    figures |= {f"stability.{model}.slow": largest_safe(slow, model, scenes) for model in MODELS}
    for name, value in figures.items():
        print(f"{name:32} stable up to u / nu = {value:.4g}")
    if options.json:
        options.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n")


if __name__ == "__main__":
    main()
