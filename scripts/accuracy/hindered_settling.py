"""Many spheres that settle in a periodic box: how much slower than one alone, by Richardson and Zaki's exponent.

Reference: w / w0 = k (1 - phi)^n; at Reynolds number 1 (of one sphere alone) n is 4.35 by J. F. Richardson, W. N. Zaki (1954)
and 4.88 by J. Garside, M. R. Al-Dibouni (1977) (reference/08_hindered_settling_dkt.toml): the figure is how far n lies
outside these two. k < 1 in dilute suspensions, here as found. The mean velocity of N spheres in a periodic box is lower
than in a large suspension by 1.7601 (phi / N)^(1/3) S mu / mu_eff (A. J. C. Ladd, J. Chem. Phys. 93 (1990) 3484; G. Mo,
A. S. Sangani, Phys. Fluids 6 (1994) 1637; S: structure factor of hard spheres after Carnahan and Starling), which is added.
w0 is after Schiller and Naumann; it does not act on n.

Column: clouds of N spheres in a closed column 6 x 6 x 24 diameters, released from rest 9 to 23.6 diameters over its floor; Galileo
number 79.7, density ratio 1.14, no friction (the fluid of drafting_kissing_tumbling.py; one sphere alone has Re = 86). Velocity: mean
over all spheres, between the times in which one sphere alone would fall 6.1 and 10.2 diameters, over that of one alone in the same
column, released 22.1 diameters over the floor. Reference: FeatFloWer (fictitious boundary method, finite elements, 8 cells across),
hindered settling D3.2, means of three seeds. What fills the column settles against the return flow of its walls: the exponent is
4.3 to 4.6, where Richardson and Zaki have 2.7 to 3.0 for this Reynolds number.
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

COLUMN = (6, 6, 24)                         # diameters
CLOUD, LONE_HEIGHT = (9, 23.6), 22.1        # diameters over the floor
GALILEO, COLUMN_RATIO, LONE_REYNOLDS, COLUMN_VELOCITY = 79.7, 1.14, 86.5, 0.05  # the last in cells a step, about that of one alone
WINDOW = (6.1, 10.2)                        # diameters one alone falls at that velocity
CLOUDS = {20: (0.020, 0.89), 40: (0.042, 0.83), 80: (0.078, 0.69), 120: (0.11, 0.59)}  # spheres: phi of the cloud, velocity
SEEDS = {8: (1, 2, 3), 12: (1,)}            # by cells across

GOALS = [Goal("accuracy.hindered_settling.exponent.outside", 0.3),
         *(Goal(f"accuracy.hindered_settling.column.d{D}.n{n}.velocity", 10) for D in SEEDS for n in CLOUDS)]
SHORT_GOALS = [Goal("accuracy.hindered_settling.column.d8.n40.velocity", 15)]
CLAIMS = {
    "accuracy.hindered_settling.column.d{D}.n{N}.velocity": Claim(
        "velocity over that of one alone", "{N} spheres settle in a closed column 6 diameters wide, Re = 51 to 77", "D = {D}",
        "FeatFloWer, fictitious boundary method, dns_practitioners_guide.md, D3.2", kind="computation",
        expected=lambda D, N: CLOUDS[int(N)][1], uncertainty="2 to 5 %: positions at the start"),
    "accuracy.hindered_settling.exponent.outside": Claim(
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


def column_run(D, count, seed=1):
    """Returns the run of a cloud, or of one sphere alone."""
    viscosity = COLUMN_VELOCITY * D / LONE_REYNOLDS
    gravity = (GALILEO * viscosity / D)**2 / ((COLUMN_RATIO - 1) * D)
    every = round(D / COLUMN_VELOCITY / 20)
    size = [n * D for n in COLUMN]
    corners = [[0, 0, CLOUD[0] * D], [size[0], size[1], CLOUD[1] * D]]
    spheres = (dict(fill=[dict(shape="sphere", density=COLUMN_RATIO, count=count, gap=0.05 * D, seed=seed, box=corners)]) if count > 1 else
               dict(bodies=[dict(shape="sphere", density=COLUMN_RATIO, position=[size[0] / 2 + 0.13, size[1] / 2 + 0.29, LONE_HEIGHT * D])]))
    text = case_text(
        f"{count} spheres settle in a column, {D} cells across", domain=dict(size=size, boundary="no-slip"),
        fluid=dict(kinematic_viscosity=viscosity, quiet_start=True), gravity=dict(acceleration=[0, 0, -gravity]), shapes=[sphere(D)],
        **spheres, run=dict(steps=round(WINDOW[1] * D / COLUMN_VELOCITY)), output=dict(bodies=dict(every=every)))
    key = f"column.d{D}.n{count}.seed{seed}" if count > 1 else f"column.d{D}.alone"
    return Run(key, text, dict(D=D, count=count, seed=seed))


def runs(level):
    if level == "short":
        return [column_run(8, 1), column_run(8, 40)]
    column = [column_run(D, count, seed) for D, seeds in SEEDS.items() for count in CLOUDS for seed in seeds]
    return [run_of(count) for count in COUNTS] + [column_run(D, 1) for D in SEEDS] + column


def measure(run, outcome):
    """Velocity over that of one alone, against the mean of the box: from the way, so from all steps. In a column in cells a step."""
    bodies = outcome.bodies
    if "D" in run.settings:
        fallen = bodies.step * COLUMN_VELOCITY / run.settings["D"]
        window = (fallen >= WINDOW[0]) & (fallen <= WINDOW[1])
        z = bodies.array("position")[window, :, 2]
        extent = z.max(1) - z.min(1) + run.settings["D"]
        phi = len(z[0]) * math.pi / 6 * run.settings["D"]**3 / (COLUMN[0] * COLUMN[1] * run.settings["D"]**2 * extent)
        return dict(velocity=-bodies.array("velocity")[window, :, 2].mean(), phi=phi.mean(), lowest=z.min() / run.settings["D"])
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
    for D in SEEDS:
        alone = f"column.d{D}.alone"
        for count, (_, velocity) in CLOUDS.items():
            keys = [key for seed in SEEDS[D] if (key := f"column.d{D}.n{count}.seed{seed}") in measured]
            if keys and alone in measured:
                ratios = [measured[key]["velocity"] / measured[alone]["velocity"] for key in keys]
                name = f"accuracy.hindered_settling.column.d{D}.n{count}"
                found[f"{name}.velocity"] = Found(100 * (np.mean(ratios) / velocity - 1), (alone, *keys))
                found[f"{name}.spread"] = Found(100 * (max(ratios) - min(ratios)) / velocity, (alone, *keys))
                found[f"{name}.phi"] = Found(np.mean([measured[key]["phi"] for key in keys]), tuple(keys))
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
