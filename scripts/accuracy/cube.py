"""Drag of, and torque on, bodies with edges: a cube in three orientations and a cylinder as long as wide in two.

The body is in a periodic cube. "drag": it is held, and a body force drives the flow along x; K = F / (6 pi mu a U), U the superficial velocity, a the
radius of the sphere of the same volume. "torque": it turns slowly about x; T / (8 pi mu a^3 w). Reference: the same box and orientation
(stokes_boxes.csv, by boundary elements). A figure is the relative error.
"straight": an edge along x; "turned": by 45 degrees about z; "diagonal": its diagonal along x; "along", "across": the cylinder's axis.
The flow has no bounded derivatives at an edge; what makes the schemes second order fails there.
"""
import functools
import math

import numpy as np

import stokes_scene as scene
from problem import Claim, Goal, Run
from stokes_panels import Body, cube_panels, cylinder_panels
from stokes_periodic import PeriodicBox

BOX = {"cube": 4.25, "cylinder": 4.5}            # edges; diameters
TURN = {"cube.straight": ((0, 0, 1.0), 0.0), "cube.turned": ((0, 0, 1.0), 45.0),
        "cube.diagonal": ((0, 1.0, -1.0), math.degrees(math.acos(1 / math.sqrt(3)))),
        "cylinder.along": ((0, 1.0, 0), 90.0), "cylinder.across": ((0, 1.0, 0), 0.0)}  # axis and degrees; the cylinder's own axis is z
SETUPS = [f"{body}.{flow}" for body in TURN for flow in ("drag", "torque")]
CELLS = (24, 48, 96)                             # of the box
FINE = 11                                        # cells across in the second of them
TURNING = 0.003                                  # of the speed, at half an edge: no cell is covered or uncovered
QUANTITY = {"drag": "K", "torque": "torque"}

GOALS = [Goal(f"accuracy.cube.{setup}.d{FINE}.error", limit) for setup in SETUPS
         for limit in [1.5 if setup.endswith("torque") else 0.8 if setup.startswith("cylinder") else 1.0]]
SHORT_GOALS = [Goal("accuracy.cube.cube.straight.torque.d6.error", 1.0)]
CLAIMS = {"accuracy.cube.{body}.{way}.{flow}.d{D}.error": Claim(
    "{flow}, mean of the places", "{body}, {way}, in a periodic box, Stokes flow", "D = {D}", **scene.SAME_BOX, uncertainty="9e-4",
    expected=lambda body, way, flow, D: scene.references("cube")[f"{body}.{way}.{flow}"][QUANTITY[flow]],
    note="the flow has no bounded derivatives at an edge, and the error depends on the place of the edge in its cell")}


def parts(setup):
    """Returns (body, the body and its orientation, flow)."""
    oriented, flow = setup.rsplit(".", 1)
    return oriented.split(".")[0], oriented, flow


def radius(body):
    """Returns the radius of the sphere of the same volume, in edges or diameters."""
    return ((1 if body == "cube" else math.pi / 4) * 3 / (4 * math.pi))**(1 / 3)


@functools.cache
def response(body, fineness):
    return Body(cube_panels(1, 8 * fineness) if body == "cube" else cylinder_panels(0.5, 1, 12 * fineness))


@functools.cache
def resistance(oriented, fineness):
    body = oriented.split(".")[0]
    return response(body, fineness).resistance(PeriodicBox((BOX[body],) * 3), scene.rotation_about(*TURN[oriented]))


def exact(setup, fineness):
    body, oriented, flow = parts(setup)
    found = resistance(oriented, fineness)
    if flow == "torque":
        return {"torque": float(found[3, 3]) / (8 * math.pi * radius(body)**3)}
    return {"K": 1 / (6 * math.pi * radius(body) * float(np.linalg.inv(found[:3, :3])[0, 0]))}


def a_run(setup, cells, number, offset):
    body, oriented, flow = parts(setup)
    size = cells / BOX[body]
    a, U = radius(body) * size, scene.speed(size)
    axis, degrees = TURN[oriented]
    text = f'type = "box"\nedges = {scene.vector((size,) * 3)}' if body == "cube" else \
        f'type = "cylinder"\ndiameter = {size}\nlength = {size}'
    place = cells // 2 + np.array(offset)
    turned = {"orientation": f"{{ axis = {scene.vector(axis)}, degrees = {degrees} }}"}
    if flow == "drag":
        factor = scene.references("cube")[setup]["K"]
        slowest = cells**3 / (6 * math.pi * scene.VISCOSITY * a * factor)  # steps in which the mean velocity settles
        steps, held = 13 * slowest, scene.body("body", place, **turned)
        fluid = f'body_force = [{U / slowest!r}, 0, 0]\ninitial = {{ type = "uniform", velocity = [{U!r}, 0, 0] }}'
    else:
        steps = 40 * cells**2 / (4 * math.pi**2 * scene.VISCOSITY)
        held = scene.body("body", place, "prescribed", angular_velocity=(TURNING * U / size, 0, 0), **turned)
        fluid = ""
    text = scene.case(f"{setup}, {size:.1f} cells across", (cells,) * 3, text, [held], round(steps), fluid=fluid,
                      quantities="x" if flow == "drag" else "", precision="double")
    return Run(f"{setup}.d{round(size)}.place{number}", text, {"setup": setup, "place": number, "D": size})


def runs(level):
    if level == "short":
        return [a_run("cube.straight.torque", CELLS[0], 0, scene.offsets(3)[0])]
    return [a_run(setup, cells, n, o) for setup in SETUPS for cells in CELLS
            for n, o in enumerate(scene.offsets(3)[:1 if cells == CELLS[-1] else 3])]


def measure(run, outcome):
    setup, size = run.settings["setup"], run.settings["D"]
    body, _, flow = parts(setup)
    if flow == "drag":
        found = scene.drag(run, outcome)
    else:
        unit = 8 * math.pi * scene.VISCOSITY * (radius(body) * size)**3 * TURNING * scene.speed(size) / size
        found = -scene.settled(outcome.bodies.array("torque")[:, 0], unit)[0] / unit
    return {QUANTITY[flow]: found, "error": scene.percent(found, scene.references("cube")[setup][QUANTITY[flow]])}


def figures(measured):
    return scene.summary("cube", measured, FINE)
