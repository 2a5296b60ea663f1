"""Drag of spheroids of aspect 0.5, 2 and 3 along and across their axis, straight and oblique to the lattice.

The spheroid is held in a periodic cube of 6 radii of the sphere of its volume; a body force drives the flow along its axis of
symmetry ("axis") or across it ("across"). K = F / (6 pi mu a U), U the superficial velocity along F. Reference: the same box
(stokes_boxes.csv). In unbounded fluid: Oberbeck (1876); a figure is the relative error of K, and so that of his factor.
"""
import functools
import math

import numpy as np

import stokes_scene as scene
from problem import Claim, Goal, Run
from stokes_periodic import PeriodicBox, solve, spheroid_points, uniform

EDGE = 6.0                                       # radii of the sphere of the same volume
ASPECTS = (0.5, 2, 3)                            # polar over equatorial diameter
TURN = {"straight": ((0.0, 1.0, 0.0), 90.0), "oblique": ((3.0, 1.0, -2.0), 67.0)}  # axis and degrees; the body's own axis is z
SETUPS = [f"r{r:g}.{flow}.{way}" for r in ASPECTS for flow in ("axis", "across") for way in TURN]
FINE = 12

GOALS = [Goal(f"accuracy.spheroid.{setup}.d{FINE}.error", 1.0) for setup in SETUPS] + [Goal("accuracy.spheroid.error", 1.0)]
SHORT_GOALS = [Goal("accuracy.spheroid.r2.axis.oblique.d8.error", 2.25)]  # (12 / 8)^2: second order
CLAIMS = {
    "accuracy.spheroid.error": Claim("drag K, worst of all", "spheroids in a periodic box, Stokes flow", f"D = {FINE}", **scene.SAME_BOX,
                                     uncertainty="3e-4"),
    "accuracy.spheroid.r{aspect}.{flow}.{way}.d{D}.error": Claim(
        "drag K along or across the axis ({flow}), mean of the places", "spheroid of aspect {aspect}, {way}, Stokes flow", "D = {D}",
        **scene.SAME_BOX, uncertainty="3e-4",
        expected=lambda aspect, flow, way, D: scene.references("spheroid")[f"r{aspect}.{flow}.{way}"]["K"])}


def parts(setup):
    """Returns (aspect, way, direction of the force)."""
    aspect, flow, way = setup.rsplit(".", 2)
    return float(aspect.removeprefix("r")), way, rotation_of(way)[:, 2 if flow == "axis" else 0]


def rotation_of(way):
    return scene.rotation_about(*TURN[way])


def semi_axes(aspect):
    """Returns (polar, equatorial) in radii of the sphere of the same volume."""
    return aspect**(2 / 3), aspect**(-1 / 3)


@functools.cache
def mobility(aspect, way, fineness):
    """Returns the mobility M: U = M F / (6 pi mu a)."""
    rotation = rotation_of(way)
    spheroid = spheroid_points(np.zeros(3), *semi_axes(aspect), rotation, 400 * fineness, 0.55)
    flows = solve(PeriodicBox((EDGE,) * 3), [spheroid], [uniform(e) for e in np.eye(3)])
    return 6 * math.pi * np.linalg.inv(np.stack([flow.force(0) for flow in flows], -1))


def exact(setup, fineness):
    aspect, way, direction = parts(setup)
    return {"K": 1 / float(direction @ mobility(aspect, way, fineness) @ direction)}


def a_run(setup, diameter, number, offset, factor):
    aspect, way, direction = parts(setup)
    a, edge, U = diameter / 2, EDGE * diameter / 2, scene.speed(diameter)
    polar, equatorial = (diameter * s for s in semi_axes(aspect))
    axis, degrees = TURN[way]
    slowest = edge**3 / (6 * math.pi * scene.VISCOSITY * a * factor)    # steps in which the mean velocity settles
    text = scene.case(
        f"Spheroid, {setup}, {diameter} cells across", (edge,) * 3,
        f'type = "ellipsoid"\ndiameters = {scene.vector((equatorial, equatorial, polar))}',
        [scene.body("body", edge // 2 + np.array(offset), orientation=f"{{ axis = {scene.vector(axis)}, degrees = {degrees} }}")],
        round(13 * slowest),
        fluid=f"body_force = {scene.vector(U / slowest * direction)}\n"
              f'initial = {{ type = "uniform", velocity = {scene.vector(U * direction)} }}', quantities="xyz")
    return Run(f"{setup}.d{diameter}.place{number}", text, {"setup": setup, "place": number, "D": diameter})


def runs(level):
    factors = {setup: values["K"] for setup, values in scene.references("spheroid").items()}
    if level == "short":
        listed = [("r2.axis.oblique", 8)]
    else:
        listed = [(setup, FINE) for setup in SETUPS] + [("r2.axis.oblique", D) for D in (8, 16)]
    return [a_run(setup, D, n, o, factors[setup]) for setup, D in listed for n, o in enumerate(scene.offsets(4))]


def measure(run, outcome):
    setup = run.settings["setup"]
    _, _, direction = parts(setup)
    along = sum(d * d / scene.drag(run, outcome, axis) for d, axis in zip(direction, "xyz") if abs(d) > 1e-6)
    return {"K": 1 / along, "error": scene.percent(1 / along, scene.references("spheroid")[setup]["K"])}


def figures(measured):
    return scene.summary("spheroid", measured, FINE)
