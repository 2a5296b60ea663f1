"""Spheres, discs, needles and stars, from light to heavy and from thick fluid to thin, that settle in a periodic box: stability and velocity.

Each has the volume of a sphere of D cells: a disc 1.46 D across and 0.31 D thick, broadside; a spheroid needle 2.08 D long, along its
axis; a star of three crossing capsules, 1.76 D from tip to tip. Gravity pulls the body along x, a force on the fluid balances it, so the
drag is known, whatever the ratio of densities (which of the two moves, too, depends on it: velocities are those of the body less the mean
of the box). The Reynolds number is of order 1. Reference: the same body at D = 20, tau = 0.7; errors are of the drag coefficient.
"""
import math

import numpy as np
from case_text import case_text, cube
from problem import Claim, Found, Goal, Run

DIAMETERS = (4, 6, 10)
FINEST = 20
RATIOS = (0.02, 0.3, 1.2, 8, 1000)                         # density of body over fluid
RELAXATION_TIMES = (0.505, 0.52, 0.7, 2)
REYNOLDS = 1                                               # were the body a sphere alone
BOX = 3                                                    # diameters
SAMPLES = 20

STAR_RADIUS = 0.2                                          # of a capsule, diameters
# The line between a capsule's ends is so long that the star has the volume of the sphere: that of three capsules less what pairs of
# their cylinders share, 16/3 r^3 each, plus what all three do, 8 (2 - sqrt(2)) r^3.
STAR_LENGTH = (math.pi / 6 + (16 - 4 * math.pi - 8 * (2 - math.sqrt(2))) * STAR_RADIUS**3) / (3 * math.pi * STAR_RADIUS**2)


def disc(d):
    return dict(type="cylinder", diameter=1.46 * d, length=0.3128 * d)


def needle(d):
    return dict(type="ellipsoid", diameters=[3**(2 / 3) * d, 3**(-1 / 3) * d, 3**(-1 / 3) * d])


def star(d):
    arm = dict(type="capsule", radius=STAR_RADIUS * d, length=STAR_LENGTH * d)
    half = math.sqrt(0.5)
    return dict(type="compound", parts=[dict(arm), dict(arm, orientation=[half, 0, half, 0]), dict(arm, orientation=[half, half, 0, 0])])


# shape and orientation
SHAPES = {"sphere": (lambda d: dict(type="sphere", diameter=d), [1, 0, 0, 0]),
          "disc": (disc, [math.sqrt(0.5), 0, math.sqrt(0.5), 0]),
          "needle": (needle, [1, 0, 0, 0]),
          "star": (star, [1, 0, 0, 0])}

GOALS = [Goal(f"accuracy.free_bodies.{s}.d{d}.worst", 2) for s in SHAPES for d in DIAMETERS]
SHORT_GOALS = [Goal("accuracy.free_bodies.sphere.d6.worst", 2)]
CLAIMS = {"accuracy.free_bodies.{shape}.d{D}.worst": Claim(
    "drag coefficient, worst of 0.02 to 1000 times the fluid's density, τ of 0.505 to 2", "{shape} settles in a periodic box, Re = 1", "D = {D}",
    "own run with D = 20, τ = 0.7", kind="convergence",
    note="4 cells are too few (a body needs 6), and the arms of a star are 0.4 D thick, so 2.4 cells at D = 6")}


def key_of(shape, d, ratio, tau):
    return f"{shape}.d{d}.rho{ratio:g}.tau{tau:g}"


def run_of(shape, d, ratio, tau):
    make, orientation = SHAPES[shape]
    viscosity = (tau - 0.5) / 3
    velocity = REYNOLDS * viscosity / d
    box, volume = BOX * d, math.pi / 6 * d**3
    phi = volume / box**3
    resistance = 3 * math.pi * viscosity * d
    pull = resistance * velocity
    share = ratio * (1 - phi) / (ratio * phi + 1 - phi)    # of the body's mass, that the pair of body and fluid has
    response = max((share + 0.5) * volume / resistance, box**2 / (4 * math.pi**2 * viscosity))
    every = math.ceil(max(2 / velocity, 400) / SAMPLES)
    start = math.ceil((6 * response + 200) / every) * every
    steps = start + SAMPLES * every
    text = case_text(
        f"{shape}, D = {d}, density ratio {ratio}, relaxation time {tau}", domain=cube(box),
        fluid=dict(relaxation_time=tau, body_force=[-pull / (box**3 - volume), 0, 0]),
        gravity=dict(acceleration=[pull / ((ratio - 1) * volume), 0, 0]), shapes=[dict(name="body", **make(d))],
        bodies=[dict(shape="body", density=ratio, position=[0.5 * box + 0.13, 0.5 * box + 0.31, 0.5 * box + 0.47], orientation=orientation)],
        run=dict(steps=steps), output=dict(bodies=dict(every=every), fields=dict(every=steps, quantities=["velocity"])))
    return Run(key_of(shape, d, ratio, tau), text,
               dict(shape=shape, d=d, ratio=ratio, tau=tau, velocity=velocity, start=start))


def runs(level):
    if level == "short":
        return [run_of("sphere", 12, 1.2, 0.7), run_of("sphere", 6, 0.02, 0.52), run_of("sphere", 6, 1000, 0.52)]
    finest = [run_of(shape, FINEST, 1.2, 0.7) for shape in SHAPES]
    return finest + [run_of(s, d, r, t) for s in SHAPES for d in DIAMETERS for r in RATIOS for t in RELAXATION_TIMES]


def measure(run, outcome):
    bodies = outcome.bodies
    displacement = bodies.unwrapped()[:, 0, 0]
    settled = bodies.step >= run.settings["start"]
    time, displacement = bodies.step[settled], displacement[settled]
    velocity = (displacement[-1] - displacement[0]) / (time[-1] - time[0]) - outcome.mean_velocity()[0]
    along = bodies.array("velocity")[settled, 0, 0]
    turned = np.abs(bodies.array("angular_velocity")[:, 0]).max() * run.settings["d"]
    scale = 1 / run.settings["velocity"]
    return dict(drag=1 / (scale * velocity), spread=100 * scale * (along.max() - along.min()) / 2, turning=100 * scale * turned)


def figures(measured):
    found = {}
    for shape in SHAPES:
        finest = next((key for key in measured if key.startswith(f"{shape}.") and key.split(".")[1] in (f"d{FINEST}", "d12")), None)
        if not finest:
            continue
        for d in DIAMETERS:
            errors = {key: 100 * (m["drag"] / measured[finest]["drag"] - 1) for key, m in measured.items() if key.startswith(f"{shape}.d{d}.")}
            for key, error in errors.items():
                found[f"accuracy.free_bodies.{key}.error"] = Found(error, (key, finest))
            if errors:
                found[f"accuracy.free_bodies.{shape}.d{d}.worst"] = Found(max(errors.values(), key=abs), tuple(errors))
    return found
