"""Drops heaps of bodies into a box, from bouncing to sticking, smooth to rough, alike to unlike, round to long, in small steps and large.

A point is "stable" if its energy, of motion and height, was never above that of the start by more than a thousandth, and no overlap was
ever above a tenth of the smallest body's least half-width; "stopped" if a guard ended it, "grew" or "overlap" otherwise. OUT gets contacts.csv.
"""
import argparse
import csv
import itertools
import json
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "accuracy"))

from case_text import case_text  # noqa: E402
from kept_runs import KeptRuns, add_options  # noqa: E402

WIDTH = 8                                    # of a large body, cells
SHAPES = ("ellipsoid", "capsule", "box")
ASPECTS = (1, 2, 4)                          # length over width, at equal volume; a capsule of 1 is a sphere
SIZES = (1, 3)                               # width of the large over that of the small
RESTITUTIONS = (0, 0.5, 0.9, 1)
FRICTIONS = (0, 0.3, 1)
STEPS = (0.01, 0.03, 0.1)                    # of sqrt(width / gravity)
ROW = 3                                      # large bodies along an edge of their lattice
LASTS = 40                                   # of sqrt(width / gravity)
NAMES = ("shape", "aspect", "size_ratio", "restitution", "friction", "step")
ALL = (SHAPES, ASPECTS, SIZES, RESTITUTIONS, FRICTIONS, STEPS)
QUICK = (("box",), (2,), (3,), (0.5,), (0.3,), (0.01, 0.1))


def shape(kind, width, aspect):
    """A body as large as a sphere (a box: a cube) of this width, `aspect` times as long as it is wide; and its least half-width."""
    narrow = width * aspect ** (-1 / 3)
    if kind == "ellipsoid":
        return dict(type=kind, diameters=[narrow, narrow, aspect * narrow]), narrow / 2
    if kind == "box":
        return dict(type=kind, edges=[narrow, narrow, aspect * narrow]), narrow / 2
    radius = width / 2 * (1 + 1.5 * (aspect - 1)) ** (-1 / 3)
    if aspect == 1:
        return dict(type="sphere", radius=radius), radius
    return dict(type=kind, radius=radius, length=2 * radius * (aspect - 1)), radius


def reach(kind, width, aspect):
    """Twice the circumscribed radius."""
    narrow = width * aspect ** (-1 / 3)
    if kind == "ellipsoid":
        return aspect * narrow
    if kind == "box":
        return narrow * math.sqrt(2 + aspect**2)
    return 2 * aspect * shape(kind, width, aspect)[1]


def places(kind, aspect, size):
    """Large bodies on a lattice on which no two touch, however they turn, small ones on such a lattice above; the extent of all."""
    large, small = (reach(kind, w, aspect) + 0.3 for w in (WIDTH, WIDTH / size))
    edge = math.ceil(large * ROW)

    def lattice(pitch, floor):
        apart = (edge - pitch) / (ROW - 1) - 0.1
        return [[pitch / 2 + i * apart + 0.01 * k, pitch / 2 + j * apart + 0.02 * i, floor + (k + 0.5) * pitch]
                for k in range(ROW) for j in range(ROW) for i in range(ROW)]
    smalls = [] if size == 1 else lattice(small, ROW * large)
    return lattice(large, 0), smalls, [edge, edge, math.ceil(ROW * (large + small))]


def heap(kind, aspect, size, restitution, friction, step):
    large, small, extent = places(kind, aspect, size)
    shapes = [dict(name="large", **shape(kind, WIDTH, aspect)[0]), dict(name="small", **shape(kind, WIDTH / size, aspect)[0])]
    turned = dict(density=1, orientation=[0.5, 0.3, 0.8], angular_velocity=[0, 0.1 * step, 0])
    bodies = [dict(name=f"{s['name']}s", shape=s["name"], positions=p, **turned) for s, p in zip(shapes, (large, small)) if p]
    gravity = WIDTH * step**2
    steps = math.ceil(LASTS / step)
    return case_text("A heap", domain=dict(size=extent, boundary="no-slip"), gravity=dict(acceleration=[0, 0, -gravity]),
                     contacts=dict(restitution=restitution, friction=friction), shapes=shapes[:len(bodies)],
                     bodies=bodies, run=dict(steps=steps), output=dict(report=dict(every=max(1, steps // 100))),
                     quantities=[dict(name=s["name"], type="mean-height", body=b["name"]) for s, b in zip(shapes, bodies)])


def volume(kind, width):
    return width**3 * (1 if kind == "box" else math.pi / 6)


def judge(_, folder, point):
    kind, aspect, size, _, _, step = point
    counts = {"large": ROW**3, "small": ROW**3 if size > 1 else 0}
    weights = {name: count * volume(kind, WIDTH / (size if name == "small" else 1)) * WIDTH * step**2
               for name, count in counts.items() if count}
    with open(folder / "series.csv") as stream:
        rows = [{name: float(x) for name, x in row.items() if x} for row in csv.DictReader(stream)]
    energies = [row["energy.bodies"] + sum(w * row[f"quantities.{name}"] for name, w in weights.items()) for row in rows]
    if not max(energies) <= energies[0] * 1.001:
        return "grew"
    least = shape(kind, WIDTH / size, aspect)[1]
    return "stable" if rows[-1]["max_penetration"] <= 0.1 * least else "overlap"


def main(arguments):
    parser = argparse.ArgumentParser(prog="scripts/bench stability contacts", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    add_options(parser)
    options = parser.parse_args(arguments)
    points = list(itertools.product(*(QUICK if options.quick else ALL)))
    found = KeptRuns(options, judge).verdicts(points, lambda p: heap(*p), lambda p: ", ".join(f"{n} {x}" for n, x in zip(NAMES, p)))
    with open(options.out / "contacts.csv", "w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow([*NAMES, "verdict"])
        writer.writerows([*point, word] for point, word in found.items())
    figures = {f"stability.contacts.{word}": sum(w == word for w in found.values()) for word in ("stable", "stopped", "grew", "overlap")}
    print(", ".join(f"{count} {name.split('.')[-1]}" for name, count in figures.items()))
    if options.json:
        options.json.write_text(json.dumps({"figures": figures}, indent=1) + "\n")
