"""A ball falls on a plate under oil: the coefficient of restitution against the Stokes number.

Reference: the wet over the dry coefficient of restitution follows exp(-35 / St*), St* = (rho_p + rho_f / 2) d U / (9 mu),
for solid spheres and drops (D. Legendre, C. Daniel, P. Guiraud, Phys. Fluids 17 (2005) 097105), with the measurements of
G. Joseph, R. Zenit, M. Hunt, A. Rosenwinkel, J. Fluid Mech. 433 (2001) 329 and P. Gondret, M. Lance, L. Petit, Phys. Fluids 14
(2002) 643 scattered about it by some 0.1 (reference/04_wet_rebound.toml). Oils and steel balls are those of Gondret et
al. Both velocities are those at a gap of 0.2 diameters, on the way down and up; U in St* is the former. Where the experiments take
theirs is not known: at 0.1 diameters, where the film still holds the ball that leaves, differences are twice as large (17.8 for 8.3 at
Stokes number 50 with 10 cells, 10.9 for 5.3 at 90 with 15). The figure is found less reference, times 100.

The film stops growing at 1e-3 radii, the program's default. On the way down steel gives way to its pressure at 1e-4 radii or two
(R. Davis, J.-M. Serayssol, E. Hinch, J. Fluid Mech. 163 (1986) 479), on the way up oil cannot pull by more than the pressure of the air
p: below sqrt(3 mu R v / p), 1e-2 radii, it hardly holds the ball. What a film takes goes with the logarithm of the gap, so one
resistance for both ways has the geometric mean, 1e-3. E. Biegert, B. Vowinckel, E. Meiburg, J. Comput. Phys. 340 (2017) 105, fit 3e-3
to the trajectory at St 27; a test of waLBerla has 5e-4.

Trajectories: heights of the gap and times after the first contact at which the ball turns between bounces, read off Gondret et
al.'s figures at Stokes numbers 27 and 152. The ball starts 3 diameters over the plate, so much faster than in the experiment that it
has the experiment's speed one diameter over the plate, after it has set the fluid at rest going: `impact` is by how much it differs there.
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
BATH = (4, 4, 6), 4.5      # its size, and the ball's lowest point over the plate at the start, diameters
GAP = 0.2                  # at which the velocities are taken, diameters
LATTICE_VELOCITY = 0.05    # of free fall
SCATTER = 10

# named by Gondret's Stokes number: as BALLS; speed of impact, m/s; of the start over that; heights in mm, times in s
TRAJECTORIES = {"st27": ((STEEL, 0.006, 965, 0.100), 0.518, 1.25, [(1.972, 0.0192)]),
                "st152": ((STEEL, 0.003, 935, 0.010), 0.586, 1.10, [(7.466, 0.040), (2.234, 0.106), (0.520, 0.140), (0.096, 0.156)])}
TRAJECTORY_BATH = (6, 6, 8), 3
HEIGHT_LIMIT, TIME_LIMIT = 10, 10   # percent

GOALS = [Goal(f"accuracy.wet_rebound.{name}.d{D}.difference", SCATTER) for name in BALLS for D in SIZES]
GOALS += [Goal(f"accuracy.wet_rebound.{name}.d{D}.apex{n}.{what}", limit) for name, (*_, apexes) in TRAJECTORIES.items() for D in SIZES
          for n in range(1, min(len(apexes), 2) + 1) for what, limit in (("height", HEIGHT_LIMIT), ("time", TIME_LIMIT))]
SHORT_GOALS = [Goal("accuracy.wet_rebound.st90.d15.difference", SCATTER), Goal("accuracy.wet_rebound.st152.d10.short.apex1.height", 15),
               Goal("accuracy.wet_rebound.st152.d10.short.apex1.time", 5)]
GONDRET = dict(source="Gondret, Lance, Petit, Phys. Fluids 14 (2002) 643, trajectories, as digitised in a test of PARTIES",
               doi="10.1063/1.1427920", kind="experiment")
CLAIMS = {}
for ball, (*_, apexes) in TRAJECTORIES.items():
    for n, (height, time) in enumerate(apexes, 1):
        for form in ("{D}", "{D}.short"):
            for what, value in (("height over the plate in mm", height), ("time after the first contact in s", time)):
                CLAIMS[f"accuracy.wet_rebound.{ball}.d{form}.apex{n}.{what.split()[0]}"] = Claim(
                    f"{what} of the top after bounce {n}", f"ball on a plate under oil, {ball}", "D = {D}", **GONDRET, expected=value,
                    uncertainty="10 points of restitution")
CLAIMS |= {
    "accuracy.wet_rebound.{ball}.d{D}.difference": Claim(
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


def case_of(ball, D, fall, first, bath, duration):
    """Returns the case of a ball that falls from `start` diameters at `first`; `duration` is in steps, fall in m/s: LATTICE_VELOCITY."""
    density_of_ball, diameter, density, mu = ball
    cell = diameter / D
    box, start = bath
    size = [n * diameter for n in box]
    return case_text(
        f"A ball of {1000 * diameter:g} mm and {density_of_ball:g} kg/m3 falls on a plate under oil", si(cell, LATTICE_VELOCITY * cell / fall),
        domain=dict(size=size, boundary=dict(x="periodic", y="periodic", z="no-slip")),
        fluid=dict(density=density, kinematic_viscosity=mu / density), gravity=dict(acceleration=[0, 0, -9.81]),
        contacts=dict(restitution=0.97, substeps=10),
        shapes=[sphere(diameter, "ball")],
        bodies=[dict(shape="ball", density=density_of_ball, velocity=[0, 0, -first],
                     position=[size[0] / 2 + 0.31 * cell, size[1] / 2 + 0.17 * cell, (start + 0.5) * diameter])],
        run=dict(steps=duration), output=dict(bodies=dict(every=1)))


def run_of(name, D):
    fall = terminal_velocity(*BALLS[name])
    text = case_of(BALLS[name], D, fall, 0.9 * fall, BATH, round(1.35 * BATH[1] * D / LATTICE_VELOCITY))
    return Run(f"{name}.d{D}", text, dict(ball=name, D=D))


def trajectory_of(name, D, tops=None):
    """Returns the run of a trajectory, to the first `tops` tops."""
    ball, impact, faster, apexes = TRAJECTORIES[name]
    apexes = apexes[:tops]
    duration = 1.1 * TRAJECTORY_BATH[1] * ball[1] / impact + 1.15 * apexes[-1][1]
    text = case_of(ball, D, impact, faster * impact, TRAJECTORY_BATH, round(duration * impact * D / (LATTICE_VELOCITY * ball[1])))
    return Run(f"{name}.d{D}" + (".short" if tops else ""), text, dict(ball=name, D=D))


def runs(level):
    if level == "short":
        return [run_of("st90", 15), trajectory_of("st152", 10, 1)]
    return [run_of(name, D) for name in BALLS for D in SIZES] + [trajectory_of(name, D) for name in TRAJECTORIES for D in SIZES]


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


def turns(time, gap, number):
    """Returns heights and times after the first contact of the first `number` tops between bounces; fewer where it ends before."""
    lowest = [k for k in range(1, len(gap) - 1) if gap[k - 1] > gap[k] <= gap[k + 1] and gap[k] < GAP]
    tops = [first + int(np.argmax(gap[first:last])) for first, last in zip(lowest, [*lowest[1:], len(gap)])]
    tops = [k for k in tops if k < len(gap) - 1][:number]
    return [(gap[k], time[k] - time[lowest[0]]) for k in tops]


def measure(run, outcome):
    name = run.settings["ball"]
    height, velocity = (outcome.bodies.array(quantity)[:, 0, 2] for quantity in ("position", "velocity"))
    if name in TRAJECTORIES:
        ball, impact, _, apexes = TRAJECTORIES[name]
        gap = height / ball[1] - 0.5
        found = dict(impact=100 * (-velocity[np.argmax(gap < 1)] / impact - 1))
        for n, ((high, when), (exact, then)) in enumerate(zip(turns(outcome.bodies.time, gap, len(apexes)), apexes), 1):
            found.update({f"apex{n}.height": 100 * (1000 * high * ball[1] / exact - 1), f"apex{n}.time": 100 * (when / then - 1)})
        return found
    ball, diameter, density, mu = BALLS[name]
    before, after = rebound(height / diameter - 0.5, velocity)
    stokes = (ball + density / 2) * diameter * before / (9 * mu)
    restitution = after / before / DRY
    return dict(stokes=stokes, restitution=restitution, error=100 * (restitution - law(stokes)))


def figures(measured):
    names = dict(error="difference", stokes="stokes", restitution="restitution", impact="impact")
    return {f"accuracy.wet_rebound.{key}.{names.get(name, name)}": Found(value, (key,)) for key, m in measured.items()
            for name, value in m.items() if name in names or name.startswith("apex")}


def curves(measured):
    return [Curve(f"{name}", [(m["core_seconds"], m["error"], key) for key, m in measured.items() if key.startswith(f"{name}.")])
            for name in BALLS]
