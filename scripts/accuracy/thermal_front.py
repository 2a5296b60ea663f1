"""A front of temperature that a uniform stream carries: the diffusivity that it spreads with, against the given one.

Fluid of temperature 1 comes in where there was 0, at u cells a step along x. The front dT/dx has the mean place u t and the variance
2 D t, so what the variance grows by between two times gives the diffusivity, whatever the front's shape is: the error of the second
order in u alone, without those of waves of finite length. Without a correction it is -4 u^2, -4 % at 0.1. "oblique" goes
along (1, 0.6, 0.35). wiggle: the largest over- or undershoot of the temperature, in percent. Cell Peclet number: |u| / D.
"""
import itertools

import numpy as np
import silt_results
from case_text import case_text
from problem import Claim, Found, Goal, Run

SPEEDS, PECLETS = (0.02, 0.05, 0.1), (0.5, 1, 2, 5, 10)
WAYS = {"axis": (1, 0, 0), "oblique": (1, 0.6, 0.35)}
FIRST, LAST, LENGTH = 96, 160, 304  # cells: where the front is at the two times; of the domain
WIDTH = 4
ERROR, WIGGLE = (f"accuracy.thermal_front.u{{u}}.pe{{Pe}}.{{way}}.{name}" for name in ("error", "wiggle"))

GOALS = [Goal(ERROR.format(u=f"{u:g}", Pe=f"{pe:g}", way=way), 0.1) for way in WAYS for u in SPEEDS for pe in PECLETS]
GOALS += [Goal(WIGGLE.format(u=f"{u:g}", Pe=f"{pe:g}", way="axis"), 1) for u in SPEEDS for pe in PECLETS]
SHORT_GOALS = [goal for goal in GOALS if ".u0.1.pe1.axis." in goal.figure or ".u0.1.pe10.axis.error" in goal.figure]
CLAIMS = {
    ERROR: Claim("diffusivity in a stream", "front carried along {way} at {u} cells a step, cell Péclet number {Pe}", "1 cell",
                 "advection and diffusion: the variance of the front grows by 2 D t"),
    WIGGLE: Claim("temperature beyond that of the two fluids", "front carried along {way} at {u} cells a step, cell Péclet number {Pe}", "1 cell",
                  "the largest and the least temperature are those at the start")}


def run_of(u, peclet, way):
    direction = np.array(WAYS[way], float)
    velocity = list(u * direction)
    times = [4 * round(x / u / 4) for x in (FIRST, LAST)]
    every = int(np.gcd(*times))
    text = case_text(
        f"A front at {u:g} cells a step, cell Peclet number {peclet:g}, {way}",
        domain=dict(size=[LENGTH, WIDTH, WIDTH],
                    boundary=dict(x=[dict(type="velocity-inlet", velocity=velocity, temperature=1.0), "pressure-outlet"], y="periodic",
                                  z="periodic")),
        fluid=dict(relaxation_time=0.8, precision="double", initial=dict(type="uniform", velocity=velocity)),
        heat=dict(thermal_diffusivity=float(u * np.linalg.norm(direction) / peclet)), run=dict(steps=times[1]),
        output=dict(fields=dict(every=every, quantities=["temperature"], precision="double")))
    return Run(f"u{u:g}.pe{peclet:g}.{way}", text, dict(u=u, peclet=peclet, way=way, first=times[0]))


def runs(level):
    if level == "short":
        return [run_of(0.1, peclet, "axis") for peclet in (1, 10)]
    return [run_of(*point) for point in itertools.product(SPEEDS, PECLETS, WAYS)]


def profile(field):
    """Returns the temperature along x."""
    return field["temperature"].mean(axis=(1, 2), dtype=float)


def moments(temperature):
    """Returns (mean place, variance) of -dT/dx, T in the middles of the cells, 1 at x = 0 and 0 far away."""
    x = np.arange(len(temperature)) + 0.5
    mean = temperature.sum()
    return mean, 2 * (x * temperature).sum() - mean**2


def measure(run, outcome):
    fields = {field.step: field for field in silt_results.open(outcome.folder).fields}
    last = max(fields)
    (x0, v0), (x1, v1) = (moments(profile(fields[step])) for step in (run.settings["first"], last))
    steps = last - run.settings["first"]
    u, direction = run.settings["u"], np.array(WAYS[run.settings["way"]])
    diffusivity = u * np.linalg.norm(direction) / run.settings["peclet"]
    end = profile(fields[last])
    return dict(error=100 * ((v1 - v0) / (2 * diffusivity * steps) - 1), speed=100 * ((x1 - x0) / (u * steps) - 1),
                wiggle=100 * max(end.max() - 1, -end.min(), 0))


def figures(measured):
    return {f"accuracy.thermal_front.{key}.{name}": Found(m[name], (key,)) for key, m in measured.items() for name in ("error", "speed", "wiggle")}
