"""The torque on a sphere that turns, T / (8 pi mu a^3 w).

The sphere turns about an axis of the lattice, or an oblique one, (1, 2, 3), in a periodic cube of 6 radii. Reference: the same box
(stokes_boxes.csv; nearly 1 / (1 - phi)). In unbounded fluid the factor is 1 (Kirchhoff 1876); a figure is its relative error.
"""
import math

import numpy as np

import stokes_scene as scene
from problem import Claim, Goal, Run
from stokes_periodic import PeriodicBox, rotation_about, solve, sphere_points

EDGE = 6.0                                       # radii
AXES = {"straight": np.array([0, 0, 1.0]), "oblique": np.array([1.0, 2, 3]) / math.sqrt(14)}
SETUPS = list(AXES)
FINE = 12

GOALS = [Goal(f"accuracy.rotating_sphere.{setup}.d{FINE}.error", 1.0) for setup in SETUPS] + [
    Goal("accuracy.rotating_sphere.error", 1.0)]
SHORT_GOALS = [Goal(f"accuracy.rotating_sphere.{setup}.d8.error", 2.25) for setup in SETUPS]  # (12 / 8)^2: second order
CLAIMS = {
    "accuracy.rotating_sphere.error": Claim("torque, worst of the axes", "sphere that turns in a periodic box", f"D = {FINE}", **scene.SAME_BOX,
                                            uncertainty="1e-7"),
    "accuracy.rotating_sphere.{setup}.d{D}.error": Claim(
        "torque, mean of four places", "sphere that turns about a {setup} axis in a periodic box", "D = {D}", **scene.SAME_BOX,
        uncertainty="1e-7", expected=lambda setup, D: scene.references("rotating_sphere")[setup]["torque"])}


def exact(setup, fineness):
    flow, = solve(PeriodicBox((EDGE,) * 3), [sphere_points((0, 0, 0), 1, 150 * fineness, 0.6)],
                  [rotation_about(np.zeros(3), AXES[setup])])
    return {"torque": float(flow.torque(0, np.zeros(3)) @ AXES[setup]) / (8 * math.pi)}


def a_run(setup, diameter, number, offset):
    a, edge = diameter / 2, EDGE * diameter / 2
    turn = scene.speed(diameter) / a * AXES[setup]
    steps = round(20 * edge**2 / (4 * math.pi**2 * scene.VISCOSITY))
    text = scene.case(f"Rotating sphere, {setup} axis, {diameter} cells across", (edge,) * 3,
                      f'type = "sphere"\ndiameter = {diameter}',
                      [scene.body("body", edge // 2 + np.array(offset), "prescribed", angular_velocity=turn)], steps)
    return Run(f"{setup}.d{diameter}.place{number}", text, {"setup": setup, "place": number, "D": diameter})


def runs(level):
    diameters = (8,) if level == "short" else (8, 12, 16)
    return [a_run(setup, D, n, o) for setup in SETUPS for D in diameters for n, o in enumerate(scene.offsets(4))]


def measure(run, outcome):
    setup, diameter = run.settings["setup"], run.settings["D"]
    unit = 8 * math.pi * scene.VISCOSITY * (diameter / 2)**2 * scene.speed(diameter)
    series = outcome.bodies.array("torque")[:, 0]
    torque = -scene.settled(series, unit) @ AXES[setup] / unit
    return {"torque": torque, "error": scene.percent(torque, scene.references("rotating_sphere")[setup]["torque"]),
            "alternating": scene.alternating(series, unit)}


def figures(measured):
    return scene.summary("rotating_sphere", measured, FINE)
