#!/usr/bin/python3
"""drifts SILT [--steps N]: mass and momentum over many steps in single precision (a million; 20 000 in short
form).

What rounding may do to the mass of the fluid: each step rounds a few numbers a cell to 2^-24 of their size,
the deviation from rest. Rounding is to nearest, so where the flow changes errors add as a random walk, whose
standard deviation is 2^-24 times the largest deviation times sqrt(steps cells); allowed is six times that
over the mass. In steady flow the same numbers are rounded alike in every step, and the errors add up: there
the mass may change by 1e-12 of it a step, 1e-6 in a million.
"""
import argparse
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from silt_runs import run_text  # noqa: E402, I001
from case_text import case_text, cube, sphere  # noqa: E402

ROUNDING, A_STEP = 2.0**-24, 1e-12
BALL = dict(shapes=[sphere(6)], bodies=[dict(name="ball", shape="sphere", density=1.5, position=[8.2, 8.1, 8], velocity=[0.02, 0.01, 0])])


def scenes():
    """Yields name, cells, case."""
    yield "vortices, noise", 16**3, dict(domain=cube(16), fluid=dict(relaxation_time=0.52, initial=dict(
        type="taylor-green-3d", velocity=[0.05, 0, 0], noise=0.01)))
    yield "channel", 16**3, dict(domain=dict(size=[16, 16, 16], boundary=dict(x="periodic", y="periodic", z="no-slip")),
                                 fluid=dict(relaxation_time=0.7, body_force=[1e-5, 0, 0]))
    yield "lid-driven box", 16**3, dict(domain=dict(size=[16, 16, 16], boundary=dict(
        x=[dict(type="moving", velocity=[0, 0.05, 0]), "no-slip"], y="no-slip", z="no-slip")), fluid=dict(relaxation_time=0.55))
    yield "sphere in a sheared box", 16**3, dict(domain=dict(size=[16, 16, 16], boundary=dict(
        x="periodic", y="periodic", z=["no-slip", dict(type="moving", velocity=[0.04, 0, 0])])),
        fluid=dict(relaxation_time=0.6), **dict(BALL, bodies=[dict(BALL["bodies"][0], density=1)]))
    yield "fixed sphere", 16**3, dict(domain=cube(16), fluid=dict(relaxation_time=0.6, body_force=[1e-6, 0, 0]),
                                      shapes=BALL["shapes"], bodies=[dict(shape="sphere", density=1, motion="fixed", position=[8.2, 8.1, 8])])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("silt")
    parser.add_argument("--steps", type=int, default=1_000_000)
    options = parser.parse_args()
    failed = False
    print(f"{'scene':24} {'mass drift':>12} {'allowed':>12} {'momentum drift':>15} {'largest velocity':>17}")
    for name, cells, tables in scenes():
        tables["fluid"]["precision"] = "single"
        text = case_text(name, run=dict(steps=options.steps), output=dict(report=dict(every=max(1000, options.steps // 50))), **tables)
        report = run_text(options.silt, text)[1]
        deviation = max(report["max_velocity_lattice"], 1e-3)
        allowed = max(6 * ROUNDING * deviation * math.sqrt(options.steps * cells) / cells, A_STEP * options.steps)
        drift = abs(report["mass_drift"] + report["mass_taken"])
        failed |= not drift <= allowed
        momentum = report["momentum_drift"]
        print(f"{name:24} {drift:12.2g} {allowed:12.2g} {'-' if momentum is None else f'{momentum:.2g}':>15}"
              f" {report['max_velocity_lattice']:17.4g}{'' if drift <= allowed else '   TOO FAR'}", flush=True)
    sys.exit(failed)


if __name__ == "__main__":
    main()
