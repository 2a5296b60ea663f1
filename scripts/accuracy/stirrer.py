"""The laminar power number of stirrers, walls of triangles that turn in a periodic cube four times as wide as their radius.

"disk": a flat disk an eighth as thick as wide, about an axis oblique to the lattice. "blade": an ellipsoid of semi-axes 1, 1/2 along the axis, and 1/4,
that turns a quarter about z, through the cells; the mean. Np Re = P / (mu n^2 d^3), n revolutions a time, d the diameter, P the power. Reference: the same box
(stokes_boxes.csv, by boundary elements and by point forces). In unbounded fluid Np Re of a disk without thickness is (32 / 3) pi^2 / 2 (Jeffery 1915), of the
ellipsoid that of Jeffery 1922; tests/accuracy/stokes_periodic.py and stokes_panels.py find these. A figure is the relative error; cells: of the cube.
"""
import functools
import math

import numpy as np

import stokes_scene as scene
from mesh_text import obj
from problem import Claim, Found, Goal, Run
from stokes_panels import Body, cylinder_panels
from stokes_periodic import Mirrors, PeriodicBox, ellipsoid_points, rotation_about, solve

EDGE, THICKNESS = 4.0, 0.25                      # of the cube and the disk, radii
BLADE = (1.0, 0.25, 0.5)                         # semi-axes, z along that of rotation
AXIS = {"disk": np.array([1.0, 2, 3]) / math.sqrt(14), "blade": np.array([0, 0, 1.0])}
SETUPS = list(AXIS)
CELLS = (48, 96)
REYNOLDS = 0.25                                  # w a^2 / nu; inertia changes the power by its square
START = 12                                       # times that in which the slowest mode of the box fades by e

GOALS = [Goal(f"accuracy.stirrer.{setup}.d{cells}.error", 3.0) for setup in SETUPS for cells in CELLS] + [
    Goal(f"accuracy.stirrer.{setup}.order", 9.0, 1.7) for setup in SETUPS]
SHORT_GOALS = [Goal("accuracy.stirrer.blade.d24.error", 12.0)]  # (48 / 24)^2: second order
CLAIMS = {
    "accuracy.stirrer.{setup}.d{N}.error": Claim(
        "power number times Re, mean of two places", "{setup} that turns in a periodic cube, Re = 0.25", "N = {N}", **scene.SAME_BOX,
        uncertainty="1.5e-3", expected=lambda setup, N: scene.references("stirrer")[setup]["NpRe"]),
    "accuracy.stirrer.{setup}.order": Claim(
        "order of convergence of the power number", "{setup} that turns in a periodic cube, Re = 0.25", "N = 48 and 96",
        "second order: analysis of the scheme", unit="")}


@functools.cache
def disk(fineness):
    return Body(cylinder_panels(1, THICKNESS, 12 * fineness))


def blade_torque(degrees, fineness):
    rotation = scene.rotation_about((0, 0, 1.0), degrees)
    flow, = solve(PeriodicBox((EDGE,) * 3), [ellipsoid_points(np.zeros(3), BLADE, rotation, 500 * fineness, 0.55)],
                  [rotation_about(np.zeros(3), AXIS["blade"])], Mirrors(np.zeros(3), (0, 0, 1)))
    return float(flow.torque(0, np.zeros(3))[2])


def exact(setup, fineness):
    """The power number: P = T w, n = w / (2 pi), d = 2."""
    if setup == "disk":
        to_axis = np.cross((0, 0, 1.0), AXIS["disk"])
        rotation = scene.rotation_about(to_axis, math.degrees(math.acos(AXIS["disk"][2])))
        resistance = disk(fineness).resistance(PeriodicBox((EDGE,) * 3), rotation)[3:, 3:]
        torque = float(AXIS["disk"] @ resistance @ AXIS["disk"])
    else:  # over a quarter turn, which the cube's mirrors make four times an eighth
        torque = sum(w * blade_torque(angle, fineness) for angle, w in ((0, 1), (15, 2), (30, 2), (45, 1))) / 6
    return {"NpRe": torque * math.pi**2 / 2}


@functools.cache
def surface(setup):
    if setup == "disk":
        return obj("pipe", radius=1.0, length=THICKNESS, facets=200, equal_volume=True)
    return obj("ellipsoid", radius=1.0, stretch=BLADE, triangles=12000, equal_volume=True)


def a_run(setup, cells, number, offset):
    a = cells / EDGE
    turn = REYNOLDS * scene.VISCOSITY / a**2
    start = 2 * round(START * cells**2 / (4 * math.pi**2 * scene.VISCOSITY) / 2)
    steps = start + 2 * round(math.pi / 2 / turn / 2)
    axis = scene.vector(AXIS[setup])
    text = (f'title = "Stirrer, {setup}, {cells} cells across the cube"\n[units]\nsystem = "lattice"\n'
            f'[domain]\nsize = {scene.vector((cells,) * 3)}\nboundary = "periodic"\n'
            f"[fluid]\nrelaxation_time = {scene.RELAXATION_TIME}\n"
            f'[[walls]]\nname = "stirrer"\ntype = "mesh"\nfile = "stirrer.obj"\nsolid = "inside"\nscale = {a}\n'
            f"position = {scene.vector(cells // 2 + np.array(offset))}\norientation = {axis}\n"
            f"motion = {{ angular_velocity = {turn!r}, axis = {axis} }}\n"
            f"[run]\nsteps = {steps}\n"
            f'[[quantities]]\nname = "power"\ntype = "wall-power"\ntime = {start}\n')
    return Run(f"{setup}.d{cells}.place{number}", text, {"setup": setup, "place": number, "D": cells, "turn": turn},
               {"stirrer.obj": surface(setup)})


def runs(level):
    if level == "short":
        return [a_run("blade", 24, 0, scene.offsets(2)[0])]
    return [a_run(setup, cells, n, o) for setup in SETUPS for cells in CELLS for n, o in enumerate(scene.offsets(2))]


def measure(run, outcome):
    setup, turn, diameter = run.settings["setup"], run.settings["turn"], 2 * run.settings["D"] / EDGE
    found = outcome.quantity("power") / (scene.VISCOSITY * (turn / (2 * math.pi))**2 * diameter**3)
    return {"NpRe": found, "error": scene.percent(found, scene.references("stirrer")[setup]["NpRe"])}


def figures(measured):
    found = scene.summary("stirrer", measured, CELLS[-1])
    for setup in SETUPS:
        errors = [found.get(f"accuracy.stirrer.{setup}.d{cells}.error") for cells in CELLS]
        if all(errors):
            coarse, fine = (abs(e.value) for e in errors)
            order = math.log2(coarse / fine) if coarse > 0 and fine > 0 else math.nan
            found[f"accuracy.stirrer.{setup}.order"] = Found(order, errors[0].runs + errors[1].runs)
    return found
