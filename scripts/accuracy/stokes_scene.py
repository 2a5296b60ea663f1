"""Bodies held in slow flow: what the cases of the Stokes problems have in common, and their reference values.

Lengths of a problem are in radii a of its sphere (of the sphere of the same volume), so that one reference value serves
every resolution; boxes are whole numbers of cells at each diameter used. The reference is the flow in the very box that
is simulated (stokes_periodic.py), kept in reference/stokes_boxes.csv, written by stokes_boxes.py.
"""
import csv
import math
import pathlib
import random
import tomllib

import numpy as np

from problem import Found

REFERENCE = pathlib.Path(__file__).parent / "reference" / "stokes_boxes.csv"
REYNOLDS = 0.01             # U D / nu; inertia changes the drag of a symmetric body by its square
RELAXATION_TIME = 2.0       # with trt the drag does not depend on it; a high viscosity reaches the steady state soonest
VISCOSITY = (RELAXATION_TIME - 0.5) / 3
STEADY = 2e-4               # what a force may still change in the last fifth of a run, of itself

SAME_BOX = dict(source="Stokes flow in the same box by point forces or boundary elements (stokes_boxes.csv)", kind="computation")


def references(problem):
    """Returns {setup: {quantity: value}} of a problem."""
    found = {}
    with open(REFERENCE) as stream:
        for row in csv.DictReader(line for line in stream if not line.startswith("#")):
            if row["problem"] == problem:
                found.setdefault(row["setup"], {})[row["quantity"]] = float(row["value"])
    return found


def offsets(number):
    """Returns places of a body's centre in its cell, [0, 1)^3: each coordinate once in each of `number` equal parts, in random order."""
    generator = random.Random(1880)
    columns = [generator.sample(range(number), number) for _ in range(3)]
    return [tuple((place + generator.random()) / number for place in row) for row in zip(*columns)]


def speed(diameter):
    """Returns the speed of the flow, in cells a step."""
    return REYNOLDS * VISCOSITY / diameter


def rotation_about(axis, degrees):
    """Returns the rotation matrix, by Rodrigues' formula."""
    angle = math.radians(degrees)
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def vector(values):
    return "[" + ", ".join(repr(float(v)) for v in values) + "]"


def body(shape, position, motion="fixed", **keys):
    more = "".join(f"{name} = {value if isinstance(value, str) else vector(value)}\n" for name, value in keys.items())
    return f'[[bodies]]\nshape = "{shape}"\ndensity = 1\nmotion = "{motion}"\nposition = {vector(position)}\n{more}'


def case(title, cells, shape, bodies, steps, boundary='"periodic"', fluid="", quantities=(), precision="single"):
    """Returns the text of a case. shape: the keys of the only shape; quantities: axes of drag coefficients. The bodies are written ten
    times, an odd number of steps apart: cli has modes in narrow gaps that change sign every step and fade slowly."""
    every = max(1, steps // 20) * 2 + 1
    parts = [f'title = "{title}"', '[units]\nsystem = "lattice"',
             f"[domain]\nsize = [{', '.join(str(whole(n)) for n in cells)}]\nboundary = {boundary}",
             f'[fluid]\nrelaxation_time = {RELAXATION_TIME}\nprecision = "{precision}"\n{fluid}',
             f'[[shapes]]\nname = "body"\n{shape}', *bodies, f"[run]\nsteps = {10 * every}",
             f"[output]\nbodies = {{ every = {every} }}"]
    parts += [f'[[quantities]]\nname = "drag_{axis}"\ntype = "drag-coefficient"\naxis = "{axis}"' for axis in quantities]
    return "\n".join(parts) + "\n"


def whole(cells):
    if abs(cells - round(cells)) > 1e-9:
        raise ValueError(f"a box of {cells} cells: choose diameters that make it whole")
    return round(cells)


def settled(series, scale):
    """Returns the end of a series of vectors, without what alternates from step to step (see case). ValueError if it has changed by
    more than STEADY of the scale in the last fifth of the run."""
    smooth = (series[:-2] + 2 * series[1:-1] + series[2:]) / 4
    if (change := max(abs(smooth[-1] - smooth[-3])) / scale) > STEADY:
        raise ValueError(f"not steady: the last fifth of the run changed it by {change:.1e} of itself; it needs more steps")
    return smooth[-1]


def alternating(series, scale):
    """Returns what the end of a series has that changes its sign every step, in percent of the scale."""
    return 100 * max(abs(series[-1] - 2 * series[-2] + series[-3])) / 4 / scale


def drag(run, outcome, axis="x", volume=None):
    """Returns the drag coefficient of fixed bodies along an axis, with the steady force in place of that of the last step. Takes the volume
    of a body where the keys of its shape do not tell it."""
    scene = tomllib.loads(run.case)
    forces = outcome.bodies.array("force")
    i = "xyz".index(axis)
    displaced = forces.shape[1] * (volume or volume_of(scene["shapes"][0])) * scene["fluid"]["body_force"][i]
    whole = forces.sum(1)
    return outcome.quantity(f"drag_{axis}") * (settled(whole, max(abs(whole[-1])))[i] + displaced) / (whole[-1, i] + displaced)


def volume_of(shape):
    """Returns the volume of a sphere, an ellipsoid, a box or a cylinder from the keys of its case."""
    if shape["type"] == "box":
        return math.prod(shape["edges"])
    if shape["type"] == "cylinder":
        return math.pi / 4 * shape["diameter"]**2 * shape["length"]
    return math.pi / 6 * math.prod(shape.get("diameters", [shape.get("diameter")] * 3))


def percent(found, exact):
    return 100 * (found / exact - 1)


def mean_and_spread(errors):
    """Returns the mean over the places on the lattice, and the standard deviation of one of them."""
    mean = sum(errors) / len(errors)
    return mean, math.sqrt(sum((e - mean)**2 for e in errors) / max(1, len(errors) - 1))


def summary(problem, measured, fine):
    """Returns figures of a problem whose runs are named SETUP.dD.placeN and have errors: of each setup and D the mean over the places
    and the spread, the largest of the means at the fine D, and the largest alternating part."""
    groups = {}
    for key, found in measured.items():
        groups.setdefault(key.rsplit(".", 1)[0], {})[key] = found
    figures = {}
    for group, members in groups.items():
        for name in (n for n in next(iter(members.values())) if n.endswith("error")):
            mean, spread = mean_and_spread([found[name] for found in members.values()])
            figures[f"accuracy.{problem}.{group}.{name}"] = Found(mean, tuple(members))
            figures[f"accuracy.{problem}.{group}.{name.removesuffix('error')}spread"] = Found(spread, tuple(members))
    if found := [values["alternating"] for values in measured.values() if "alternating" in values]:
        figures[f"accuracy.{problem}.alternating"] = Found(max(found), ())
    finest = [f.value for name, f in figures.items() if f".d{fine}." in name and name.endswith("error")]
    if finest:
        figures[f"accuracy.{problem}.error"] = Found(max(finest, key=abs), ())
    return figures
