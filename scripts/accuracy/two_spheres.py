"""Two spheres in flow along their line of centres, at gaps of 0.05 to 4 radii, and across it.

Both are held fixed in a periodic box, a body force drives the flow. K = F / (6 pi mu a U): F the mean of their forces with
the mean pressure gradient's share, U the superficial velocity. Reference: the same box (stokes_boxes.csv). In unbounded
fluid this is the problem of Stimson and Jeffery (1926); a figure is the relative error of K, and so that of their factor.
"along": the line is an axis of the lattice; "across": a diagonal, (1, 1, 0), of it. "beside": the line is an axis and the flow
another; then each sphere also feels a torque T, given as T / (8 pi mu a^2 U).
"""
import math
import tomllib

import numpy as np

import stokes_scene as scene
from problem import Claim, Found, Goal, Run
from stokes_periodic import Mirrors, PeriodicBox, solve, sphere_points, uniform

BOX = {"along": (14.0, 6.0, 6.0), "across": (11.0, 11.0, 6.0), "beside": (10.0, 8.0, 6.0)}  # radii
LINE = {"along": np.array([1.0, 0, 0]), "across": np.array([1.0, 1, 0]) / math.sqrt(2), "beside": np.array([1.0, 0, 0])}
FLOW = LINE | {"beside": np.array([0, 1.0, 0])}
GAPS = (0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0)                     # radii
SETUPS = [f"along.gap{gap:g}" for gap in GAPS] + ["across.gap0.25", "beside.gap0.25"]
FINE = 16

GOALS = [Goal(f"accuracy.two_spheres.{setup}.d{FINE}.error", 1.5) for setup in SETUPS] + [
    Goal("accuracy.two_spheres.beside.gap0.25.d12.torque_error", 0.3), Goal("accuracy.two_spheres.error", 1.5)]
SHORT_GOALS = [Goal("accuracy.two_spheres.along.gap0.5.d8.error", 3.0)]  # four times the goal at twice the cell: second order
CLAIMS = {
    "accuracy.two_spheres.error": Claim("drag K, worst of all", "two spheres in a periodic box, Stokes flow", f"D = {FINE}", **scene.SAME_BOX,
                                        uncertainty="1e-4"),
    "accuracy.two_spheres.{way}.gap{gap}.d{D}.error": Claim(
        "drag K, mean of the places", "two spheres, {way}, gap of {gap} radii, Stokes flow", "D = {D}", **scene.SAME_BOX, uncertainty="1e-4",
        expected=lambda way, gap, D: scene.references("two_spheres")[f"{way}.gap{gap}"]["K"]),
    "accuracy.two_spheres.{way}.gap{gap}.d{D}.torque_error": Claim(
        "torque, mean of the places", "two spheres, {way}, gap of {gap} radii, Stokes flow", "D = {D}", **scene.SAME_BOX, uncertainty="1e-4",
        expected=lambda way, gap, D: scene.references("two_spheres")[f"{way}.gap{gap}"]["torque"])}


def parts(setup):
    direction, gap = setup.split(".", 1)
    return direction, float(gap.removeprefix("gap"))


def exact(setup, fineness):
    """Returns K of the box, from points in half of it (mirrored where the line is an axis)."""
    direction, gap = parts(setup)
    line, image = LINE[direction], 1 - math.sqrt(gap * (1 + gap / 4))
    depth = max(0.6, image + 0.25 * (1 - image))
    count = round((300 if depth < 0.65 else 700) * fineness) * (2 if direction == "beside" else 1)
    away = (1 + gap / 2) * line
    if direction == "along":
        bodies, mirrors = [sphere_points(away, 1, count, depth)], Mirrors(np.zeros(3), (-1, 1, 1))
    else:
        bodies = [sphere_points(side * away, 1, count // 2, depth) for side in (-1, 1)]
        mirrors = Mirrors(np.zeros(3), (0, 0, 1))
    flow, = solve(PeriodicBox(BOX[direction]), bodies, [uniform(FLOW[direction])], mirrors)
    force = sum(flow.force(i) for i in range(len(bodies)))
    found = {"K": float(force @ FLOW[direction]) / (12 * math.pi)}
    if direction == "beside":
        found["torque"] = float(flow.torque(1, away)[2]) / (8 * math.pi)  # of the sphere at larger x
    return found


def axis_of(setup):
    return "y" if parts(setup)[0] == "beside" else "x"


def a_run(setup, diameter, number, offset, factor):
    direction, gap = parts(setup)
    a, line = diameter / 2, LINE[direction]
    cells = [length * a for length in BOX[direction]]
    centre = np.array([n // 2 for n in cells]) + offset
    places = [centre + side * (1 + gap / 2) * a * line for side in (-1, 1)]
    U = scene.speed(diameter)
    drive = 12 * math.pi * scene.VISCOSITY * a * factor * U / math.prod(cells)
    slowest = math.prod(cells) / (12 * math.pi * scene.VISCOSITY * a * factor)  # steps in which the mean velocity settles
    text = scene.case(f"Two spheres, {setup}, {diameter} cells across", cells, f'type = "sphere"\ndiameter = {diameter}',
                      [scene.body("body", place) for place in places], round((14 if direction == "beside" else 9) * slowest),
                      fluid=f'body_force = {scene.vector(drive * FLOW[direction])}\n'
                            f'initial = {{ type = "uniform", velocity = {scene.vector(U * FLOW[direction])} }}',
                      quantities=axis_of(setup))
    return Run(f"{setup}.d{diameter}.place{number}", text, {"setup": setup, "place": number, "D": diameter})


def runs(level):
    factors = {setup: values["K"] for setup, values in scene.references("two_spheres").items()}
    places = list(enumerate(scene.offsets(4)))
    if level == "short":
        return [a_run("along.gap0.5", 8, n, o, factors["along.gap0.5"]) for n, o in places[:2]]
    listed = [(setup, FINE) for setup in SETUPS] + [("along.gap0.25", 8), ("along.gap0.25", 12), ("along.gap0.05", 8),
                                                    ("along.gap0.05", 12), ("beside.gap0.25", 8), ("beside.gap0.25", 12)]
    return [a_run(setup, diameter, n, o, factors[setup]) for setup, diameter in listed for n, o in places]


def measure(run, outcome):
    setup = run.settings["setup"]
    reference, factor = scene.references("two_spheres")[setup], scene.drag(run, outcome, axis_of(setup))
    found = {"K": factor, "error": scene.percent(factor, reference["K"])}
    if "torque" in reference:
        found["torque"] = torque(run, outcome, factor)
        found["torque_error"] = scene.percent(found["torque"], reference["torque"])
    return found


def torque(run, outcome, factor):
    """Returns T / (8 pi mu a^2 U) of spheres beside each other, U by the drag factor: the mean of the two, of opposite sign."""
    scene_of = tomllib.loads(run.case)
    a = run.settings["D"] / 2
    forces, torques = (outcome.bodies.array(name) for name in ("force", "torque"))
    force = scene.settled(forces.mean(1), np.abs(forces[-1]).max())[1] + (
        scene.volume_of(scene_of["shapes"][0]) * scene_of["fluid"]["body_force"][1])
    turning = scene.settled((torques[:, 1] - torques[:, 0]) / 2, np.abs(torques[-1]).max())[2]
    return 0.75 * factor * turning / (force * a)


def figures(measured):
    return scene.summary("two_spheres", measured, FINE)
