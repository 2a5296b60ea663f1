#!/usr/bin/python3
"""random_walls SILT [--short]: no wall scheme amplifies what is in the fluid.

Closed boxes with no-slip sides are filled with fixed spheres and boxes at random, down to gaps of a hundredth
of a cell, so that links are cut at every distance and in every neighbourhood. The fluid starts with noise.
Nothing drives it, so it must decay. Sound comes and goes in what reports see of the kinetic energy, and
momentum whose sign changes from cell to cell and step to step is damped by no collision (docs/method.md,
equation 17): the largest energy of the last fifth must be below that of the second, and below that of the
noise. The noise is small (1e-6 cells a step) where only the linear part is asked for, and large (0.05). Every
wall scheme, three collision models, relaxation times from 0.502 to 3; not what is known not to last.
"""
import argparse
import csv
import itertools
import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from silt_runs import run_text  # noqa: E402, I001
from case_text import case_text  # noqa: E402

EDGE = 16
SCHEMES = ("bounce-back", "cli", "parabolic", "multireflection")
MODELS = ("trt", "regularised", "bgk")
RELAXATION_TIMES = (0.502, 0.51, 0.55, 0.7, 1, 3)
BODIES = 14
ROUNDING = 1e-18  # of the energy at the start


def is_known_not_to_last(scheme, model, relaxation_time, noise):
    """Says what docs/method.md and scripts/stability/README.md do: of walls, and of the collision itself at a
    large cell Reynolds number."""
    return (scheme != "bounce-back" and model == "regularised" and relaxation_time < 0.505
            or scheme == "multireflection" and model == "bgk" and relaxation_time >= 2.5
            or model != "regularised" and noise / ((relaxation_time - 0.5) / 3) > 10)


def obstacles(seed):
    """Returns the tables of fixed bodies at random, of which no two circumspheres come nearer than 0.01
    cells, and of their shapes."""
    chance = random.Random(seed)
    placed = []
    while len(placed) < BODIES:
        radius = chance.uniform(1, 3.2)
        at = [chance.uniform(radius + 0.01, EDGE - radius - 0.01) for _ in range(3)]
        if all(sum((a - b) ** 2 for a, b in zip(at, other)) > (radius + r + 0.01) ** 2 for other, r in placed):
            placed.append((at, radius))
    shapes, bodies = [], []
    for i, (at, radius) in enumerate(placed):
        edges = [radius * f for f in (1.3, 1.1, 1.0)]  # half their diagonal: 0.986 of the radius
        shapes.append(dict(name=f"s{i}", **(dict(type="sphere", radius=radius) if i % 2 else dict(type="box", edges=edges))))
        bodies.append(dict(shape=f"s{i}", density=1, motion="fixed", position=at, orientation=[chance.gauss(0, 1) for _ in range(3)]))
    return dict(shapes=shapes, bodies=bodies)


def box(scheme, model, relaxation_time, noise, seed, steps):
    return case_text("Noise among random walls", domain=dict(size=[EDGE] * 3, boundary="no-slip"),
                     fluid=dict(relaxation_time=relaxation_time, collision=model, precision="double", initial=dict(type="uniform", velocity=[0, 0, 0], noise=noise)),
                     coupling=dict(wall_scheme=scheme), run=dict(steps=steps), output=dict(report=dict(every=max(1, steps // 40))), **obstacles(seed))


def fault(silt, text, noise):
    """Returns what is wrong, "" if nothing."""
    def read(out):
        with open(out / "series.csv") as stream:
            return [float(row["energy.fluid"]) for row in csv.DictReader(stream)]
    done, energies = run_text(silt, text, read=read, code=None)
    if done.returncode:
        return f"code {done.returncode}: {done.stderr.strip().splitlines()[-1]}"
    start = noise**2 * EDGE**3 / 2  # of each component as large, less: an upper bound
    if max(energies) > start:
        return f"energy {max(energies):.3g}, above that of the noise, {start:.3g}"
    fifth = len(energies) // 5
    before, after = max(energies[fifth:2 * fifth]), max(energies[-fifth:])
    return "" if after <= max(1.001 * before, ROUNDING * start) else f"energy grew from {before / start:.3g} to {after / start:.3g} of the noise's"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("silt")
    parser.add_argument("--short", action="store_true", help="thirty boxes, 3000 steps")
    options = parser.parse_args()
    steps = 3000 if options.short else 20000
    points = (itertools.product(SCHEMES, MODELS[:2], (0.502, 0.505, 0.7), (1e-6,), (0,)) if options.short
              else itertools.product(SCHEMES, MODELS, RELAXATION_TIMES, (1e-6, 0.05), range(3)))
    faults = count = 0
    for scheme, model, tau, noise, seed in points:
        if is_known_not_to_last(scheme, model, tau, noise):
            continue
        count += 1
        if found := fault(options.silt, box(scheme, model, tau, noise, seed, steps), noise):
            faults += 1
            print(f"{scheme}, {model}, tau {tau}, noise {noise}, seed {seed}: {found}", flush=True)
    print(f"{count} boxes, {faults} with a fault")
    sys.exit(faults > 0)


if __name__ == "__main__":
    main()
