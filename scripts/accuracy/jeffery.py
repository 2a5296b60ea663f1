"""Spheroids that turn in a shear flow: the period of Jeffery's orbit.

Reference: G. B. Jeffery, Proc. R. Soc. A 102 (1922) 161: T = 2 pi (r + 1/r) / G for a spheroid of aspect ratio r whose axis
turns in the shear plane, without inertia and walls (reference/05_jeffery_orbits.toml). Two plates move against each other;
along them the box is periodic. What is measured is half a turn, once the shear flow has come about, at two Reynolds
numbers G a^2 / nu (a: the longer half axis), and drawn out to none.
"""
import math

import numpy as np
from case_text import case_text
from problem import Claim, Found, Goal, Run

MINOR, COARSE = 8, 4                        # cells, the shorter axis; in the short run
SHAPES = {"prolate": 2.0, "oblate": 0.5}    # along the axis over across
BOX = (8, 9, 6)                             # shorter axes: along the flow, between the plates, along the vorticity
REYNOLDS = (0.4, 0.2)
RELAXATION_TIME = 2.0
SAMPLES = 400

GOALS = [Goal(f"accuracy.jeffery.{shape}.error", 1.5) for shape in SHAPES]
# found -1.66 with 4 cells at Reynolds number 0.2, and 0.00 with 8
SHORT_GOALS = [Goal(f"accuracy.jeffery.prolate.d{COARSE}.re{REYNOLDS[1]:g}.error", 2.5)]
JEFFERY = dict(source="Jeffery, Proc. R. Soc. A 102 (1922) 161", doi="10.1098/rspa.1922.0078")
CLAIMS = {
    "accuracy.jeffery.{shape}.error": Claim("period of the orbit, drawn out to Re = 0", "{shape} spheroid in shear", "8 cells across", **JEFFERY),
    "accuracy.jeffery.{shape}.d{D}.re{Re}.error": Claim("period of the orbit", "{shape} spheroid in shear, Re = {Re}", "{D} cells across", **JEFFERY)}


def shear_rate(reynolds, minor):
    return reynolds * (RELAXATION_TIME - 0.5) / 3 / minor**2


def half_turn(ratio, rate):
    """Returns the period in steps, by Jeffery's theory."""
    return math.pi * (ratio + 1 / ratio) / rate


def run_of(shape, reynolds, minor):
    ratio, rate = SHAPES[shape], shear_rate(reynolds, minor)
    box = [minor * n for n in BOX]
    start = int(3 * box[1]**2 / (math.pi**2 * (RELAXATION_TIME - 0.5) / 3))  # the slowest part of the start is down to e^-3
    steps = start + int(1.1 * half_turn(ratio, rate))
    every = max(1, steps // SAMPLES)
    wall = rate * box[1] / 2
    long = 2 * minor
    text = case_text(
        f"Jeffery's orbit, aspect ratio {ratio}, Reynolds number {reynolds}",
        domain=dict(size=box, boundary=dict(x="periodic", z="periodic", y=[dict(type="moving", velocity=[-wall, 0, 0]),
                                                                         dict(type="moving", velocity=[wall, 0, 0])])),
        fluid=dict(relaxation_time=RELAXATION_TIME),
        shapes=[dict(name="spheroid", type="ellipsoid",
                     diameters=[minor, minor, long] if ratio > 1 else [long, long, minor])],
        bodies=[dict(shape="spheroid", density=1, position=[box[0] / 2 + 0.17, box[1] / 2, box[2] / 2 + 0.29],
                     orientation=[math.sin(0.3), math.cos(0.3), 0])],
        run=dict(steps=steps), output=dict(bodies=dict(every=every)))
    return Run(f"{shape}.d{minor}.re{reynolds:g}", text, dict(shape=shape, D=minor, Re=reynolds, start=start))


def runs(level):
    if level == "short":
        return [run_of("prolate", REYNOLDS[1], COARSE)]
    return [run_of(shape, re, MINOR) for shape in SHAPES for re in REYNOLDS]


def axis_angle(orientation):
    """Returns the angle of the body's z axis in the shear plane, from the gradient towards the flow; continuous in time."""
    w, x, y, z = orientation.T
    return np.unwrap(np.arctan2(2 * (x * z + w * y), 2 * (y * z - w * x)))


def measure(run, outcome):
    bodies = outcome.bodies
    step, angle = bodies.step, axis_angle(bodies.array("orientation")[:, 0])
    settled = step >= run.settings["start"]
    step, angle = step[settled], angle[settled]
    time = np.interp(angle[0] + math.pi, angle, step) - step[0]
    if angle[-1] < angle[0] + math.pi:
        raise ValueError(f"turned only by {angle[-1] - angle[0]:.3f} of pi")
    theory = half_turn(SHAPES[run.settings["shape"]], shear_rate(run.settings["Re"], run.settings["D"]))
    return dict(error=100 * (time / theory - 1))


def figures(measured):
    found = {f"accuracy.jeffery.{key}.error": Found(m["error"], (key,)) for key, m in measured.items()}
    for shape in SHAPES:
        keys = tuple(f"{shape}.d{MINOR}.re{re:g}" for re in REYNOLDS)
        if all(key in measured for key in keys):
            high, low = (measured[key]["error"] for key in keys)
            found[f"accuracy.jeffery.{shape}.error"] = Found(
                low + (low - high) * REYNOLDS[1] / (REYNOLDS[0] - REYNOLDS[1]), keys)
    return found
