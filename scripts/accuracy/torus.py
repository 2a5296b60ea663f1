"""Drag of a torus, a mesh, along its axis and across it, straight and oblique to the lattice.

The torus, three times as wide from the axis to the middle of its tube as the tube is thick from there, is held in a periodic cube of 12 radii of the
tube; a body force drives the flow along its axis ("broadside") or across it ("edgewise"). K = F / (6 pi mu a U), a the radius of
the sphere of the same volume, U the superficial velocity along F. Reference: the same box (stokes_boxes.csv); in unbounded fluid thin tori have Johnson and Wu's
resistance (J. Fluid Mech. 95 (1979) 263), as tests/accuracy/stokes_periodic.py finds. D: cells across the tube. A figure is the relative error of K.
"""
import functools
import math

import numpy as np

import stokes_scene as scene
from mesh_text import obj
from problem import Claim, Goal, Run
from stokes_periodic import PeriodicBox, solve, torus_points, uniform

RING, EDGE = 3.0, 12.0                           # radii of the tube
VOLUME = 2 * math.pi**2 * RING
RADIUS = (VOLUME * 3 / (4 * math.pi))**(1 / 3)
TURN = {"straight": ((0.0, 1.0, 0.0), 90.0), "oblique": ((3.0, 1.0, -2.0), 67.0)}  # axis and degrees; the body's own axis is z
SETUPS = [f"{flow}.{way}" for flow in ("broadside", "edgewise") for way in TURN]
FINE = 8
TRIANGLES = 12000

GOALS = [Goal(f"accuracy.torus.{setup}.d{FINE}.error", 1.5) for setup in SETUPS] + [Goal("accuracy.torus.error", 1.5)]
SHORT_GOALS = [Goal("accuracy.torus.broadside.oblique.d6.error", 2.7)]  # (8 / 6)^2: second order
CLAIMS = {
    "accuracy.torus.error": Claim("drag K, worst of all", "torus in a periodic box, Stokes flow", f"D = {FINE}", **scene.SAME_BOX, uncertainty="1e-4"),
    "accuracy.torus.{flow}.{way}.d{D}.error": Claim(
        "drag K, mean of the places", "torus, {flow}, {way}, Stokes flow", "D = {D} across the tube", **scene.SAME_BOX, uncertainty="1e-4",
        expected=lambda flow, way, D: scene.references("torus")[f"{flow}.{way}"]["K"])}


def parts(setup):
    """Returns (way, direction of the force)."""
    flow, way = setup.split(".")
    return way, scene.rotation_about(*TURN[way])[:, 2 if flow == "broadside" else 0]


@functools.cache
def mobility(way, fineness):
    """Returns the mobility M: U = M F / (6 pi mu a)."""
    torus = torus_points(np.zeros(3), RING, 1, scene.rotation_about(*TURN[way]), 500 * fineness)
    flows = solve(PeriodicBox((EDGE,) * 3), [torus], [uniform(e) for e in np.eye(3)])
    return 6 * math.pi * RADIUS * np.linalg.inv(np.stack([flow.force(0) for flow in flows], -1))


def exact(setup, fineness):
    way, direction = parts(setup)
    return {"K": 1 / float(direction @ mobility(way, fineness) @ direction)}


@functools.cache
def surface():
    return obj("torus", radius=RING, tube=1.0, triangles=TRIANGLES, equal_volume=True)


def a_run(setup, diameter, number, offset, factor):
    way, direction = parts(setup)
    tube = diameter / 2
    edge, U = EDGE * tube, scene.speed(RING * diameter)
    axis, degrees = TURN[way]
    slowest = edge**3 / (6 * math.pi * scene.VISCOSITY * RADIUS * tube * factor)  # steps in which the mean velocity settles
    text = scene.case(
        f"Torus, {setup}, {diameter} cells across the tube", (edge,) * 3, f'type = "mesh"\nfile = "torus.obj"\nscale = {tube}',
        [scene.body("body", edge // 2 + np.array(offset), orientation=f"{{ axis = {scene.vector(axis)}, degrees = {degrees} }}")],
        round(22 * slowest),
        fluid=f"body_force = {scene.vector(U / slowest * direction)}\n"
              f'initial = {{ type = "uniform", velocity = {scene.vector(U * direction)} }}', quantities="xyz")
    return Run(f"{setup}.d{diameter}.place{number}", text, {"setup": setup, "place": number, "D": diameter},
               {"torus.obj": surface()})


def runs(level):
    factors = {setup: values["K"] for setup, values in scene.references("torus").items()}
    if level == "short":
        return [a_run("broadside.oblique", 6, 0, scene.offsets(4)[0], factors["broadside.oblique"])]
    return [a_run(setup, D, n, o, factors[setup]) for setup in SETUPS for D in (6, FINE, 12)
            for n, o in enumerate(scene.offsets(4)[:4 if D <= FINE else 2])]


def measure(run, outcome):
    setup = run.settings["setup"]
    _, direction = parts(setup)
    volume = VOLUME * (run.settings["D"] / 2)**3
    along = sum(d * d / scene.drag(run, outcome, axis, volume) for d, axis in zip(direction, "xyz") if abs(d) > 1e-6)
    return {"K": 1 / along, "error": scene.percent(1 / along, scene.references("torus")[setup]["K"])}


def figures(measured):
    return scene.summary("torus", measured, FINE)
