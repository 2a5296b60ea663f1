"""A sphere that moves straight towards a wall: the drag against the gap, with and without the correction for lubrication.

Reference: H. Brenner, Chem. Eng. Sci. 16 (1961) 242, equation 2.19: F / (6 pi mu a U), for a half space (cf. column F_n of
reference/04_sphere_wall_stokes.csv). The sphere is free, but so heavy that its velocity stays as it is, U a / nu = 0.02, to 0.2 %;
its drag is the fluid's force and the films'. The box is periodic along the wall; the other wall is far. In the box the drag is IN_BOX
times Brenner's (point forces, stokes_periodic.py), less than 1.001 at smaller gaps. Errors are means over gaps within 5 % of the one
named, in radii; GAPS reach down to 0.04 to 0.08 cells.
Without films the lattice resolves a gap of two cells; others' fictitious boundary method with finite elements is within 10 % down to
2 to 3 cells, and 20 % off at 1.1 to 1.7 (FeatFloWer, docs/md_docs/dns_practitioners_guide.md, section 5).
"""
import math

import numpy as np
from case_text import case_text, sphere
from problem import Claim, Found, Goal, Run

SIZES = (8, 12, 16)                              # cells across
GAPS = (1, 0.5, 0.25, 0.1, 0.05, 0.02, 0.01)     # radii
WITHIN = 0.05                                    # of a gap, what its mean is taken over
START, END = 1.3, 0.009                          # gaps, radii
LENGTH, HEIGHT = 12, 10                          # of the box, radii
IN_BOX = {1: 1.0070, 0.5: 1.0021}                # by gap
DENSITY = 1e6                                    # of the sphere, over the fluid's
REYNOLDS, RELAXATION_TIME = 0.02, 2.0            # U a / nu
VISCOSITY = (RELAXATION_TIME - 0.5) / 3
RESOLVED = 2                                     # cells: the gap that is resolved without films

GOALS = [*(Goal(f"accuracy.wall_approach.d{D}.gap{gap:g}.error", 5) for D in SIZES for gap in GAPS),
         *(Goal(f"accuracy.wall_approach.d{D}.without.resolved.error", 10) for D in SIZES)]
SHORT_GOALS = [Goal(f"accuracy.wall_approach.d8.gap{gap:g}.error", 5) for gap in GAPS]
BRENNER = dict(source="Brenner, Chem. Eng. Sci. 16 (1961) 242, equation 2.19", doi="10.1016/0009-2509(61)80035-3")
CLAIMS = {
    "accuracy.wall_approach.d{D}.gap{gap}.error": Claim(
        "drag over 6 π μ a U, with the correction for lubrication", "sphere that moves towards a wall, Stokes flow, gap of {gap} radii", "D = {D}",
        **BRENNER, expected=lambda D, gap: exact(1 + float(gap)) * IN_BOX.get(float(gap), 1), uncertainty="0.2 %: inertia, the box",
        note="a gap of 0.6 cells is too narrow for the lattice, and films hardly act there yet"),
    "accuracy.wall_approach.d{D}.without.resolved.error": Claim(
        "drag, worst at gaps of two cells and more, without the correction", "sphere that moves towards a wall, Stokes flow", "D = {D}", **BRENNER,
        uncertainty="0.7 %: the box")}


def exact(height):
    """Returns Brenner's F / (6 pi mu a U), with the centre at this height over the wall, in radii."""
    alpha = math.acosh(height)
    s = math.sinh(alpha)

    def term(n):
        m = 2 * n + 1
        if m * alpha > 300:
            return 0.0
        top, bottom = 2 * math.sinh(m * alpha) + m * math.sinh(2 * alpha), 4 * math.sinh(m * alpha / 2)**2 - (m * s)**2
        return n * (n + 1) / ((2 * n - 1) * (2 * n + 3)) * (top / bottom - 1)
    return 4 / 3 * s * math.fsum(term(n) for n in range(1, 20 + int(20 / alpha)))


def run_of(D, films=True):
    a = D / 2
    speed = REYNOLDS * VISCOSITY / a
    size = [round(LENGTH * a), round(LENGTH * a), round(HEIGHT * a)]
    text = case_text(
        f"A sphere of {D} cells moves towards a wall", domain=dict(size=size, boundary=dict(x="periodic", y="periodic", z="no-slip")),
        fluid=dict(relaxation_time=RELAXATION_TIME), coupling={} if films else dict(lubrication=False), shapes=[sphere(D)],
        bodies=[dict(shape="sphere", density=DENSITY, velocity=[0, 0, -speed],
                     position=[size[0] / 2 + 0.31, size[1] / 2 + 0.17, (1 + START) * a])],
        run=dict(steps=round((START - END) * a / speed)), output=dict(bodies=dict(every=1, contacts=True)))
    return Run(f"d{D}" + ("" if films else ".without"), text, dict(D=D, films=films, speed=speed))


def runs(level):
    return [run_of(8)] if level == "short" else [run_of(D, films) for D in SIZES for films in (True, False)]


def measure(run, outcome):
    """Returns the error at each of GAPS, and the worst from RESOLVED cells on, of a tenth of a cell at a time."""
    a, bodies = run.settings["D"] / 2, outcome.bodies
    gap = bodies.array("position")[:, 0, 2] / a - 1
    force = bodies.array("force")[:, 0, 2] + np.nan_to_num(bodies.array("contact_force")[:, 0, 2])
    factor = force / (6 * math.pi * VISCOSITY * a * -bodies.array("velocity")[:, 0, 2])
    ratio = np.array([f / exact(1 + g) for f, g in zip(factor, gap)])
    found = {f"gap{g:g}": 100 * (ratio[np.abs(gap / g - 1) < WITHIN].mean() / IN_BOX.get(g, 1) - 1) for g in GAPS}
    found["slowed"] = 100 * (1 + bodies.array("velocity")[-1, 0, 2] / run.settings["speed"])
    resolved = [ratio[np.abs(gap * a - cells) < 0.05].mean() - 1 for cells in np.arange(RESOLVED, a, 0.1)]
    return {**found, "resolved": 100 * max(resolved, key=abs)}


def figures(measured):
    found = {}
    for key, m in measured.items():
        for name in [*(f"gap{g:g}" for g in GAPS), "resolved"]:
            found[f"accuracy.wall_approach.{key}.{name}.error"] = Found(m[name], (key,))
    return found
