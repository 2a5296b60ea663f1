"""Two spheres in flow along their line of centres, at gaps of 0.05 to 4 radii.

Both are held fixed in a periodic box, a body force drives the flow. K = F / (6 pi mu a U): F the mean of their forces with
the mean pressure gradient's share, U the superficial velocity. Reference: the same box (stokes_boxes.csv). In unbounded
fluid this is the problem of Stimson and Jeffery (1926); a figure is the relative error of K, and so that of their factor.
"along": the line is an axis of the lattice; "across": a diagonal, (1, 1, 0), of it.
"""
import math

import numpy as np

import stokes_scene as scene
from problem import Found, Goal, Run
from stokes_periodic import Mirrors, PeriodicBox, solve, sphere_points, uniform

BOX = {"along": (14.0, 6.0, 6.0), "across": (11.0, 11.0, 6.0)}  # radii
LINE = {"along": np.array([1.0, 0, 0]), "across": np.array([1.0, 1, 0]) / math.sqrt(2)}
GAPS = (0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0)                     # radii
SETUPS = [f"along.gap{gap:g}" for gap in GAPS] + ["across.gap0.25"]
FINE = 16

GOALS = [Goal(f"accuracy.two_spheres.{setup}.d{FINE}.error", 1.5) for setup in SETUPS] + [
    Goal("accuracy.two_spheres.error", 1.5)]
SHORT_GOALS = [Goal("accuracy.two_spheres.along.gap0.5.d8.error", 3.0)]  # four times the goal at twice the cell: second order


def parts(setup):
    direction, gap = setup.split(".", 1)
    return direction, float(gap.removeprefix("gap"))


def exact(setup, fineness):
    """Returns K of the box, from points in half of it (mirrored where the line is an axis)."""
    direction, gap = parts(setup)
    line, image = LINE[direction], 1 - math.sqrt(gap * (1 + gap / 4))
    depth = max(0.6, image + 0.25 * (1 - image))
    count = round((300 if depth < 0.65 else 700) * fineness)
    away = (1 + gap / 2) * line
    if direction == "along":
        bodies, mirrors = [sphere_points(away, 1, count, depth)], Mirrors(np.zeros(3), (-1, 1, 1))
    else:
        bodies = [sphere_points(side * away, 1, count // 2, depth) for side in (-1, 1)]
        mirrors = Mirrors(np.zeros(3), (0, 0, 1))
    flow, = solve(PeriodicBox(BOX[direction]), bodies, [uniform(line)], mirrors)
    force = sum(flow.force(i) for i in range(len(bodies)))
    return {"K": float(force @ line) / (12 * math.pi)}


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
                      [scene.body("body", place) for place in places], round(9 * slowest),
                      fluid=f'body_force = {scene.vector(drive * line)}\n'
                            f'initial = {{ type = "uniform", velocity = {scene.vector(U * line)} }}', quantities="x")
    return Run(f"{setup}.d{diameter}.place{number}", text, {"setup": setup, "place": number, "D": diameter})


def runs(level):
    factors = {setup: values["K"] for setup, values in scene.references("two_spheres").items()}
    places = list(enumerate(scene.offsets(4)))
    if level == "short":
        return [a_run("along.gap0.5", 8, n, o, factors["along.gap0.5"]) for n, o in places[:2]]
    listed = [(setup, FINE) for setup in SETUPS] + [("along.gap0.25", 8), ("along.gap0.25", 12), ("along.gap0.05", 8),
                                                    ("along.gap0.05", 12)]
    return [a_run(setup, diameter, n, o, factors[setup]) for setup, diameter in listed for n, o in places]


def measure(run, outcome):
    factor = scene.drag(run, outcome)
    return {"K": factor, "error": scene.percent(factor, scene.references("two_spheres")[run.settings["setup"]]["K"])}


def figures(measured):
    return scene.summary("two_spheres", measured, FINE)
