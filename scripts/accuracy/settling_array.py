"""A sphere, light or heavy, that settles or rises in a periodic box: stability, and the terminal velocity of the cubic array.

Its images make it a simple cubic array that moves through the lattice. Reference: the drag K(phi) of periodic_array, the same
in any direction.
Gravity pulls the body, a force on the fluid balances it: F on the body is -f (L^3 - V), the drag with the mean pressure's
share f L^3 = 6 pi mu a K U, and U is the body's velocity less the mean of the whole box. The Reynolds number is 0.3, the
direction oblique, the mean over three cells of displacement.
"""
import math

import numpy as np
import periodic_array as array
from case_text import case_text, cube, sphere
from problem import Claim, Found, Goal, Run

DIAMETER, BOX = 8, 16                                      # cells
RATIOS = (0.05, 0.1, 0.5, 0.8, 1.2, 2.5, 8.0)              # density of body over fluid
RELAXATION_TIMES = (0.6, 1.0, 1.8)
REYNOLDS = 0.3
WAY = 3                                                    # cells
DIRECTION = np.array([1, 0.62, 0.38]) / np.linalg.norm([1, 0.62, 0.38])
SAMPLES = 20

VOLUME = math.pi / 6 * DIAMETER**3
PHI = VOLUME / BOX**3

GOALS = [Goal(f"accuracy.settling_array.rho{r:g}.tau{t:g}.error", 1.2) for r in RATIOS for t in RELAXATION_TIMES]
CLAIMS = {"accuracy.settling_array.rho{rho}.tau{tau}.error": Claim(
    "settling velocity over that of theory", "simple cubic array that settles, {rho} times the fluid's density, τ = {tau}", f"D = {DIAMETER}",
    "Zick, Homsy, J. Fluid Mech. 115 (1982) 13", doi="10.1017/S0022112082000627", uncertainty="1e-6")}


def run_of(ratio, relaxation_time):
    viscosity = (relaxation_time - 0.5) / 3
    velocity = REYNOLDS * viscosity / DIAMETER
    resistance = 3 * math.pi * viscosity * DIAMETER * array.exact_drag(PHI)
    pull = resistance * velocity * (1 - PHI)
    response = max((ratio + 0.5) * VOLUME / resistance, BOX**2 / (4 * math.pi**2 * viscosity))
    every = math.ceil(max(WAY / velocity, 400) / SAMPLES)
    start = math.ceil((8 * response + 200) / every) * every
    steps = start + SAMPLES * every
    text = case_text(
        f"density ratio {ratio}, relaxation time {relaxation_time}", domain=cube(BOX),
        fluid=dict(relaxation_time=relaxation_time, body_force=-pull / (BOX**3 - VOLUME) * DIRECTION),
        gravity=dict(acceleration=pull / ((ratio - 1) * VOLUME) * DIRECTION), shapes=[sphere(DIAMETER)],
        bodies=[dict(shape="sphere", density=ratio, position=[8.13, 8.31, 8.47])], run=dict(steps=steps),
        output=dict(bodies=dict(every=every), fields=dict(every=steps, quantities=["velocity"])))
    return Run(f"rho{ratio:g}.tau{relaxation_time:g}", text,
               dict(density_ratio=ratio, tau=relaxation_time, velocity=velocity, start=start))


def runs(level):
    if level == "short":
        return [run_of(0.05, 1.0), run_of(8.0, 1.0)]
    return [run_of(r, t) for r in RATIOS for t in RELAXATION_TIMES]


def measure(run, outcome):
    bodies = outcome.bodies
    displacement = bodies.unwrapped()[:, 0] @ DIRECTION
    settled = bodies.step >= run.settings["start"]
    time, displacement = bodies.step[settled], displacement[settled]
    velocity = (displacement[-1] - displacement[0]) / (time[-1] - time[0]) - outcome.mean_velocity() @ DIRECTION
    along = bodies.array("velocity")[settled, 0] @ DIRECTION
    scale = 100 / run.settings["velocity"]
    return dict(error=scale * velocity - 100, spread=scale * (along.max() - along.min()) / 2)


def figures(measured):
    found = {}
    for key, m in measured.items():
        found[f"accuracy.settling_array.{key}.error"] = Found(m["error"], (key,))
        found[f"accuracy.settling_array.{key}.spread"] = Found(m["spread"], (key,))
    return found
