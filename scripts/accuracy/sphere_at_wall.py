"""A sphere near a plane wall: translation along it, rotation, shear flow past it (Goldman, Cox, Brenner 1967).

The sphere is held at height h over the lower of two plates, the flow is periodic along them. Translation: both plates move;
rotation: the sphere turns, the plates rest; shear: the upper plate moves. Force and torque factors as in Goldman, Cox and Brenner:
    translation  F / (6 pi mu a U), T / (8 pi mu a^2 U)        rotation  F / (6 pi mu a^2 w), T / (8 pi mu a^3 w)
    shear        F / (6 pi mu a h S), T / (4 pi mu a^3 S)
Reference: the same box (stokes_boxes.csv). force_error and torque_error are relative to the value, but a torque that translation
makes and a force that rotation makes, which vanish far from the wall, are relative to what the motion's own torque and force
factors would be there, 1: they are what they weigh in the motion of a free sphere.
"""
import functools
import math

import numpy as np

import stokes_scene as scene
from problem import Claim, Goal, Run
from stokes_periodic import Channel, Mirrors, rotation_about, solve, sphere_points, uniform

LENGTH, HEIGHT = 8.0, 6.0                        # radii
HEIGHTS = (1.13, 1.2, 1.5, 2.0)                  # of the centre over the wall, radii
MOTIONS = ("translation", "rotation", "shear")
SETUPS = [f"{motion}.h{h:g}" for motion in MOTIONS for h in HEIGHTS]
FINE = 16

GOALS = [Goal(f"accuracy.sphere_at_wall.{setup}.d{FINE}.{what}_error", 2.0) for setup in SETUPS
         for what in ("force", "torque")] + [Goal("accuracy.sphere_at_wall.error", 2.0)]
SHORT_GOALS = [Goal("accuracy.sphere_at_wall.rotation.h1.5.d8.torque_error", 3.0)]
CLAIMS = {
    "accuracy.sphere_at_wall.error": Claim("force and torque, worst of all", "sphere near a wall, Stokes flow", f"D = {FINE}", **scene.SAME_BOX,
                                           uncertainty="5e-3"),
    "accuracy.sphere_at_wall.{motion}.h{h}.d{D}.{what}_error": Claim(
        "{what}, mean of the places", "sphere {h} radii over a wall, {motion}, Stokes flow", "D = {D}",
        **scene.SAME_BOX | dict(source="same box (stokes_boxes.csv); Goldman, Cox, Brenner, Chem. Eng. Sci. 22 (1967) 637 and 653"),
        doi="10.1016/0009-2509(67)80047-2", uncertainty="5e-3")}


def parts(setup):
    motion, height = setup.split(".", 1)
    return motion, float(height.removeprefix("h"))


def scales(motion, h):
    """Returns what force and torque are divided by, at a = mu = U = omega = S = 1."""
    return {"translation": (6 * math.pi, 8 * math.pi), "rotation": (6 * math.pi, 8 * math.pi),
            "shear": (6 * math.pi * h, 4 * math.pi)}[motion]


@functools.cache
def flows(h, fineness):
    """Returns {motion: flow}."""
    depth, centre = 0.65 if h >= 1.5 else 0.72, np.array([0, 0, h])
    sphere = sphere_points(centre, 1, (250 if h >= 1.5 else 400) * fineness, depth)
    box = Channel((LENGTH, LENGTH), HEIGHT, 2 * h - 1 - depth)
    wanted = [uniform((-1, 0, 0)), rotation_about(centre, (0, 1, 0)), lambda x: x[:, 2:] * np.array([-1.0, 0, 0])]
    return dict(zip(MOTIONS, solve(box, [sphere], wanted, Mirrors(centre, (-1, 1, 0)))))


def exact(setup, fineness):
    """Returns the factors of the fluid's force along x and torque about y on the sphere."""
    motion, h = parts(setup)
    flow, (force, torque) = flows(h, fineness)[motion], scales(motion, h)
    return {"force": -flow.force(0)[0] / force, "torque": -flow.torque(0, np.array([0, 0, h]))[1] / torque}


def a_run(setup, diameter, number, offset):
    motion, h = parts(setup)
    a, U = diameter / 2, scene.speed(diameter)
    cells = [LENGTH * a, LENGTH * a, HEIGHT * a]
    moving = '{{ type = "moving", velocity = {} }}'.format(scene.vector((U, 0, 0)))
    lower, upper = {"translation": (moving, moving), "rotation": ('"no-slip"',) * 2, "shear": ('"no-slip"', moving)}[motion]
    place = (cells[0] // 2 + offset[0], cells[1] // 2 + offset[1], h * a)
    turns = motion == "rotation"
    sphere = scene.body("body", place, **({"motion": "prescribed", "angular_velocity": (0, U / a, 0)} if turns else {}))
    steps = round((15 if motion == "shear" else 10) * cells[2]**2 / (math.pi**2 * scene.VISCOSITY))
    start = f'initial = {{ type = "uniform", velocity = {scene.vector((U, 0, 0))} }}' if motion == "translation" else ""
    text = scene.case(f"Sphere at a wall, {setup}, {diameter} cells across", cells, f'type = "sphere"\ndiameter = {diameter}',
                      [sphere], steps, boundary=f'{{ x = "periodic", y = "periodic", z = [{lower}, {upper}] }}', fluid=start)
    return Run(f"{setup}.d{diameter}.place{number}", text, {"setup": setup, "place": number, "D": diameter})


def runs(level):
    places = list(enumerate(scene.offsets(4)))
    if level == "short":
        return [a_run("rotation.h1.5", 8, n, o) for n, o in places[:2]]
    listed = [(setup, FINE) for setup in SETUPS] + [(f"{motion}.h1.5", D) for motion in MOTIONS for D in (8, 12)]
    return [a_run(setup, diameter, n, o) for setup, diameter in listed for n, o in places]


def measure(run, outcome):
    motion, h = parts(run.settings["setup"])
    a, U, mu = run.settings["D"] / 2, scene.speed(run.settings["D"]), scene.VISCOSITY
    force, torque = scales(motion, h)
    if motion == "shear":
        force, torque = force / HEIGHT, torque / HEIGHT       # S = U / (HEIGHT a)
    forces = outcome.bodies.array("force")[:, 0] / (force * mu * a * U)
    torques = outcome.bodies.array("torque")[:, 0] / (torque * mu * a**2 * U)
    found = {"force": scene.settled(forces, 1)[0], "torque": scene.settled(torques, 1)[1]}
    box = scene.references("sphere_at_wall")[run.settings["setup"]]
    return {**found, "force_error": 100 * (found["force"] - box["force"]) / (1 if motion == "rotation" else box["force"]),
            "torque_error": 100 * (found["torque"] - box["torque"]) / (1 if motion == "translation" else abs(box["torque"])),
            "alternating": max(scene.alternating(forces, 1), scene.alternating(torques, 1))}


def figures(measured):
    return scene.summary("sphere_at_wall", measured, FINE)
