"""Two spheres one above the other: the upper one drafts, they kiss, they tumble.

Reference: the phases in their order, as in R. Glowinski, T. W. Pan, T. I. Hesla, D. D. Joseph, J. Periaux, J. Comput. Phys. 169
(2001) 363, and W.-P. Breugem, J. Comput. Phys. 231 (2012) 4469: spheres of 1/6 cm and 1.14 g/cm3 in a closed box of
1 x 1 x 4 cm of a fluid of 1 g/cm3 and 0.01 cm2/s (reference/08_hindered_settling_dkt.toml), two diameters apart at the
start. After the first contact the motion is chaotic, so only what comes before is compared in numbers, and with our own
finer run: the start differs from paper to paper.
"""
import numpy as np
from case_text import case_text, si, sphere
from problem import Claim, Found, Goal, Run

DIAMETER = 1 / 600                     # m
BOX = (0.01, 0.01, 0.04)               # m
HEIGHTS = (0.035, 0.035 - 2 / 600)     # m, of the upper and the lower sphere
OFFSET = 0.02                          # diameters, sideways: what decides where they tumble
COARSE, FINE = 9, 12                   # cells across a sphere
TIME = 0.65                            # s
FASTEST = 0.11                         # m/s; 0.08 cells a step
TOUCHING = 0.05                        # diameters between the surfaces: kissing

GOALS = [Goal("accuracy.dkt.kissing", 5.0), Goal("accuracy.dkt.order", 1, low=1)]
PAPERS = "Glowinski, Pan, Hesla, Joseph, Periaux, J. Comput. Phys. 169 (2001) 363; Breugem, J. Comput. Phys. 231 (2012) 4469"
CLAIMS = {
    "accuracy.dkt.kissing": Claim("time of kissing", "two spheres settle one above the other", "D = 9", "own run with D = 12", kind="convergence"),
    "accuracy.dkt.order": Claim("1 if they draft, kiss and tumble in this order", "two spheres settle one above the other", "D = 9 and 12",
                                PAPERS, doi="10.1006/jcph.2000.6542", kind="computation", unit="")}


def run_of(cells):
    cell = DIAMETER / cells
    time_step = 0.08 * cell / FASTEST
    middle = BOX[0] / 2 + 0.13 * cell
    text = case_text(
        f"drafting, kissing, tumbling, {cells} cells across", si(cell, time_step), domain=dict(size=BOX, boundary="no-slip"),
        fluid=dict(density=1000, kinematic_viscosity=1e-6), gravity=dict(acceleration=[0, 0, -9.81]),
        contacts=dict(restitution=0.9), shapes=[sphere(DIAMETER)],
        bodies=[dict(shape="sphere", density=1140,
                     positions=[[middle + OFFSET * DIAMETER, middle, HEIGHTS[0]], [middle, middle, HEIGHTS[1]]])],
        run=dict(time=TIME), output=dict(bodies=dict(every=round(1e-3 / time_step))))
    return Run(f"d{cells}", text, dict(D=cells))


def runs(level):
    return [run_of(cells) for cells in (COARSE, FINE)] if level == "full" else []


def first(time, holds):
    """Returns the first time at which something holds; the end of the run if never."""
    return time[np.argmax(holds)] if holds.any() else TIME


def measure(run, outcome):
    """Times in s: the upper sphere 5 % faster than the lower one, contact, line of centres at 45 degrees; the largest ratio
    of velocities before contact."""
    bodies = outcome.bodies
    x, speed = bodies.array("position"), -bodies.array("velocity")[..., 2]
    apart = x[:, 0] - x[:, 1]
    distance = np.linalg.norm(apart, axis=1)
    kissing = first(bodies.time, distance < (1 + TOUCHING) * DIAMETER)
    tumbling = first(bodies.time, apart[:, 2] < np.sqrt(0.5) * distance)
    moving = (speed[:, 1] > 0.01) & (bodies.time < kissing)
    ratio = np.where(moving, speed[:, 0] / np.where(moving, speed[:, 1], 1), 0)
    return dict(drafting=first(bodies.time, ratio > 1.05), kissing=kissing, tumbling=tumbling, ratio=ratio.max(),
                fastest=speed.max(), reynolds=speed.max() * DIAMETER / 1e-6)


def figures(measured):
    found = {}
    for key, m in measured.items():
        for name in ("drafting", "kissing", "tumbling"):
            found[f"accuracy.dkt.{key}.{name}.seconds"] = Found(m[name], (key,))
    keys = (f"d{COARSE}", f"d{FINE}")
    if all(key in measured for key in keys):
        coarse, fine = (measured[key] for key in keys)
        found["accuracy.dkt.kissing"] = Found(100 * (coarse["kissing"] / fine["kissing"] - 1), keys)
        in_order = all(m["drafting"] < m["kissing"] < m["tumbling"] < TIME for m in (coarse, fine))
        found["accuracy.dkt.order"] = Found(float(in_order), keys)
    return found
