"""Conduction through simple, body-centred and face-centred cubic arrays of spheres in fluid at rest, against Sangani and Acrivos.

Insulating spheres, and spheres of given temperature (one that conducts infinitely well). The fluid is between two planes of
temperatures 1/2 and -1/2, on which the array is symmetric: of the simple cubic array a sphere lies in the middle, of the others
a layer lies in the middle and half of one on either plane. The heat flow from the lower plane and its spheres over that of
the fluid alone is the effective conductivity. Reference: reference/conduction_arrays.csv, computed by lattice_conduction.py,
which agrees with the series of Sangani, Acrivos, Proc. R. Soc. A 386 (1983) 263. error: mean over some places of the array on the
lattice along the planes, in percent; spread: the largest less the smallest, in points. The steady state does not
depend on the diffusivity.
"""
import csv
import functools
import math
import pathlib

import periodic_array as array
from case_text import case_text, sphere
from lattice_conduction import FRACTIONS, PLACES
from problem import Claim, Found, Goal, Run

REFERENCE = pathlib.Path(__file__).parent / "reference" / "conduction_arrays.csv"
KINDS = ("insulating", "conducting")
SIZES = {8: 1.0, 12: 0.3}   # cells across, nearly: the cube is a whole number of cells; goals
POSITIONS = array.offsets(4)
DIFFUSIVITY = 0.25          # cells squared a step
WORST = "accuracy.conduction_arrays.{array}.{spheres}.d{D}.worst"
ONE = "accuracy.conduction_arrays.{array}.{spheres}.phi{phi}.d{D}.error"
SHORT = [("FCC", "conducting", 0.3, 8)]

GOALS = [Goal(WORST.format(array=name, spheres=kind, D=D), limit) for name in PLACES for kind in KINDS for D, limit in SIZES.items()]
SHORT_GOALS = [Goal(ONE.format(array=name, spheres=kind, phi=f"{phi:g}", D=D), SIZES[D]) for name, kind, phi, D in SHORT]
SANGANI = dict(source="Rayleigh's method (reference/conduction_arrays.csv); Sangani, Acrivos, Proc. R. Soc. A 386 (1983) 263",
               doi="10.1098/rspa.1983.0036", uncertainty="3e-6",
               note="gaps between spheres of φ = 0.5 are 0.015 (SC), 0.1 and 0.14 diameters, a fifth of a cell to one and a half, and carry much of the heat")
CLAIMS = {
    WORST: Claim("effective conductivity, worst of φ = 0.1 to 0.5", "{array} array of {spheres} spheres, fluid at rest", "D = {D}", **SANGANI),
    ONE: Claim("effective conductivity, mean of four places", "{array} array of {spheres} spheres, fluid at rest, φ = {phi}", "D = {D}",
               **SANGANI, expected=lambda array, spheres, phi, D: exact()[array, spheres, float(phi)])}


@functools.cache
def exact():
    """Returns {(array, spheres, solid fraction): effective conductivity over the fluid's}."""
    with open(REFERENCE) as stream:
        return {(row["array"], row["spheres"], float(row["phi"])): float(row["conductivity"])
                for row in csv.DictReader(line for line in stream if not line.startswith("#"))}


def box_of(name, fraction, across):
    """Returns (edge of the cubic cell in cells, diameter)."""
    return array.cube_of(fraction / len(PLACES[name]), across)


def layers_of(name):
    """Returns (height, place along x and y) of the spheres, in edges."""
    if name == "SC":
        return [(0.5, (0.0, 0.0))]
    return [(z + top, (x, y)) for x, y, z in PLACES[name] for top in ((0, 1) if z == 0 else (0,))]


def run_of(name, kind, fraction, across, position):
    edge, diameter = box_of(name, fraction, across)
    offset = POSITIONS[position]
    bodies = []
    for n, (height, place) in enumerate(layers_of(name)):
        centre = [(p * edge + edge // 2 + o) % edge for p, o in zip(place, offset)]
        temperature = dict(temperature=0.5 - height) if kind == "conducting" else {}
        bodies.append(dict(name=f"{'low' if height == 0 else 'other'}{n}", shape="sphere", density=1, motion="fixed",
                           position=[*centre, min(height * edge, edge * (1 - 1e-9))], **temperature))
    plane = lambda t: dict(type="no-slip", solid_for_bodies=False, temperature=t)  # noqa: E731
    low = [b["name"] for b in bodies if b["name"].startswith("low")]
    relaxing = edge**2 / (4 * math.pi**2 * DIFFUSIVITY)
    every = 2 * max(2, round(relaxing / 6))
    text = case_text(
        f"Conduction, {name}, {kind} spheres, solid fraction {fraction:g}, {diameter:.3f} cells across",
        domain=dict(size=[edge] * 3, boundary=dict(x="periodic", y="periodic", z=[plane(0.5), plane(-0.5)])),
        fluid=dict(relaxation_time=1.0), heat=dict(thermal_diffusivity=DIFFUSIVITY), shapes=[sphere(diameter)], bodies=bodies,
        run=dict(steps=every * round(20 * relaxing / every), steady=dict(quantity="through", change=2e-5, every=every)),
        quantities=[dict(name="through", type="heat-flow", side="z-low"), *(dict(name=b, type="heat-flow", body=b) for b in low)])
    settings = dict(array=name, spheres=kind, fraction=fraction, D=across, position=position, low=low)
    return Run(f"{name}.{kind}.phi{fraction:g}.d{across}.{position}", text, settings)


def runs(level):
    listed = SHORT if level == "short" else [(n, k, f, D) for n in PLACES for k in KINDS for f in FRACTIONS for D in SIZES]
    return [run_of(*one, p) for one in listed for p in range(len(POSITIONS))]


def measure(run, outcome):
    of = run.settings
    edge, _ = box_of(of["array"], of["fraction"], of["D"])
    flow = outcome.quantity("through") + sum(outcome.quantity(b) for b in of["low"])
    found = flow / (edge * DIFFUSIVITY)
    return {"conductivity": found, "error": 100 * (found / exact()[of["array"], of["spheres"], of["fraction"]] - 1)}


def figures(measured):
    groups = {}
    for key, values in measured.items():
        group, position = key.rsplit(".", 1)
        groups.setdefault(group, {})[key] = values["error"]
    found, worst = {}, {}
    for group, errors in groups.items():
        if len(errors) < len(POSITIONS):
            continue
        mean = array.mean(errors.values())
        found[f"accuracy.conduction_arrays.{group}.error"] = Found(mean, tuple(errors))
        found[f"accuracy.conduction_arrays.{group}.spread"] = Found(max(errors.values()) - min(errors.values()), tuple(errors))
        name, kind, *_, D = group.replace("phi0.", "phi0_").split(".")
        worst.setdefault((name, kind, D[1:]), {})[group] = mean
    for (name, kind, D), means in worst.items():
        if len(means) == len(FRACTIONS):
            keys = tuple(key for group in means for key in groups[group])
            found[WORST.format(array=name, spheres=kind, D=D)] = Found(max(means.values(), key=abs), keys)
    return found
