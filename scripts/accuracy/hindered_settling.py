"""Many spheres that settle in a periodic box: how much slower than one alone, by Richardson and Zaki's exponent.

Reference: w / w0 = k (1 - phi)^n; at Reynolds number 1 (of one sphere alone) n is 4.35 by J. F. Richardson, W. N. Zaki (1954)
and 4.88 by J. Garside, M. R. Al-Dibouni (1977) (reference/08_hindered_settling_dkt.toml): the figure is how far n lies
outside these two. k < 1 in dilute suspensions, here as found. The mean velocity of N spheres in a periodic box is lower
than in a large suspension by 1.7601 (phi / N)^(1/3) S mu / mu_eff (A. J. C. Ladd, J. Chem. Phys. 93 (1990) 3484; G. Mo,
A. S. Sangani, Phys. Fluids 6 (1994) 1637; S: structure factor of hard spheres after Carnahan and Starling), which is added.
w0 is after Schiller and Naumann; it does not act on n.
"""
import math

import numpy as np
from case_text import case_text, cube, sphere
from problem import Claim, Found, Goal, Run

DIAMETER, BOX, RATIO, RELAXATION_TIME, REYNOLDS = 8, 40, 2.0, 1.0, 1.0
COUNTS = (12, 24, 48, 72)                   # spheres: phi = 0.05, 0.10, 0.20, 0.30
LAWS = (4.35, 4.88)
UNSTEADY, SETTLED = 8, 24                   # displacements of one alone, in diameters: before the mean is taken, and of the mean

VOLUME = math.pi / 6 * DIAMETER**3
VISCOSITY = (RELAXATION_TIME - 0.5) / 3
VELOCITY = REYNOLDS * VISCOSITY / DIAMETER  # of one alone

GOALS = [Goal("accuracy.hindered_settling.exponent.outside", 0.3)]
CLAIMS = {"accuracy.hindered_settling.exponent.outside": Claim(
    "exponent of the hindrance, outside of 4.35 to 4.88", "suspensions of up to φ = 0.3 that settle, Re = 1", "D = 8",
    "Richardson, Zaki, Chem. Eng. Sci. 3 (1954) 65; Garside, Al-Dibouni (1977)", doi="10.1016/0009-2509(54)85015-9", kind="experiment",
    unit="", note="5.37 with k = 1.00; one suspension of each φ, in a box 5 diameters wide; the cause is not known")}


def solid_fraction(count):
    return count * VOLUME / BOX**3


def run_of(count):
    phi = solid_fraction(count)
    drag = 3 * math.pi * VISCOSITY * DIAMETER * VELOCITY * (1 + 0.15 * REYNOLDS**0.687)  # with the mean pressure's share
    pull = drag * (1 - phi)
    every = round(DIAMETER / VELOCITY / 4)
    steps = 4 * (UNSTEADY + SETTLED) * every
    text = case_text(
        f"{count} spheres settling, {phi:.3f} solid", domain=cube(BOX),
        fluid=dict(relaxation_time=RELAXATION_TIME, body_force=[0, 0, count * pull / (BOX**3 - count * VOLUME)]),
        gravity=dict(acceleration=[0, 0, -pull / ((RATIO - 1) * VOLUME)]), contacts=dict(restitution=0.9),
        shapes=[sphere(DIAMETER)],
        fill=[dict(shape="sphere", density=RATIO, count=count, gap=0.5 if phi < 0.25 else 0.05)],
        run=dict(steps=steps),
        output=dict(bodies=dict(every=every), fields=dict(every=steps, quantities=["velocity"])))
    return Run(f"n{count}", text, dict(count=count, phi=phi, steps_before=4 * UNSTEADY * every))


def runs(level):
    return [run_of(count) for count in COUNTS] if level == "full" else []


def measure(run, outcome):
    """Velocity over that of one alone, against the mean of box: from the way, so from all steps."""
    bodies = outcome.bodies
    height = bodies.unwrapped()[..., 2]
    settled = bodies.step >= run.settings["steps_before"]
    step, height = bodies.step[settled], height[settled]
    each = (height[-1] - height[0]) / (step[-1] - step[0]) - outcome.mean_velocity()[2]
    return dict(velocity=-each.mean() / VELOCITY, deviation=each.std() / VELOCITY)


def larger_box(count):
    """Returns what a suspension without end adds to the velocity over that of one alone."""
    phi = solid_fraction(count)
    structure = (1 - phi) ** 4 / ((1 + 2 * phi) ** 2 + phi**3 * (phi - 4))
    viscosity = (1 - phi / 0.64) ** -1.6  # Krieger and Dougherty
    return 1.7601 * (phi / count) ** (1 / 3) * structure / viscosity


def figures(measured):
    found = {}
    counts = [n for n in COUNTS if f"n{n}" in measured]
    keys = tuple(f"n{n}" for n in counts)
    if len(counts) < 3:
        return found
    box = np.array([measured[key]["velocity"] for key in keys])
    fluid = np.log([1 - solid_fraction(n) for n in counts])
    for name, velocity in (("in_box", box), ("exponent", box + [larger_box(n) for n in counts])):
        n, log_k = np.polyfit(fluid, np.log(velocity), 1)
        found[f"accuracy.hindered_settling.{name}"] = Found(n, keys)
        found[f"accuracy.hindered_settling.{name}.prefactor"] = Found(math.exp(log_k), keys)
    n = found["accuracy.hindered_settling.exponent"].value
    found["accuracy.hindered_settling.exponent.outside"] = Found(n - min(max(n, LAWS[0]), LAWS[1]), keys)
    return found
