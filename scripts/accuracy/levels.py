"""Drag of a sphere in slow flow, in a periodic cube 10 diameters wide, with wider cells away from it.

The scene and reference are those of periodic_array; the flow starts as fast as it will be, and lasts until the drag is steady. A run is
named by its `[coarsening]`: levels and distance in diameters, or uniform. difference: of the drag from that of cells of one width at the
same place, in percent; speedup: of the core-seconds.
"""
import math

import periodic_array as array
from case_text import case_text, cube, sphere
from problem import Claim, Curve, Found, Goal, Run

FRACTION = math.pi / 6000
POSITION = (0.13, 0.31, 0.87)
RELAXATION_TIME = 3.0
VISCOSITY = (RELAXATION_TIME - 0.5) / 3
SETTLED = 0.35           # of L^2 / nu: 13 e-foldings of the slowest mode beside the mean velocity
SIZES = (6, 8, 12, 16)
DISTANCES = {1: (0.5, 0.75, 1, 2), 2: (0.75, 1)}
LEAST = 6                # cells, of a distance
UNIFORM = (0, 0)
METHODS = [UNIFORM, *((levels, distance) for levels in DISTANCES for distance in DISTANCES[levels])]


def name_of(levels, distance):
    return f"levels{levels}.distance{distance:g}" if levels else "uniform"


GOALS = [*(Goal(f"accuracy.levels.d{D}.{name_of(1, 0.75)}.difference", 0.1) for D in (8, 12)),
         Goal(f"accuracy.levels.d8.{name_of(1, 0.75)}.speedup", 1e9, low=8), Goal(f"accuracy.levels.d12.{name_of(1, 0.5)}.speedup", 1e9, low=8)]
SHORT_GOALS = [Goal(f"accuracy.levels.d6.{name_of(2, 1)}.error", 1.0)]
CLAIMS = {
    "accuracy.levels.d{D}.{levels}.distance{distance}.difference": Claim(
        "drag K with wider cells {distance} diameters away", "sphere in a wide box, Stokes flow", "D = {D}", "own run with cells of one width",
        kind="convergence"),
    "accuracy.levels.d{D}.{levels}.distance{distance}.speedup": Claim(
        "times as fast with wider cells {distance} diameters away", "sphere in a wide box, Stokes flow", "D = {D}",
        "own run with cells of one width", kind="convergence", unit="", note="a time: it scatters by some percent on a busy machine"),
    "accuracy.levels.d{D}.{levels}.distance{distance}.error": Claim(
        "drag K with wider cells {distance} diameters away", "sphere in a wide box, Stokes flow", "D = {D}",
        "Zick, Homsy, J. Fluid Mech. 115 (1982) 13; series of Sangani, Acrivos (1982)", doi="10.1017/S0022112082000627", uncertainty="1e-6",
        expected=lambda **_: array.exact_drag(FRACTION))}


def run_of(D, levels, distance, place=POSITION):
    edge, stride = 10 * D, 2**levels
    steps = math.ceil(SETTLED * edge**2 / VISCOSITY / 8) * 8
    speed = array.REYNOLDS * VISCOSITY / D
    every = max(1, round(steps / 40 / stride)) * stride
    text = case_text(
        f"A sphere {D} cells across in a box 10 diameters wide, {name_of(levels, distance)}", domain=cube(edge),
        coarsening=dict(levels=levels, distance=float(distance * D)) if levels else {},
        fluid=dict(relaxation_time=RELAXATION_TIME, body_force=[array.drive(FRACTION, edge, D, VISCOSITY, speed), 0, 0],
                   initial=dict(type="uniform", velocity=[speed, 0, 0])),
        shapes=[sphere(D)], bodies=[dict(shape="sphere", density=1, motion="fixed", position=[edge // 2 + o for o in place])],
        run=dict(steps=steps), output=dict(report=dict(every=every)),
        quantities=[dict(name="K", type="drag-coefficient", axis="x")])
    return Run(f"d{D}.{name_of(levels, distance)}", text, dict(D=D, method=name_of(levels, distance)))


def runs(level):
    if level == "short":
        return [run_of(6, 2, 1)]
    return [run_of(D, *method) for D in SIZES[:-1] for method in METHODS if method == UNIFORM or method[1] * D >= LEAST] + \
        [run_of(SIZES[-1], 1, 0.5)]  # the uniform one takes an hour


def measure(run, outcome):
    return {"error": 100 * (outcome.quantity("K") / array.exact_drag(FRACTION) - 1)}


def figures(measured):
    found = {}
    for D in SIZES:
        uniform = measured.get(run_of(D, *UNIFORM).key)
        for method in METHODS:
            key = run_of(D, *method).key
            if key not in measured:
                continue
            found[f"accuracy.levels.{key}.error"] = Found(measured[key]["error"], (key,))
            if uniform and method != UNIFORM:
                both, mine = (key, run_of(D, *UNIFORM).key), measured[key]
                ratio = (100 + mine["error"]) / (100 + uniform["error"])
                found[f"accuracy.levels.{key}.difference"] = Found(100 * (ratio - 1), both)
                found[f"accuracy.levels.{key}.speedup"] = Found(uniform["core_seconds"] / mine["core_seconds"], both)
    return found


def curves(measured):
    lines = {}
    for method in METHODS:
        points = [(m["core_seconds"], m["error"], f"{D}") for D in SIZES if (m := measured.get(run_of(D, *method).key))]
        lines["one width" if method == UNIFORM else "levels = {}, distance {:g} D".format(*method)] = points
    return [Curve(label, points) for label, points in lines.items()]
