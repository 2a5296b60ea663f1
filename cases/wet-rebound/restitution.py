#!/usr/bin/python3
"""Rebound against the Stokes number: restitution.py PICTURE [SILT]

Runs the balls of scripts/accuracy/wet_rebound.py (seconds each) with the program SILT (build/release/bin/silt), and draws their
gaps over time, and the wet over the dry coefficient of restitution beside the law through the measurements.
"""
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "scripts" / "accuracy")]
import wet_rebound  # noqa: E402
from harness.execute import write_case  # noqa: E402
from problem import Outcome  # noqa: E402

BEFORE, AFTER = 12, 12  # ms shown before and after the impact


def outcome_of(run, silt, folder):
    write_case(run, folder)
    subprocess.run([silt, "run", folder, "--out", folder / "out"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return Outcome(folder / "out")


def draw_gaps(axes, label, run, outcome):
    diameter = wet_rebound.BALLS[run.settings["ball"]][1]
    gap, time = outcome.bodies.array("position")[:, 0, 2] / diameter - 0.5, 1e3 * outcome.bodies.time
    time = time - time[np.argmin(gap)]
    shown = (time > -BEFORE) & (time < AFTER)
    axes.plot(time[shown], gap[shown], label=label)


def draw_law(axes):
    stokes = np.geomspace(20, 1000, 200)
    law = np.exp(-35 / stokes)
    axes.fill_between(stokes, law - wet_rebound.SCATTER / 100, law + wet_rebound.SCATTER / 100, color="0.9", label="scatter of measurements")
    axes.plot(stokes, law, "k", lw=1, label="exp(−35 / St*), Legendre et al.")
    axes.set_xscale("log")
    axes.set_xlabel("St*")
    axes.set_ylabel("restitution, wet over dry")
    axes.set_ylim(0, 1.05)


def main(picture, silt=ROOT / "build" / "release" / "bin" / "silt"):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6))
    draw_law(right)
    with tempfile.TemporaryDirectory() as scratch:
        for run in wet_rebound.runs("full"):
            outcome = outcome_of(run, silt, pathlib.Path(scratch) / run.key)
            found = wet_rebound.measure(run, outcome)
            draw_gaps(left, f"St* = {found['stokes']:.0f}", run, outcome)
            right.plot(found["stokes"], found["restitution"], "o", color="C1")
    left.set_xlabel("time since the impact, ms")
    left.set_ylabel("gap, diameters")
    left.set_ylim(0)
    for axes in (left, right):
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    figure.savefig(picture, dpi=130, bbox_inches="tight")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(*sys.argv[1:])
