"""Natural convection of air in a square cavity with a hot and a cold side, as a slab periodic across.

Pr = 0.71, floor and ceiling insulated, Ra = g expansion dT L^3 / (viscosity diffusivity). Reference: a spectral computation
(cavity_convection.py; reference/heated_cavity.csv), from which de Vahl Davis, Int. J. Numer. Methods Fluids 3 (1983) 249, differs
by 0.07, 0.06 and 0.3 % in Nu at Ra = 1e4, 1e5 and 1e6. Figures: the Nusselt number of the hot side, and the largest velocities across
and up on the lines through the middle, errors in percent.
"""
import csv
import functools
import math
import pathlib

import numpy as np
from case_text import case_text
from problem import Claim, Curve, Found, Goal, Run

REFERENCE = pathlib.Path(__file__).parent / "reference" / "heated_cavity.csv"
PRANDTL = 0.71
FALL = 0.2               # sqrt(g expansion dT L), cells a step; the largest velocity is a quarter to a third of it
DEPTH = 4                # cells of the slab
SIZES = {10**4: (32, 64), 10**5: (32, 64, 96), 10**6: (64, 96, 128)}
LIMITS = {"Nu": 0.5, "u_max": 1, "v_max": 1}
FORM = "accuracy.heated_cavity.ra{Ra}.n{N}.{what}"

GOALS = [Goal(FORM.format(Ra=ra, N=n, what=what), limit) for ra, n in ((10**4, 64), (10**5, 64), (10**6, 128))
         for what, limit in LIMITS.items()]
SHORT_GOALS = [Goal(FORM.format(Ra=10**4, N=32, what=what), 4 * limit) for what, limit in LIMITS.items()]  # second order
CLAIMS = {FORM: Claim("{what}", "square cavity with a hot and a cold side, Pr = 0.71, Ra = {Ra}", "N = {N}",
                      "spectral computation (reference/heated_cavity.csv); de Vahl Davis, Int. J. Numer. Methods Fluids 3 (1983) 249",
                      doi="10.1002/fld.1650030305", kind="computation", uncertainty="1e-4",
                      expected=lambda Ra, N, what: exact()[int(Ra)][what])}


@functools.cache
def exact():
    """Returns {Ra: {quantity: value}} of the spectral computation; velocities in diffusivity over edge."""
    with open(REFERENCE) as stream:
        rows = list(csv.DictReader(line for line in stream if not line.startswith("#")))
    return {int(row["Ra"]): {name: float(row[name]) for name in (*LIMITS, "x", "y")} for row in rows if row["source"] == "spectral"}


def diffusivity(ra, N):
    return FALL * N / math.sqrt(ra * PRANDTL)


def run_of(ra, N):
    spread = diffusivity(ra, N)
    turn = 2 * round(N / FALL / 2)
    hot, cold = (dict(type="no-slip", temperature=t) for t in (0.5, -0.5))
    text = case_text(
        f"Heated cavity, Ra = {ra:g}, {N} cells a side",
        domain=dict(size=[N, DEPTH, N], boundary=dict(x=[hot, cold], y="periodic", z="no-slip")),
        fluid=dict(kinematic_viscosity=PRANDTL * spread), heat=dict(thermal_diffusivity=spread, expansion=1.0),
        gravity=dict(acceleration=[0, 0, -FALL**2 / N]),
        run=dict(steps=1000 * turn, steady=dict(quantity="Nu", change=2e-4, every=turn)),
        output=dict(fields=dict(every=1000 * turn, quantities=["velocity", "temperature"])),
        quantities=[dict(name="Nu", type="nusselt-number", side="x-low"), dict(name="Nu_cold", type="nusselt-number", side="x-high")])
    return Run(f"ra{ra}.n{N}", text, dict(Ra=ra, N=N))


def runs(level):
    if level == "short":
        return [run_of(10**4, 32)]
    return [run_of(ra, N) for ra, sizes in SIZES.items() for N in sizes]


def at_middle(values):
    """Returns values in the middle of an even number of cells along the first axis, by the cubic through the nearest four."""
    n = len(values) // 2
    return (9 * (values[n - 1] + values[n]) - values[n - 2] - values[n + 1]) / 16


def largest(line):
    """Returns (place from 0 to 1, value) of the largest of values in the middles of cells, by the parabola through the nearest three."""
    n = int(np.argmax(line))
    a, b, c = line[n - 1:n + 2]
    shift = (a - c) / (2 * (a - 2 * b + c))
    return (n + 0.5 + shift) / len(line), b - (a - c) * shift / 4


def measure(run, outcome):
    if outcome.report["exit_reason"] != "steady":
        raise ValueError("the flow did not become steady")
    ra, N = run.settings["Ra"], run.settings["N"]
    velocity = outcome.last_field("velocity").mean(axis=1, dtype=float) * N / diffusivity(ra, N)  # [z][x][component]
    (y, u_max), (x, v_max) = largest(at_middle(velocity[:, :, 0].T)), largest(at_middle(velocity[:, :, 2]))
    found = dict(Nu=abs(outcome.quantity("Nu")), u_max=u_max, v_max=v_max)
    errors = {what: 100 * (value / exact()[ra][what] - 1) for what, value in found.items()}
    lost = 100 * (abs(outcome.quantity("Nu_cold")) / found["Nu"] - 1)
    return {**errors, "y": y, "x": x, "lost": lost}


def figures(measured):
    return {f"accuracy.heated_cavity.{key}.{what}": Found(m[what], (key,)) for key, m in measured.items() for what in (*LIMITS, "lost")}


def curves(measured):
    return [Curve(f"Ra = {ra:g}", [(m["core_seconds"], m["Nu"], f"{N}") for N in sizes if (m := measured.get(f"ra{ra}.n{N}"))])
            for ra, sizes in SIZES.items()]
