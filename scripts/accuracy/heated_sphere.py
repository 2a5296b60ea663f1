"""Heat that a sphere of given temperature gives to fluid at rest and to a stream: its Nusselt number, over the diameter.

rest: a sphere in the middle of a cube with cold sides W diameters wide. The cube's images add up to Madelung's constant M of rock salt,
so that Nu = 2 / (1 - M / (2 W)) up to the ninth power of 1 / W: "box" is against that, "wide" is 2 / Nu of two boxes drawn out to
1 / W = 0, against Nu = 2.

re...: a stream past a sphere, from an inlet to an outlet between sides that slip, with wider cells beyond a diameter from the sphere as
long as their Peclet number is at most 30: above that waves of heat grow. At Re = 100, Pr = 7 that takes 24 cells of one width across the
sphere, in a box 6 diameters wide instead of 8. Reference: the flow without bounds, by finite differences (reference/sphere_nusselt.csv,
sphere_convection.py). Laws (heat_laws.py) differ by up to 10 % among themselves; that of Feng and Michaelides (2000) is within 1 % of
the computed values. The Nusselt number over that of their law is "law".
"""
import csv
import functools
import itertools
import math
import pathlib

from case_text import case_text, sphere
from heat_laws import feng_michaelides
from problem import Claim, Found, Goal, Run

REFERENCE = pathlib.Path(__file__).parent / "reference" / "sphere_nusselt.csv"
MADELUNG = 1.7475645946
RESTING = {8: (3, 6), 12: (3, 6)}           # cells across: widths of the boxes in diameters
REYNOLDS, PRANDTLS = (20, 50, 100), (0.7, 7)
STABLE = 30                                 # largest Peclet number of a cell
VELOCITY = 0.08                             # cells a step
PASSING = 30                                # diameters that the stream goes, at most
STREAM = "accuracy.heated_sphere.re{Re}.pr{Pr}.d{D}.error"
LAW = "accuracy.heated_sphere.re{Re}.pr{Pr}.d{D}.law"
BOX, WIDE = "accuracy.heated_sphere.rest.d{D}.w{W}.box", "accuracy.heated_sphere.rest.d{D}.wide"


def sizes(re, pr):
    """Returns the cells across a sphere in a stream with which heat is stable."""
    return [D for D in (8, 16) if re * pr <= STABLE * D] or [24]


STREAMS = [(re, pr, D) for re in REYNOLDS for pr in PRANDTLS for D in sizes(re, pr)]
GOALS = [Goal(STREAM.format(Re=re, Pr=pr, D=D), 2) for re, pr, D in STREAMS if D > 8]
GOALS += [Goal(WIDE.format(D=D), 1) for D in RESTING] + [Goal(BOX.format(D=D, W=w), 1) for D, widths in RESTING.items() for w in widths]
SHORT_GOALS = [Goal(BOX.format(D=8, W=3), 1)]
COMPUTED = dict(source="finite differences (reference/sphere_nusselt.csv); Feng, Michaelides, Int. J. Heat Mass Transfer 43 (2000) 219",
                doi="10.1016/S0017-9310(99)00133-7", kind="computation", uncertainty="1 %")
CLAIMS = {
    STREAM: Claim("Nusselt number", "sphere in a stream, Re = {Re}, Pr = {Pr}, in a box 8 diameters wide (6 with 24 cells across)", "D = {D}", **COMPUTED,
                  expected=lambda Re, Pr, D: exact()[int(Re), float(Pr)],
                  note="at Pr = 7 the layer of warm fluid is an eighth to a fourteenth of a diameter thick: two cells or less"),
    WIDE: Claim("Nusselt number in a wide box, from two boxes", "sphere in fluid at rest", "D = {D}", "conduction from a sphere: Nu = 2", expected=2),
    BOX: Claim("Nusselt number", "sphere in fluid at rest in a cold cube {W} diameters wide", "D = {D}", "method of images",
               expected=lambda D, W: in_cube(float(W)))}


@functools.cache
def exact():
    """Returns {(Re, Pr): Nusselt number}."""
    with open(REFERENCE) as stream:
        return {(int(row["Re"]), float(row["Pr"])): float(row["Nu"])
                for row in csv.DictReader(line for line in stream if not line.startswith("#"))}


def in_cube(width):
    """Returns the Nusselt number in the middle of a cold cube that is `width` diameters wide."""
    return 2 / (1 - MADELUNG / (2 * width))


def hot_sphere(D, position):
    return dict(shapes=[sphere(float(D))], bodies=[dict(shape="sphere", density=1, motion="fixed", temperature=1.0, position=position)])


NUSSELT = [dict(name="Nu", type="nusselt-number", body="sphere")]


def rest_run(D, width):
    edge, spread = D * width, 0.25
    every = 2 * max(2, round(edge**2 / (3 * 9.87 * spread) / 12))
    text = case_text(
        f"A hot sphere in a cold cube {width} diameters wide, {D} cells across",
        domain=dict(size=[edge] * 3, boundary=dict.fromkeys("xyz", [dict(type="no-slip", temperature=0.0)] * 2)),
        fluid=dict(relaxation_time=1.0), heat=dict(thermal_diffusivity=spread), **hot_sphere(D, [edge / 2] * 3),
        run=dict(steps=200 * every, steady=dict(quantity="Nu", change=1e-4, every=every)), quantities=NUSSELT)
    return Run(f"rest.d{D}.w{width}", text, dict(D=D, width=width))


def stream_run(re, pr, D):
    viscosity = VELOCITY * D / re
    inflow = [VELOCITY, 0, 0]
    before, behind, width = (4, 6, 8) if D <= 16 else (3, 4, 6)  # diameters
    across, levels = width * D, min(D // 8, int(math.log2(STABLE * D / (re * pr))))
    every = 4 * round(D / VELOCITY / 4)
    text = case_text(
        f"A hot sphere in a stream, Re = {re}, Pr = {pr:g}, {D} cells across",
        domain=dict(size=[(before + behind) * D, across, across],
                    boundary=dict(x=[dict(type="velocity-inlet", velocity=inflow), "pressure-outlet"], y="free-slip", z="free-slip")),
        fluid=dict(kinematic_viscosity=viscosity, collision="auto", initial=dict(type="uniform", velocity=inflow)),
        heat=dict(thermal_diffusivity=viscosity / pr), coarsening=dict(levels=levels, distance=D) if levels else {},
        **hot_sphere(D, [before * D + 0.13, across / 2 + 0.31, across / 2 + 0.17]),
        run=dict(steps=PASSING * every, steady=dict(quantity="Nu", change=1e-3, every=every)), quantities=NUSSELT)
    return Run(f"re{re}.pr{pr:g}.d{D}", text, dict(Re=re, Pr=pr, D=D))


def runs(level):
    if level == "short":
        return [rest_run(8, 3)]
    return [*(rest_run(D, width) for D, widths in RESTING.items() for width in widths),
            *itertools.starmap(stream_run, STREAMS)]


def measure(run, outcome):
    of, nusselt = run.settings, outcome.quantity("Nu")
    expected = exact()[of["Re"], of["Pr"]] if "Re" in of else in_cube(of["width"])
    return dict(Nu=nusselt, error=100 * (nusselt / expected - 1))


def figures(measured):
    found = {}
    for key, m in measured.items():
        name = f"accuracy.heated_sphere.{key}"
        found[f"{name}.box" if key.startswith("rest") else f"{name}.error"] = Found(m["error"], (key,))
    for re, pr, D in STREAMS:
        if m := measured.get(key := f"re{re}.pr{pr:g}.d{D}"):
            found[LAW.format(Re=re, Pr=f"{pr:g}", D=D)] = Found(100 * (m["Nu"] / feng_michaelides(re, pr) - 1), (key,))
    for D, widths in RESTING.items():
        keys = [f"rest.d{D}.w{w}" for w in widths]
        if all(key in measured for key in keys):
            near, far = (2 / measured[key]["Nu"] for key in keys)
            resistance = far + (far - near) / (widths[1] / widths[0] - 1)
            found[WIDE.format(D=D)] = Found(100 * (1 / resistance - 1), tuple(keys))
    return found
