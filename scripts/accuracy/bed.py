"""Flow through a bed of sixty fixed spheres that touch as in a dry packing, from an inlet to an outlet, at Re = 8 and 50.

The bed of packing.py, periodic across, 4 diameters wide and some 4 high, 2 from the inlet and 3 from the outlet; Re = U D / nu
with the velocity U of the inflow. At Re = 50 trt does not last with 12 cells: these runs are under regularised.
flow: the largest difference of the flow through a plane in or behind the bed from the inflow, in percent: 0 where walls conserve mass.
error: of the pressure drop, the drag over the area, against that with D = 24. over_ergun: the drop with D = 24 against Ergun's law
(Chem. Eng. Prog. 48 (1952) 89), held to be within a quarter, for beds scatter about the law as much:
150 (1-e)^2 mu U / (e^3 D^2) + 1.75 (1-e) rho U^2 / (e^3 D), e the porosity in the middle of the bed, over as much height as the
spheres would fill at that porosity.
"""
import functools
import math
import tomllib

import numpy as np

import packing
from case_text import case_text, sphere
from problem import Claim, Found, Goal, Run

SPHERES, WIDTH, HEIGHT, SEED = 60, 4, 9, 0       # lengths in diameters
LOWEST = 2.5                                     # of the lowest centres
PLANES = [2 + 0.5 * k for k in range(14)]        # heights in and behind the bed
FLOWS = [f"flow{k}" for k in range(len(PLANES))]
PASSING = {8: 2400, 50: 1600}                    # steps in which the inflow passes a diameter; the gaps have ten times its velocity
MODEL = {8: "trt", 50: "regularised"}
SIZES, FINEST, SHORT_SIZE = (12, 16, 24), 24, 8
COLLISIONS = ("trt", "regularised", "bgk")       # at Re = 8 with 16 cells
WALLS = ("multireflection", "parabolic", "cli", "bounce-back")  # at Re = 8 with 12 cells
LONGEST = 20                                     # times in which the inflow passes a diameter

GOALS = [Goal("accuracy.bed.re8.d12.flow", 0.3), Goal("accuracy.bed.re8.d12.error", 1.5), Goal("accuracy.bed.re50.d12.error", 3.0),
         Goal("accuracy.bed.re8.d16.collisions", 2.0),
         *(Goal(f"accuracy.bed.re{Re}.d{FINEST}.over_ergun", 25.0) for Re in PASSING)]
SHORT_GOALS = [Goal(f"accuracy.bed.re8.d{SHORT_SIZE}.spread_behind", 0.1), Goal(f"accuracy.bed.re8.d{SHORT_SIZE}.flow", 0.3)]
CLAIMS = {
    "accuracy.bed.re{Re}.d{D}.flow": Claim(
        "flow through planes less the inflow, largest", "bed of sixty spheres, Re = {Re}", "D = {D}", "conservation of mass"),
    "accuracy.bed.re{Re}.d{D}.spread_behind": Claim(
        "flow through planes behind the bed, largest less smallest", "bed of sixty spheres, Re = {Re}", "D = {D}", "conservation of mass"),
    "accuracy.bed.re{Re}.d{D}.error": Claim(
        "pressure drop", "bed of sixty spheres, Re = {Re}", "D = {D}", "own run with D = 24", kind="convergence",
        note="at Re = 50 trt does not last, and under regularised drag between spheres is too large with few cells"),
    "accuracy.bed.re{Re}.d{D}.collisions": Claim(
        "pressure drop, difference between collision models", "bed of sixty spheres, Re = {Re}", "D = {D}", "own runs under trt",
        kind="convergence", note="under regularised and bgk drag between spheres is too large at low relaxation times"),
    "accuracy.bed.re{Re}.d{D}.over_ergun": Claim(
        "pressure drop", "bed of sixty spheres, Re = {Re}", "D = {D}", "Ergun's law, Chem. Eng. Prog. 48 (1952) 89", kind="experiment",
        uncertainty="25 %", expected=lambda Re, D: ergun(int(Re)))}


@functools.cache
def centres():
    """Returns the centres in diameters."""
    return packing.packing(SPHERES, WIDTH, SEED) + [0, 0, LOWEST]


def ergun(Re):
    """Returns the pressure drop of Ergun's law over rho U^2."""
    top = centres()[:, 2].max()
    solid = packing.solid_fraction(centres(), WIDTH, LOWEST + 0.5, top - 0.5)
    height = SPHERES * math.pi / 6 / WIDTH**2 / solid
    return height * (150 * solid**2 / Re + 1.75 * solid) / (1 - solid)**3


def run_of(Re, D, collision=None, walls=None):
    U, every = D / PASSING[Re], PASSING[Re] // 20
    text = case_text(
        f"A bed of {SPHERES} spheres, Re = {Re}, {D} cells across",
        domain=dict(size=[WIDTH * D, WIDTH * D, HEIGHT * D],
                    boundary=dict(x="periodic", y="periodic", z=[dict(type="velocity-inlet", velocity=[0, 0, U]), "pressure-outlet"])),
        fluid=dict(kinematic_viscosity=U * D / Re, collision=collision or MODEL[Re], initial=dict(type="uniform", velocity=[0, 0, U])),
        coupling=dict(wall_scheme=walls) if walls else {}, shapes=[sphere(D)],
        bodies=[dict(shape="sphere", density=1, motion="fixed", positions=D * centres())],
        run=dict(steps=LONGEST * PASSING[Re], steady=dict(quantity="drag", change=2e-4, every=every)),
        output=dict(series=[dict(name="flow", every=every // 4 * 2 + 1, columns=["drag", *FLOWS])]),
        quantities=[dict(name="drag", type="fluid-force", axis="z"),
                    *(dict(name=name, type="flow-rate", axis="z", at=height * D) for name, height in zip(FLOWS, PLANES))])
    key = ".".join([f"re{Re}", f"d{D}", *filter(None, (collision, walls))])
    return Run(key, text, dict(Re=Re, D=D, collision=collision or MODEL[Re], walls=walls or WALLS[0]))


def beside():
    """Returns the runs that differ from the others by collision model, and those by walls."""
    return [run_of(8, 16, collision) for collision in COLLISIONS[1:]], [run_of(8, 12, walls=walls) for walls in WALLS[1:]]


def runs(level):
    if level == "short":
        return [run_of(8, SHORT_SIZE)]
    return [*(run_of(Re, D) for D in SIZES for Re in PASSING), *sum(beside(), [])]


def measure(run, outcome):
    """Returns the pressure drop over rho U^2 and differences of the flow from the inflow: the largest, that at the last plane, and how much
    they differ among the planes behind the bed, where there are no walls: 0 once the flow is steady."""
    case = tomllib.loads(run.case)
    rows = np.genfromtxt(outcome.folder / "series_flow.csv", delimiter=",", names=True)
    rows = rows[-max(2, len(rows) // (10 if outcome.report["exit_reason"] == "steady" else 2)):]
    U, area = case["domain"]["boundary"]["z"][0]["velocity"][2], math.prod(case["domain"]["size"][:2])
    flows = [rows[name].mean() / (area * U) for name in FLOWS]
    behind = [flow for flow, height in zip(flows, PLANES) if height > centres()[:, 2].max() + 1]
    return {"drop": rows["drag"].mean() / (area * U**2), "flow": 100 * (max(flows, key=lambda flow: abs(flow - 1)) - 1),
            "behind": 100 * (flows[-1] - 1), "spread_behind": 100 * (max(behind) - min(behind))}


def figures(measured):
    found = {}
    for run in (*runs("short"), *runs("full")):
        if run.key not in measured:
            continue
        name, m, finest = f"accuracy.bed.{run.key}", measured[run.key], measured.get(run_of(run.settings["Re"], FINEST).key)
        for quantity in ("drop", "flow", "spread_behind"):
            found[f"{name}.{quantity}"] = Found(m[quantity], (run.key,))
        if run.settings["D"] == FINEST:
            found[f"{name}.over_ergun"] = Found(100 * (m["drop"] / ergun(run.settings["Re"]) - 1), (run.key,))
        elif finest:
            found[f"{name}.error"] = Found(100 * (m["drop"] / finest["drop"] - 1), (run.key,))
    keys = tuple(run.key for run in (run_of(8, 16), *beside()[0]))
    if all(key in measured for key in keys):
        drops = [measured[key]["drop"] for key in keys]
        found["accuracy.bed.re8.d16.collisions"] = Found(100 * (max(drops) - min(drops)) / drops[0], keys)
    return found
