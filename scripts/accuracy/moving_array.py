"""Drag of a simple cubic array that moves through the lattice, against the theory of the one at rest.

The sphere's velocity is prescribed; a body force the opposite way holds the fluid. The drag is the force's mean over TRAVEL cells
of displacement, after the flow has settled; K as in periodic_array, with the mean velocity of the fluid relative to the sphere.
Solid fraction 0.064. `oblique` goes along (1, 0.6, 0.35), off every lattice direction; `boosted` is the same with 0.05
added to the velocity of everything: by how much the drag then differs is what the lattice's frame costs. noise: root mean
square of the force along the way about its mean, relative to that, as surfaces pass from cell to cell. A fictitious boundary
method with finite elements has 3.8, 1.8 and 0.9 % at 11.4, 23.9 and 49.1 cells across, of first order in the cell (FeatFloWer,
docs/md_docs/dns_practitioners_guide.md, section 4: one sphere, constant velocity): the goals of noise are a quarter of that.
"""
import math

import numpy as np

import periodic_array as array
from case_text import case_text, cube, sphere
from problem import Claim, Curve, Found, Goal, Run

FRACTION = 0.064
RELAXATION_TIME = 1.5
VISCOSITY = (RELAXATION_TIME - 0.5) / 3
VELOCITY = 0.003         # Reynolds number 0.07 to 0.11: inertia adds less than 1e-4 to K
BOOST = 0.05
TRAVEL = 4               # cells
POSITION = (0.13, 0.31, 0.87)
DIRECTIONS = {"axis": (1, 0, 0), "oblique": (1, 0.6, 0.35)}
METHODS = {"default": {}, "bounce-back": dict(wall_scheme="bounce-back"),
           "exact": dict(force="exact"), "double": {}}
FLUID = {"double": dict(precision="double")}
SIZES = (6, 8, 12)
FINE = 24                # for the noise
OTHERS_NOISE = 3.8 * 11.4  # percent times cells across


def noise_goal(D, direction):
    return Goal(f"accuracy.moving_array.d{D}.{direction}.noise", round(OTHERS_NOISE / D / 4, 2))


GOALS = [Goal("accuracy.moving_array.d8.oblique.error", 1.2), Goal("accuracy.moving_array.d12.oblique.error", 0.3),
         *(noise_goal(D, direction) for D in (8, 12, FINE) for direction in DIRECTIONS),
         Goal("accuracy.moving_array.single_share", 10),  # of the discretisation error
         Goal("accuracy.moving_array.d8.boost_shift", 0.4), Goal("accuracy.moving_array.d12.boost_shift", 0.4)]
SHORT_GOALS = [Goal("accuracy.moving_array.d6.oblique.error", 2.2), noise_goal(6, "oblique"), noise_goal(8, "axis")]
THEORY = dict(source="Zick, Homsy, J. Fluid Mech. 115 (1982) 13", doi="10.1017/S0022112082000627", uncertainty="1e-6")
MOVING = "simple cubic array that moves, Stokes flow, φ = 0.064"
CLAIMS = {
    "accuracy.moving_array.d{D}.{way}.error": Claim("drag K", MOVING, "D = {D}", **THEORY, expected=lambda D, way: array.exact_drag(FRACTION)),
    "accuracy.moving_array.d{D}.{way}.noise": Claim(
        "force, root mean square about its mean", MOVING + ", {way}", "D = {D}",
        "steady motion: no noise; goal: a quarter of that of FeatFloWer, finite elements, 3.8 % at 11.4 cells, of first order"),
    "accuracy.moving_array.d{D}.boost_shift": Claim(
        "drag K, change if everything moves at 0.05 cells a step besides", MOVING, "D = {D}", "Galilean invariance",
        note="the quadratic equilibrium is not Galilean invariant"),
    "accuracy.moving_array.single_share": Claim(
        "difference of single from double precision, over the error", MOVING, "all", "own runs in double precision", kind="convergence")}


def unit(direction):
    vector = np.array(DIRECTIONS[direction], float)
    return vector / np.linalg.norm(vector)


def durations(edge):
    """Returns (steps until the flow has settled, steps of the mean)."""
    return math.ceil(edge**2 / VISCOSITY), math.ceil(TRAVEL / VELOCITY)


def drive(edge, diameter):
    """Returns the fluid's acceleration against the sphere's motion."""
    return array.drive(FRACTION, edge, diameter, VISCOSITY, VELOCITY)


def run_of(D, direction, method="default", boosted=False):
    edge, diameter = array.cube_of(FRACTION, D)
    way = unit(direction)
    boost = BOOST * way if boosted else 0 * way
    text = case_text(
        f"A moving simple cubic array, {diameter:.3f} cells across", domain=cube(edge),
        fluid=dict(relaxation_time=RELAXATION_TIME, body_force=-drive(edge, diameter) * way, **FLUID.get(method, {}),
                   **(dict(initial=dict(type="uniform", velocity=boost)) if boosted else {})),
        coupling=METHODS[method], shapes=[sphere(diameter)],
        bodies=[dict(shape="sphere", density=1, motion="prescribed", velocity=VELOCITY * way + boost,
                     position=[edge // 2 + o for o in POSITION])],
        run=dict(steps=sum(durations(edge))), output=dict(bodies=dict(every=1)),
        quantities=[dict(name=f"flow_{axis}", type="superficial-velocity", axis=axis) for axis in "xyz"])
    key = f"d{D}.{direction}.{method}" + (".boosted" if boosted else "")
    return Run(key, text, dict(D=D, direction=direction, method=method, boosted=boosted))


def runs(level):
    if level == "short":
        return [run_of(6, "oblique"), run_of(8, "axis")]
    return [*(run_of(D, direction) for D in (*SIZES, FINE) for direction in DIRECTIONS),
            *(run_of(D, "oblique", method) for D in SIZES for method in METHODS if method != "default"),
            *(run_of(D, "oblique", "default", True) for D in SIZES), run_of(8, "oblique", "bounce-back", True)]


def measure(run, outcome):
    edge, diameter = array.cube_of(FRACTION, run.settings["D"])
    way, (settled, _) = unit(run.settings["direction"]), durations(edge)
    along = -(outcome.bodies.array("force")[settled:, 0] @ way)
    flow = -np.dot([outcome.quantity(f"flow_{axis}") for axis in "xyz"], way)
    force = along.mean() + drive(edge, diameter) * math.pi / 6 * diameter**3
    drag = force / (3 * math.pi * VISCOSITY * diameter * flow)
    return {"error": 100 * (drag / array.exact_drag(FRACTION) - 1), "noise": 100 * along.std() / along.mean()}


def figures(measured):
    found = {}
    for key, m in measured.items():
        name = key.replace(".default", "")
        found[f"accuracy.moving_array.{name}.error"] = Found(m["error"], (key,))
        found[f"accuracy.moving_array.{name}.noise"] = Found(m["noise"], (key,))
    for D in SIZES:
        keys = [run_of(D, "oblique", "default", boosted).key for boosted in (False, True)]
        if all(key in measured for key in keys):
            shift = measured[keys[1]]["error"] - measured[keys[0]]["error"]
            found[f"accuracy.moving_array.d{D}.boost_shift"] = Found(shift, tuple(keys))
    return {**found, **share_of_single(measured)}


def share_of_single(measured):
    """Returns the largest difference between single and double, in percent of the error of the discretisation there."""
    pairs = [(run_of(D, "oblique").key, run_of(D, "oblique", "double").key) for D in SIZES]
    done = [pair for pair in pairs if all(key in measured for key in pair)]
    shares = [abs(measured[single]["error"] / measured[double]["error"] - 1) for single, double in done]
    return {"accuracy.moving_array.single_share": Found(100 * max(shares), sum(done, ()))} if done else {}


def curves(measured):
    lines = {}
    for method in METHODS:
        for D in SIZES:
            if m := measured.get(run_of(D, "oblique", method).key):
                lines.setdefault(method, []).append((m["core_seconds"], m["error"], f"{D}"))
    return [Curve(label, points) for label, points in lines.items()]
