"""Drag of a simple cubic array that moves through the lattice, against the theory of the one at rest.

The sphere's velocity is prescribed; a body force the opposite way holds the fluid. The drag is the force's mean over TRAVEL cells
of displacement, after the flow has settled; K as in periodic_array, with the mean velocity of the fluid relative to the sphere.
Solid fraction 0.064. `oblique` goes along (1, 0.6, 0.35), off every lattice direction; `boosted` is the same with 0.05
added to the velocity of everything: by how much the drag then differs is what the lattice's frame costs. noise: root mean
square of the force along the way about its mean, relative to that.
"""
import math

import numpy as np

import periodic_array as array
from problem import Curve, Found, Goal, Run

FRACTION = 0.064
RELAXATION_TIME = 1.5
VISCOSITY = (RELAXATION_TIME - 0.5) / 3
VELOCITY = 0.003         # Reynolds number 0.07 to 0.11: inertia adds less than 1e-4 to K
BOOST = 0.05
TRAVEL = 4               # cells
POSITION = (0.13, 0.31, 0.87)
DIRECTIONS = {"axis": (1, 0, 0), "oblique": (1, 0.6, 0.35)}
METHODS = {"default": "", "bounce-back": 'wall_scheme = "bounce-back"', "equilibrium": 'refill = "equilibrium"',
           "exact": 'force = "exact"', "double": ""}
FLUID = {"double": 'precision = "double"\n'}
SIZES = (6, 8, 12)

GOALS = [Goal("accuracy.moving_array.d8.oblique.error", 1.2), Goal("accuracy.moving_array.d12.oblique.error", 0.3),
         Goal("accuracy.moving_array.d8.oblique.noise", 0.5), Goal("accuracy.moving_array.d12.oblique.noise", 0.5),
         Goal("accuracy.moving_array.single_share", 10),  # of the discretisation error
         Goal("accuracy.moving_array.d8.boost_shift", 0.4), Goal("accuracy.moving_array.d12.boost_shift", 0.4)]
SHORT_GOALS = [Goal("accuracy.moving_array.d6.oblique.error", 2.2), Goal("accuracy.moving_array.d6.oblique.noise", 1.5)]

CASE = """title = "A moving simple cubic array, {diameter:.3f} cells across"
[units]
system = "lattice"
[domain]
size = [{edge}, {edge}, {edge}]
boundary = "periodic"
[fluid]
relaxation_time = {relaxation_time}
body_force = {force}
{fluid}
[coupling]
{coupling}
[[shapes]]
name = "sphere"
type = "sphere"
diameter = {diameter!r}
[[bodies]]
shape = "sphere"
density = 1
motion = "prescribed"
velocity = {velocity}
position = {position}
[run]
steps = {steps}
[output]
bodies = {{ every = 1 }}
"""
INITIAL = 'initial = {{ type = "uniform", velocity = {velocity} }}'
MEAN_FLOW = """[[quantities]]
name = "flow_{axis}"
type = "superficial-velocity"
axis = "{axis}"
"""


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
    text = CASE.format(edge=edge, diameter=diameter, relaxation_time=RELAXATION_TIME, coupling=METHODS[method],
                       force=(-drive(edge, diameter) * way).tolist(), velocity=(VELOCITY * way + boost).tolist(),
                       position=[edge // 2 + o for o in POSITION], steps=sum(durations(edge)),
                       fluid=FLUID.get(method, "") + (INITIAL.format(velocity=boost.tolist()) if boosted else ""))
    text += "".join(MEAN_FLOW.format(axis=axis) for axis in "xyz")
    key = f"d{D}.{direction}.{method}" + (".boosted" if boosted else "")
    return Run(key, text, dict(D=D, direction=direction, method=method, boosted=boosted))


def runs(level):
    if level == "short":
        return [run_of(6, "oblique")]
    return [*(run_of(D, direction) for D in SIZES for direction in DIRECTIONS),
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
