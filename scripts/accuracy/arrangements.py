"""Stokes drag of regular arrangements of spheres: simple cubic, body-centred, face-centred and hexagonal, loose and dense.

A body force along x drives the flow past spheres held in a periodic box; K = F / (6 pi mu a U), F the mean force on a sphere with
the mean pressure gradient's share, U the superficial velocity. What matters is the worst: gaps lie along the lattice's
directions in one arrangement and between them in another. Spread: the largest error of the positions less the smallest, in
points. "hexagonal" are rows of spheres on a triangular lattice whose box is 4 to 7 (a right one 4 to 6.93), so that it can be whole numbers
of cells. Reference: the same box (stokes_boxes.csv); the simple cubic ones are those of Zick and Homsy (1982).
"""
import functools
import itertools
import math

import numpy as np

import stokes_scene as scene
from problem import Claim, Found, Goal, Run
from stokes_periodic import Mirrors, PeriodicBox, Repeated, solve, sphere_points, uniform

PLACES = {"sc": [(0, 0, 0)], "bcc": [(0, 0, 0), (0.5, 0.5, 0.5)], "hexagonal": [(0, 0, 0), (0.5, 0.5, 0)],
          "fcc": [(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)]}  # in edges of the box
EDGES = {"hexagonal": (4, 7, 4)}                 # ratios, whole numbers; a cube else
LOOSE, DENSE, DENSEST = (0.064, 0.216), (0.343, 0.45), 0.6
SETUPS = [f"{lattice}.phi{phi:g}" for lattice in PLACES for phi in (*LOOSE, *DENSE, DENSEST)
          if phi < DENSEST or lattice in ("bcc", "fcc")]
LOOSE_SIZES, DENSE_SIZES = (8, 12), (8, 12, 20)  # cells across, nearly
POSITIONS = 4

GOALS = [Goal("accuracy.arrangements.loose.d8.worst", 0.5), Goal("accuracy.arrangements.loose.d12.worst", 0.3),
         Goal("accuracy.arrangements.dense.d12.worst", 1.5), Goal("accuracy.arrangements.dense.d20.worst", 0.6),
         Goal("accuracy.arrangements.d8.worst_spread", 1.5)]
SHORT_GOALS = [Goal("accuracy.arrangements.bcc.phi0.216.d8.error", 1.5), Goal("accuracy.arrangements.fcc.phi0.216.d8.error", 1.5)]
CLAIMS = {
    "accuracy.arrangements.{density}.d{D}.worst": Claim(
        "drag K, worst error of the {density} arrangements", "regular arrangements of spheres, Stokes flow", "D = {D}", **scene.SAME_BOX,
        uncertainty="3e-4", note="body-centred arrays of 0.216 at D = 8, and gaps of a cell and less at φ = 0.6"),
    "accuracy.arrangements.d{D}.worst_spread": Claim(
        "drag K, largest less smallest error of four places", "regular arrangements of spheres, Stokes flow", "D = {D}", **scene.SAME_BOX,
        uncertainty="3e-4", note="gaps of a cell and less at φ of 0.343 and 0.45: the error depends on the place"),
    "accuracy.arrangements.{lattice}.phi{phi}.d{D}.error": Claim(
        "drag K, mean of four places", "{lattice} array, Stokes flow, φ = {phi}", "D = {D}", **scene.SAME_BOX, uncertainty="3e-4",
        expected=lambda lattice, phi, D: scene.references("arrangements")[f"{lattice}.phi{phi}"]["K"])}


def parts(setup):
    lattice, phi = setup.split(".phi")
    return lattice, float(phi)


def box_of(setup):
    """Returns (edges of the box in diameters, places of the spheres in edges)."""
    lattice, phi = parts(setup)
    ratios, places = np.array(EDGES.get(lattice, (1, 1, 1)), float), np.array(PLACES[lattice], float)
    return ratios * (len(places) * math.pi / 6 / phi / math.prod(ratios)) ** (1 / 3), places


def cells_of(setup, across):
    """Returns (cells of the box, diameter): the whole box whose spheres are nearest to so many cells across."""
    edges, _ = box_of(setup)
    unit = np.array(EDGES.get(parts(setup)[0], (1, 1, 1)))
    cells = unit * max(1, round(across * edges[0] / unit[0]))
    return cells, cells[0] / edges[0]


def nearest_gap(setup):
    """Returns the gap between neighbours, in radii."""
    edges, places = box_of(setup)
    steps = [(p + np.array(n)) * edges for p in places for n in itertools.product((-1, 0, 1), repeat=3)]
    return 2 * (min(d for d in map(np.linalg.norm, steps) if d > 0) - 1)


@functools.cache
def drag(setup, fineness):
    """Returns K, by one sphere whose flow is repeated at the others' places."""
    gap = nearest_gap(setup)
    images = 1 - math.sqrt(gap * (1 + gap / 4))  # the deepest of those of a neighbour lie there (sphere_points)
    depth = max(0.65, images + 0.45 * (1 - images))
    edges, places = box_of(setup)
    count = 2 * round(180 * fineness * (0.35 / (1 - depth)) ** 2)  # even: of an odd number one would lie on a mirror
    box = Repeated(PeriodicBox(2 * edges), 2 * edges * places)
    along_x = Mirrors(np.zeros(3), (-1, 1, 1))
    flow, = solve(box, [sphere_points((0, 0, 0), 1, count, depth)], [uniform((1, 0, 0))], along_x)
    return flow.force(0)[0] / (6 * math.pi)


def exact(setup, fineness):
    return {"K": drag(setup, fineness)}


def a_run(setup, across, number, offset, K):
    cells, diameter = cells_of(setup, across)
    places = box_of(setup)[1]
    U, slowest = scene.speed(diameter), math.prod(cells) / (len(places) * 3 * math.pi * scene.VISCOSITY * diameter * K)
    steps = max(600, 13 * slowest, 8 * max(cells)**2 / (4 * math.pi**2 * scene.VISCOSITY))
    centres = ", ".join(scene.vector((place * cells + cells // 2 + offset) % cells) for place in places)
    text = scene.case(
        f"Spheres, {setup}, {diameter:.3f} cells across", cells, f'type = "sphere"\ndiameter = {diameter!r}',
        [f'[[bodies]]\nshape = "body"\ndensity = 1\nmotion = "fixed"\npositions = [{centres}]'], round(steps),
        fluid=f"body_force = {scene.vector((U / slowest, 0, 0))}\n"
              f'initial = {{ type = "uniform", velocity = {scene.vector((U, 0, 0))} }}', quantities="x")
    return Run(f"{setup}.d{across}.place{number}", text, {"setup": setup, "place": number, "D": across})


def runs(level):
    K = {setup: values["K"] for setup, values in scene.references("arrangements").items()}
    listed = [("bcc.phi0.216", 8), ("fcc.phi0.216", 8)] if level == "short" else [
        (setup, D) for setup in SETUPS for D in (LOOSE_SIZES if parts(setup)[1] in LOOSE else DENSE_SIZES)]
    return [a_run(setup, D, n, np.array(o), K[setup]) for setup, D in listed for n, o in enumerate(scene.offsets(POSITIONS))]


def measure(run, outcome):
    found = scene.drag(run, outcome)
    return {"K": found, "error": scene.percent(found, scene.references("arrangements")[run.settings["setup"]]["K"])}


def figures(measured):
    groups, found = {}, {}
    for key, values in measured.items():
        groups.setdefault(key.rsplit(".", 1)[0], {})[key] = values["error"]
    means, spreads = {}, {}
    for group, members in groups.items():
        means[group] = sum(members.values()) / len(members)
        spreads[group] = max(members.values()) - min(members.values())
        found[f"accuracy.arrangements.{group}.error"] = Found(means[group], tuple(members))
        found[f"accuracy.arrangements.{group}.spread"] = Found(spreads[group], tuple(members))

    def worst(name, phis, D, of):
        listed = {g: of[g] for g in of if g.endswith(f".d{D}") and float(g.split(".phi")[1].rsplit(".d", 1)[0]) in phis}
        if listed:
            runs_of = tuple(key for g in listed for key in groups[g])
            found[f"accuracy.arrangements.{name}"] = Found(max(listed.values(), key=abs), runs_of)
    for D in LOOSE_SIZES:
        worst(f"loose.d{D}.worst", LOOSE, D, means)
    for D in DENSE_SIZES[1:]:
        worst(f"dense.d{D}.worst", (*DENSE, DENSEST), D, means)
    worst("d8.worst_spread", (*LOOSE, *DENSE), 8, spreads)
    return found
