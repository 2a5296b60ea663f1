"""Cubes and spheres of equal volume that settle in swarms: how much slower the cubes are.

Reference: arXiv 2401.10878 (abstract): from Archimedes number 500 to 2000 and solid fraction 0.1 to 0.3 cubes settle 13 to 26 % slower
than spheres of the same volume. Archimedes number: (rho_p / rho_f - 1) g d^3 / nu^2, d of the sphere. Swarms of 64 in a periodic cube begin
as a simple cubic array, each body moved a little at random, cubes aligned; they have lost that order when the mean is begun. Density
ratio 2, no friction: the abstract does not tell. As in hindered_settling.py a force on the fluid balances the bodies' weight, velocities
are against the mean of the box. A swarm is one of many: another seed changes a velocity by some percent.
"""
import math
import random

from case_text import case_text, cube, sphere
from problem import Claim, Found, Goal, Run

DIAMETER, EDGES_PER_BOX, RATIO = 10, 4, 2.0
ARCHIMEDES, FRACTIONS = (500, 2000), (0.1, 0.2, 0.3)
SHORT = dict(archimedes=1000, fraction=0.2, D=8, edges=3, settled=12)
VELOCITY = 0.05                              # of one sphere alone, cells a step
UNSTEADY, SETTLED = 16, 24                   # displacements of one alone, in diameters: before the mean is taken, and of the mean
SHIFT = 0.08                                 # of a body at the start, diameters
RANGE, SCATTER = (13, 26), 5

GOALS = [Goal("accuracy.cube_swarm.slower", RANGE[1], low=RANGE[0]),
         *(Goal(f"accuracy.cube_swarm.ar{ar}.phi{phi:g}.slower", RANGE[1] + SCATTER, low=RANGE[0] - SCATTER)
           for ar in ARCHIMEDES for phi in FRACTIONS)]
SHORT_GOALS = [Goal("accuracy.cube_swarm.short.slower", 40, low=2)]
SOURCE = dict(source="arXiv 2401.10878, abstract: 13 to 26 % at Archimedes numbers of 500 to 2000, φ of 0.1 to 0.3", kind="computation")
CLAIMS = {
    "accuracy.cube_swarm.slower": Claim("velocity of cubes, less than of spheres of equal volume, mean of all", "swarms that settle", f"D = {DIAMETER}",
                                        **SOURCE),
    "accuracy.cube_swarm.ar{ar}.phi{phi}.slower": Claim(
        "velocity of cubes, less than of spheres of equal volume", "swarms that settle, Archimedes number {ar}, φ = {phi}", f"D = {DIAMETER}",
        **SOURCE, uncertainty="5 points: one swarm each"),
    "accuracy.cube_swarm.short.slower": Claim(
        "velocity of cubes, less than of spheres of equal volume", "swarm of 27 that settles, Archimedes number 1000, φ = 0.2", "D = 8", **SOURCE,
        uncertainty="10 points: a short mean of a small swarm")}


def reynolds_alone(archimedes):
    """Returns the Reynolds number of one sphere alone, after Schiller and Naumann: 18 Re (1 + 0.15 Re^0.687) = Ar."""
    re = 1.0
    for _ in range(200):
        re = 0.5 * (re + archimedes / (18 * (1 + 0.15 * re**0.687)))
    return re


def run_of(shape, archimedes, fraction, D=DIAMETER, edges=EDGES_PER_BOX, settled=SETTLED, name=None):
    volume, count = math.pi / 6 * D**3, edges**3
    box = round((count * volume / fraction)**(1 / 3))
    phi = count * volume / box**3
    viscosity = VELOCITY * D / reynolds_alone(archimedes)
    gravity = archimedes * viscosity**2 / ((RATIO - 1) * D**3)
    generator = random.Random(1)
    sites = [[(n + 0.5) * box / edges + generator.uniform(-SHIFT, SHIFT) * D for n in (i, j, k)]
             for i in range(edges) for j in range(edges) for k in range(edges)]
    every = round(D / VELOCITY / 4)
    steps = 4 * (UNSTEADY + settled) * every
    edge = volume**(1 / 3)
    text = case_text(
        f"{count} {shape}s settling, Archimedes number {archimedes}, {phi:.3f} solid", domain=cube(box),
        fluid=dict(kinematic_viscosity=viscosity, body_force=[0, 0, phi * (RATIO - 1) * gravity]),
        gravity=dict(acceleration=[0, 0, -(1 - phi) * gravity]), contacts=dict(restitution=0.9),
        shapes=[sphere(D, "body") if shape == "sphere" else dict(name="body", type="box", edges=[edge] * 3)],
        bodies=[dict(shape="body", density=RATIO, positions=sites)], run=dict(steps=steps),
        output=dict(bodies=dict(every=every), fields=dict(every=steps, quantities=["velocity"])))
    return Run(f"{name or f'ar{archimedes}.phi{fraction:g}'}.{shape}", text, dict(shape=shape, D=D, settled=settled))


def runs(level):
    if level == "short":
        return [run_of(shape, **SHORT, name="short") for shape in ("sphere", "cube")]
    return [run_of(shape, ar, phi) for ar in ARCHIMEDES for phi in FRACTIONS for shape in ("sphere", "cube")]


def measure(run, outcome):
    """Returns the velocity against the mean of the box over that of one sphere alone: from the way, so from all steps."""
    bodies = outcome.bodies
    height = bodies.unwrapped()[..., 2]
    late = bodies.step >= UNSTEADY * run.settings["D"] / VELOCITY
    step, height = bodies.step[late], height[late]
    each = (height[-1] - height[0]) / (step[-1] - step[0]) - outcome.mean_velocity()[2]
    middle = len(step) // 2
    first, second = ((height[b] - height[a]).mean() / (step[b] - step[a]) for a, b in ((0, middle), (middle, -1)))
    return dict(velocity=-each.mean() / VELOCITY, change=(first - second) / VELOCITY, mean=outcome.mean_velocity()[2] / VELOCITY)


def figures(measured):
    found, every = {}, []
    for key in [key.removesuffix(".cube") for key in measured if key.endswith(".cube")]:
        pair = (f"{key}.cube", f"{key}.sphere")
        if pair[1] in measured:
            cubes, spheres = (measured[one]["velocity"] for one in pair)
            found[f"accuracy.cube_swarm.{key}.slower"] = Found(100 * (1 - cubes / spheres), pair)
            found[f"accuracy.cube_swarm.{key}.sphere.velocity"] = Found(spheres, pair[1:])
            every += [found[f"accuracy.cube_swarm.{key}.slower"]] if key != "short" else []
    if len(every) == len(ARCHIMEDES) * len(FRACTIONS):
        found["accuracy.cube_swarm.slower"] = Found(sum(f.value for f in every) / len(every), sum((f.runs for f in every), ()))
    return found
