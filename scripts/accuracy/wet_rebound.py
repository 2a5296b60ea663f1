"""A ball falls on a plate under oil: the coefficient of restitution against the Stokes number.

Reference: the wet over the dry coefficient of restitution follows exp(-35 / St*), St* = (rho_p + rho_f / 2) d U / (9 mu),
for solid spheres and drops (D. Legendre, C. Daniel, P. Guiraud, Phys. Fluids 17 (2005) 097105), with the measurements of
G. Joseph, R. Zenit, M. Hunt, A. Rosenwinkel, J. Fluid Mech. 433 (2001) 329 and P. Gondret, M. Lance, L. Petit, Phys. Fluids 14
(2002) 643 scattered about it by some 0.1 (reference/04_wet_rebound.toml). Oils and steel balls are those of Gondret et
al. Both velocities are those at a gap of 0.1 diameters, on the way down and up; U in St* is the former. The film
stops growing at 1e-4 radii: a steel ball's surface gives way there to the pressure (R. Davis, J.-M. Serayssol, E. Hinch, J. Fluid
Mech. 163 (1986) 479: 0.2 micrometres at 2 mm and 0.5 m/s in the thickest oil). The figure is found less reference, times 100.
"""
import math

import numpy as np
from case_text import case_text, si, sphere
from problem import Claim, Curve, Found, Goal, Run

GRAVITY, DRY = 9.81, 0.97
STEEL, CARBIDE = 7800.0, 14800.0  # kg/m3; tungsten carbide: a high Stokes number at a Reynolds number the lattice can resolve
# named by St*: density of the ball kg/m3, its diameter m, density of the oil kg/m3, its viscosity Pa s
BALLS = {"st50": (STEEL, 0.003, 953, 0.020), "st90": (STEEL, 0.004, 953, 0.020), "st130": (STEEL, 0.003, 935, 0.010),
         "st160": (CARBIDE, 0.003, 953, 0.020), "st275": (CARBIDE, 0.004, 953, 0.020)}
SIZES = (10, 15)           # cells across the ball
BOX = (4, 4, 6)            # diameters
START = 4.5                # of the ball's lowest point over the plate, diameters
GAP = 0.1                  # at which the velocities are taken, diameters
LATTICE_VELOCITY = 0.05    # of free fall
SCATTER = 10

GOALS = [Goal(f"accuracy.wet_rebound.{name}.d{D}.difference", SCATTER) for name in BALLS for D in SIZES]
SHORT_GOALS = [Goal("accuracy.wet_rebound.st90.d15.difference", SCATTER)]
CLAIMS = {"accuracy.wet_rebound.{ball}.d{D}.difference": Claim(
    "restitution, wet over dry, times 100", "ball on a plate under oil, {ball}", "D = {D}",
    "exp(-35 / St*): Legendre, Daniel, Guiraud, Phys. Fluids 17 (2005) 097105; Joseph et al. (2001), Gondret et al. (2002)",
    doi="10.1017/S0022112001003470", kind="experiment", uncertainty="10 points", unit="points",
    note="a bounce depends on the place in the lattice by 4 points, and measurements scatter about the law by 10")}


def terminal_velocity(ball, diameter, density, mu):
    """Returns the drag after Schiller and Naumann."""
    v = 0.1
    for _ in range(200):
        reynolds = density * v * diameter / mu
        v = 0.5 * (v + (ball - density) * GRAVITY * diameter**2 / (18 * mu * (1 + 0.15 * reynolds**0.687)))
    return v


def run_of(name, D):
    ball, diameter, density, mu = BALLS[name]
    fall, cell = terminal_velocity(ball, diameter, density, mu), diameter / D
    step = LATTICE_VELOCITY * cell / fall
    size = [n * diameter for n in BOX]
    text = case_text(
        f"A ball of {1000 * diameter:g} mm and {ball:g} kg/m3 falls on a plate under oil", si(cell, step),
        domain=dict(size=size, boundary=dict(x="periodic", y="periodic", z="no-slip")),
        fluid=dict(density=density, kinematic_viscosity=mu / density), gravity=dict(acceleration=[0, 0, -9.81]),
        coupling=dict(lubrication_min_gap=1e-4 * diameter / 2), contacts=dict(restitution=0.97, substeps=10),
        shapes=[sphere(diameter, "ball")],
        bodies=[dict(shape="ball", density=ball, velocity=[0, 0, -0.9 * fall],
                     position=[size[0] / 2 + 0.31 * cell, size[1] / 2 + 0.17 * cell, (START + 0.5) * diameter])],
        run=dict(steps=round(1.35 * START * D / LATTICE_VELOCITY)), output=dict(bodies=dict(every=1)))
    return Run(f"{name}.d{D}", text, dict(ball=name, D=D))


def runs(level):
    return [run_of("st90", 15)] if level == "short" else [run_of(name, D) for name in BALLS for D in SIZES]


def rebound(gap, velocity):
    """Returns speeds at GAP before and after the lowest point (0: it does not come back), by linear interpolation."""
    lowest = int(np.argmin(gap))
    down = int(np.nonzero(gap[:lowest] > GAP)[0][-1])
    up = np.nonzero(gap[lowest:] > GAP)[0]

    def at(k):
        share = (GAP - gap[k]) / (gap[k + 1] - gap[k])
        return velocity[k] + share * (velocity[k + 1] - velocity[k])
    return -at(down), at(lowest + int(up[0]) - 1) if len(up) else 0.0


def law(stokes):
    return math.exp(-35 / stokes)


def measure(run, outcome):
    ball, diameter, density, mu = BALLS[run.settings["ball"]]
    height, velocity = (outcome.bodies.array(name)[:, 0, 2] for name in ("position", "velocity"))
    before, after = rebound(height / diameter - 0.5, velocity)
    stokes = (ball + density / 2) * diameter * before / (9 * mu)
    restitution = after / before / DRY
    return dict(stokes=stokes, restitution=restitution, error=100 * (restitution - law(stokes)))


def figures(measured):
    found = {}
    for key, m in measured.items():
        found[f"accuracy.wet_rebound.{key}.difference"] = Found(m["error"], (key,))
        found[f"accuracy.wet_rebound.{key}.stokes"] = Found(m["stokes"], (key,))
        found[f"accuracy.wet_rebound.{key}.restitution"] = Found(m["restitution"], (key,))
    return found


def curves(measured):
    return [Curve(f"{name}", [(m["core_seconds"], m["error"], key) for key, m in measured.items() if key.startswith(name)])
            for name in BALLS]
