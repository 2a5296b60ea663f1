"""Hot and cold spheres that move through the lattice: the heat that flows between them, against the same spheres at rest in a stream.

A hot and a cold sphere in a periodic cube, as in a body-centred array, solid fraction 0.1, Peclet number 10, Re = 1. At rest a body
force along (1, 0.6, 0.35) drives the fluid past them; moving they have the velocity that the stream would have, the other way, under the
same force, so that the fluid keeps still on the whole. A change of the frame changes no heat flow. error: the mean of the moving spheres'
heat flow over TRAVEL cells, against the mean of some places at rest, in percent; noise: its root mean square about its mean, relative to
that, as surfaces pass from cell to cell. The heat flow of a body is that over the steps in which heat crosses a cell.
"""
import math
import pathlib
import tomllib

import numpy as np
import periodic_array as array
import silt_results
from case_text import case_text, cube, sphere
from problem import Claim, Found, Goal, Run

REFERENCE = pathlib.Path(__file__).parent / "reference" / "01_periodic_arrays_series.toml"
FRACTION, PECLET, PRANDTL = 0.1, 10, 10
VELOCITY = 0.02          # cells a step
TRAVEL = 8               # cells
POSITIONS = array.offsets(4)
DIRECTION = np.array((1, 0.6, 0.35)) / np.linalg.norm((1, 0.6, 0.35))
SIZES = (8, 12)          # cells across, nearly
FORM = "accuracy.moving_hot_array.d{D}.{what}"

GOALS = [Goal(FORM.format(D=D, what=what), 1) for D in SIZES for what in ("error", "noise")]
SHORT_GOALS = [Goal(FORM.format(D=8, what="error"), 1)]
CLAIMS = {
    FORM.format(D="{D}", what="error"): Claim(
        "heat flow between moving spheres, of the same at rest", "hot and cold spheres, body-centred, φ = 0.1, Pe = 10, Re = 1", "D = {D}",
        "Galilean invariance; own runs at rest, mean of four places", kind="convergence"),
    FORM.format(D="{D}", what="noise"): Claim(
        "heat flow, root mean square about its mean", "hot and cold spheres that move, body-centred, φ = 0.1, Pe = 10, Re = 1", "D = {D}",
        "steady motion: no noise")}


def drag():
    """Returns K of the body-centred array, by the series (good to 1e-6 at this fraction)."""
    with open(REFERENCE, "rb") as stream:
        series = tomllib.load(stream)["sangani_acrivos_BCC"]
    chi = (FRACTION / series["phi_max"])**(1 / 3)
    return sum(q * chi**s for s, q in enumerate(series["q"]))


def run_of(D, position=None):
    """Returns the run at rest at a place, or, without one, that of the moving spheres."""
    edge, diameter = array.cube_of(FRACTION / 2, D)
    spread = VELOCITY * diameter / PECLET
    viscosity = PRANDTL * spread
    force = 2 * 3 * math.pi * viscosity * diameter * VELOCITY * drag() / edge**3 * DIRECTION
    moving = position is None
    motion = dict(motion="prescribed", velocity=-VELOCITY * DIRECTION) if moving else dict(motion="fixed")
    first = np.array(POSITIONS[position or 0]) + edge // 4
    settling = 4 * math.ceil(8 * max(edge**2 / (4 * math.pi**2 * spread), edge**2 / (4 * math.pi**2 * viscosity)) / 4)
    steps = settling + (math.ceil(TRAVEL / VELOCITY) if moving else 0)
    text = case_text(
        f"Hot and cold spheres, {'moving' if moving else 'at rest'}, {diameter:.3f} cells across", domain=cube(edge),
        fluid=dict(kinematic_viscosity=viscosity, body_force=force), heat=dict(thermal_diffusivity=spread), shapes=[sphere(diameter)],
        bodies=[dict(name=name, shape="sphere", density=1, position=(first + shift) % edge, temperature=t, **motion)
                for name, t, shift in (("hot", 0.5, 0), ("cold", -0.5, edge / 2))],
        run=dict(steps=steps), output=dict(series=[dict(name="heat", every=1, columns=["hot", "cold"])]),
        quantities=[dict(name=name, type="heat-flow", body=name) for name in ("hot", "cold")])
    return Run(f"d{D}.moving" if moving else f"d{D}.rest{position}", text, dict(D=D, settling=settling))


def runs(level):
    return [run_of(D, position) for D in ((8,) if level == "short" else SIZES) for position in (None, *range(len(POSITIONS)))]


def measure(run, outcome):
    table = silt_results.open(outcome.folder).table("heat")
    flow = 0.5 * (table["hot"] - table["cold"])
    last = flow[run.settings["settling"]:] if run.key.endswith("moving") else flow[-1:]
    before = flow[run.settings["settling"] * 7 // 8]
    return dict(flow=last.mean(), noise=100 * last.std() / last.mean(), change=100 * (before / last.mean() - 1))


def figures(measured):
    found = {}
    for D in SIZES:
        moving, rest = run_of(D).key, [run_of(D, p).key for p in range(len(POSITIONS))]
        if moving in measured:
            found[FORM.format(D=D, what="noise")] = Found(measured[moving]["noise"], (moving,))
        if all(key in measured for key in (moving, *rest)):
            flows = [measured[key]["flow"] for key in rest]
            found[FORM.format(D=D, what="error")] = Found(100 * (measured[moving]["flow"] / array.mean(flows) - 1), (moving, *rest))
            found[FORM.format(D=D, what="spread")] = Found(100 * (max(flows) - min(flows)) / array.mean(flows), tuple(rest))
    return found
