"""Drag of random arrays of equal spheres in Stokes flow, solid fractions 0.1 to 0.4.

Thirty-two spheres held in a periodic cube, a body force drives the flow; K = F / (6 pi mu a U), F a sphere's mean force with
the mean pressure gradient's share, U the superficial velocity; mean over realisations of equilibrium hard spheres. Held to lie
between the least and the largest of the published laws at Re = 0, which differ by 7 to 16 % (02_random_array_drag.toml): Hill, Koch and
Ladd (2001), van der Hoef, Beetstra and Kuipers (2005), Tenneti, Garg and Subramaniam (2011).
"""
import functools
import math

import numpy as np

import stokes_scene as scene
from problem import Found, Goal, Run

NUMBER = 32
FRACTIONS = (0.1, 0.2, 0.3, 0.4)
REALISATIONS = 6
FINE = 10
LEAST_GAP = 1e-3             # between surfaces, radii: so that rounding makes no overlap
SWEEPS = 300                 # of a Monte Carlo run; the spheres forget where they began within a tenth of it


def hill_koch_ladd(phi):
    if phi >= 0.4:
        return 10 * phi / (1 - phi)**3
    w = math.exp(-10 * (0.4 - phi) / phi)
    dilute = (1 + 3 * math.sqrt(phi / 2) + 135 / 64 * phi * math.log(phi) + 17.14 * phi) / (
        1 + 0.681 * phi - 8.48 * phi**2 + 8.16 * phi**3)
    return (1 - w) * dilute + w * 10 * phi / (1 - phi)**3


def van_der_hoef(phi):
    return 10 * phi / (1 - phi)**3 + (1 - phi) * (1 + 1.5 * math.sqrt(phi))


def tenneti(phi):
    return (1 + 5.81 * phi) / (1 - phi)**3 + 0.48 * phi**(1 / 3) / (1 - phi)**4


LAWS = (hill_koch_ladd, van_der_hoef, tenneti)


def between(phi):
    """Least and largest K of the laws."""
    found = [law(phi) for law in LAWS]
    return min(found), max(found)


GOALS = [Goal(f"accuracy.random_array.phi{phi:g}.d{FINE}.K", between(phi)[1], low=between(phi)[0]) for phi in FRACTIONS]
SHORT_GOALS = [Goal("accuracy.random_array.phi0.3.d8.K", 1.1 * between(0.3)[1], low=0.9 * between(0.3)[0])]  # two realisations


def edge(phi):
    """Of the cube, in radii."""
    return (4 * math.pi * NUMBER / (3 * phi))**(1 / 3)


def apart(away, length):
    away = away - length * np.round(away / length)
    return away, np.sqrt((away**2).sum(-1))


def spread_out(x, length, least):
    """Pushes overlapping pairs apart, half the overlap each, until none is left."""
    for _ in range(10000):
        away, distance = apart(x[:, None] - x[None], length)
        np.fill_diagonal(distance, np.inf)
        overlap = np.maximum(0, 1.001 * least - distance)
        if distance.min() >= least:
            return x
        x = x + 0.5 * ((overlap / distance)[..., None] * away).sum(1)
    raise ValueError("spheres still overlap: the array is too dense for this")


@functools.cache
def array(phi, seed):
    """Centres in radii: hard spheres in equilibrium, by Metropolis' moves of single spheres."""
    generator, length, least = np.random.default_rng(seed), edge(phi), 2 + LEAST_GAP
    x = spread_out(generator.random((NUMBER, 3)) * length, length, least)
    step = min(1.0, 0.5 * (length / NUMBER**(1 / 3) - 2) + 0.1)
    for _ in range(SWEEPS):
        for i, move in enumerate(step * (2 * generator.random((NUMBER, 3)) - 1)):
            distance = apart(x - (x[i] + move), length)[1]
            distance[i] = np.inf
            if distance.min() >= least:
                x[i] += move
    return x % length


def a_run(phi, diameter, seed):
    cells = round(edge(phi) * diameter / 2)
    a = cells / edge(phi)
    factor = sum(between(phi)) / 2
    drive = NUMBER * 6 * math.pi * scene.VISCOSITY * a * factor * scene.speed(2 * a) / cells**3
    steps = max(600, round(8 * cells**2 / (4 * math.pi**2 * scene.VISCOSITY)))
    positions = ", ".join(scene.vector(a * x) for x in array(phi, seed))
    text = scene.case(f"Random array, solid fraction {phi:g}, {2 * a:.3g} cells across", (cells,) * 3,
                      f'type = "sphere"\ndiameter = {2 * a!r}',
                      [f'[[bodies]]\nshape = "body"\ndensity = 1\nmotion = "fixed"\npositions = [{positions}]'], steps,
                      fluid=f"body_force = {scene.vector((drive, 0, 0))}", quantities="x")
    return Run(f"phi{phi:g}.d{diameter}.array{seed}", text, {"phi": phi, "D": diameter, "array": seed})


def runs(level):
    if level == "short":
        return [a_run(0.3, 8, seed) for seed in range(2)]
    listed = [(phi, FINE) for phi in FRACTIONS] + [(0.3, 8), (0.3, 16)]
    return [a_run(phi, D, seed) for phi, D in listed for seed in range(REALISATIONS)]


def measure(run, outcome):
    return {"K": scene.drag(run, outcome)}


def figures(measured):
    groups, found = {}, {}
    for key, values in measured.items():
        groups.setdefault(key.rsplit(".", 1)[0], {})[key] = values["K"]
    for group, members in groups.items():
        mean, spread = scene.mean_and_spread(list(members.values()))
        found[f"accuracy.random_array.{group}.K"] = Found(mean, tuple(members))
        found[f"accuracy.random_array.{group}.spread"] = Found(100 * spread / mean, tuple(members))
    return found
