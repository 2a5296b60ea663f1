#!/usr/bin/python3
"""bed_at_rest SILT [--steps N]: a dense bed of spheres under a fluid at rest stays at rest (100 000 steps;
1000 in short form).

Spheres of 8 cells are poured into a periodic box without a fluid until they rest. The same bed then stands in
a fluid at rest, with the weight that buoyancy leaves. Nothing drives it. At the end no overlap may be deeper
than a hundredth of the radius, the fluid nowhere faster than 1e-5 cells a step, no body further than a
hundredth of the radius from where it stood, and the mean density as at the start to 1e-6.
"""
import argparse
import math
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from silt_runs import run_text  # noqa: E402, I001
import silt_results  # noqa: E402
from case_text import case_text, sphere  # noqa: E402

DIAMETER, WIDTH, COUNT, DENSITY = 8, 32, 80, 2.5
GRAVITY = 1e-4
POURED, LEVEL = 96, 56  # heights of the box to pour into and of the one with a fluid
TABLES = dict(gravity=dict(acceleration=[0, 0, -GRAVITY]), contacts=dict(restitution=0.2, friction=0.3), shapes=[sphere(DIAMETER)])


def domain(height):
    return dict(size=[WIDTH, WIDTH, height], boundary=dict(x="periodic", y="periodic", z="no-slip"))


def poured(silt):
    """Returns positions [bodies, 3] of spheres that lie on each other."""
    text = case_text("A bed is poured", domain=domain(POURED), run=dict(steps=20000), output=dict(bodies=dict(every=20000)),
                     fill=[dict(shape="sphere", density=DENSITY, count=COUNT, gap=0.2, seed=1)], **TABLES)
    return run_text(silt, text, read=lambda out: silt_results.open(out).bodies.array("position")[-1])[1]


def solid_fraction(positions):
    """Returns the solid fraction of the bed between one diameter above the floor and one below its top:
    volumes of slices of the spheres."""
    low, high, r = DIAMETER, positions[:, 2].max() - DIAMETER, DIAMETER / 2
    a, b = (np.clip(z - positions[:, 2], -r, r) for z in (low, high))
    return np.sum(math.pi * (r**2 * (b - a) - (b**3 - a**3) / 3)) / (WIDTH**2 * (high - low))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("silt")
    parser.add_argument("--steps", type=int, default=100_000)
    options = parser.parse_args()
    bed = poured(options.silt)
    bed[:, :2] %= WIDTH
    text = case_text("It stands in a fluid", domain=domain(LEVEL), fluid=dict(relaxation_time=0.8), run=dict(steps=options.steps),
                     bodies=[dict(shape="sphere", density=DENSITY, positions=bed.tolist())],
                     output=dict(bodies=dict(every=options.steps), fields=dict(every=options.steps, quantities=["velocity"])), **TABLES)

    def read(out):
        results = silt_results.open(out)
        return results.report, results.bodies.array("position"), results.fields[-1]["velocity"]
    report, positions, velocity = run_text(options.silt, text, read=read)[1]
    moved = np.abs(positions[-1] - positions[0])
    moved[:, :2] = np.minimum(moved[:, :2], WIDTH - moved[:, :2])
    radius = DIAMETER / 2
    found = [("deepest overlap, radii", report["max_penetration"] / radius, 0.01),
             ("displacement, radii", moved.max() / radius, 0.01),
             ("fastest fluid, cells a step", np.sqrt(np.nanmax(np.sum(velocity**2, axis=-1))), 1e-5),
             ("drift of the mean density", abs(report["mass_drift"]), 1e-6)]
    print(f"{COUNT} spheres, solid fraction {solid_fraction(bed):.3f}, {options.steps} steps")
    for name, value, limit in found:
        print(f"{name:30} {value:10.2g} (limit {limit:g}){'' if value <= limit else '   TOO MUCH'}")
    sys.exit(not all(value <= limit for _, value, limit in found))


if __name__ == "__main__":
    main()
