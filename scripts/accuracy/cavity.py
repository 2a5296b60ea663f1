"""Lid-driven cavities: the cube at Re = 1000, and the square at Re = 100.

Velocities on the two lines through the middle, along and across the lid's motion. The figures are the largest deviations, in
percent of the lid's velocity, at the points of the reference between the walls. Cube: Albensoeder, Kuhlmann, J. Comput.
Phys. 206 (2005) 536, Tables 5 and 6 (96^3 Chebyshev). Square, as a slab periodic across: Ghia, Ghia, Shin, J. Comput. Phys. 48 (1982) 387
(itself good to about 1 %). The lid is at the low side of x and moves along y; an odd number of cells, so that the lines go through cells.
"""
import csv
import pathlib

import numpy as np

from case_text import case_text
from problem import Claim, Curve, Found, Goal, Run

REFERENCE = pathlib.Path(__file__).parent / "reference"
LID = 0.1                # cells a step; the steady flow does not depend on the speed of sound with this equilibrium
CUBES, SQUARES = (49, 65, 97), (33, 65)
REYNOLDS = {"cube": 1000, "square": 100}
DEPTH = {"square": 4}    # cells of the slab

GOALS = [Goal("accuracy.cavity.cube.n97.single.error", 1), Goal("accuracy.cavity.square.n65.single.error", 1)]
SHORT_GOALS = [Goal("accuracy.cavity.square.n33.single.error", 2)]
CLAIMS = {
    "accuracy.cavity.cube.n{N}.{precision}.error": Claim(
        "velocity on the middle lines, largest deviation over the lid's", "lid-driven cube, Re = 1000", "N = {N}",
        "Albensoeder, Kuhlmann, J. Comput. Phys. 206 (2005) 536, tables 5 and 6", doi="10.1016/j.jcp.2004.12.024", kind="computation"),
    "accuracy.cavity.square.n{N}.{precision}.error": Claim(
        "velocity on the middle lines, largest deviation over the lid's", "lid-driven square, Re = 100", "N = {N}",
        "Ghia, Ghia, Shin, J. Comput. Phys. 48 (1982) 387", doi="10.1016/0021-9991(82)90058-4", kind="computation", uncertainty="1 %")}


def run_of(shape, N, precision):
    turn = round(N / LID)  # steps in which the lid goes one side
    ends = "periodic" if shape == "square" else "no-slip"
    text = case_text(
        f"Lid-driven {shape}, Re = {REYNOLDS[shape]}, {N} cells a side",
        domain=dict(size=[N, N, DEPTH.get(shape, N)],
                    boundary=dict(x=[dict(type="moving", velocity=[0, LID, 0]), "no-slip"], y="no-slip", z=ends)),
        fluid=dict(kinematic_viscosity=LID * N / REYNOLDS[shape], precision=precision),
        run=dict(steps=200 * turn, steady=dict(quantity="energy", change=2e-4, every=turn)),
        output=dict(fields=dict(every=200 * turn, quantities=["velocity"])),
        quantities=[dict(name="energy", type="kinetic-energy")])
    return Run(f"{shape}.n{N}.{precision}", text, dict(shape=shape, N=N, precision=precision))


def runs(level):
    if level == "short":
        return [run_of("square", 33, "single")]
    return [*(run_of("square", N, p) for N in SQUARES for p in ("single", "double")), *(run_of("cube", N, "single") for N in CUBES),
            run_of("cube", 65, "double")]


def table(name, wanted):
    """Returns (coordinate, value) of the rows for which wanted(row)."""
    with open(REFERENCE / name) as stream:
        rows = csv.DictReader(line for line in stream if not line.startswith("#"))
        return [(float(row.get("coord")), float(row["value"])) for row in rows if wanted(row)]


def reference(shape):
    """Returns ((x, v) on the line across the lid, (y, u) on that along it), 0 to 1, the lid at x = 0 moving along y."""
    if shape == "cube":
        name = "10_cavity3d_albensoeder_Re1000.csv"
        lines = [table(name, lambda row, p=p: row["profile"] == p) for p in ("parallel_v_of_x", "normal_u_of_y")]
        return [[(c + 0.5, value) for c, value in line] for line in lines]
    # Ghia's lid is at the top and moves along x: x is our y, the height 1 - our x, the velocity upwards our -u
    of = [table("10_cavity2d_ghia.csv", lambda row, p=p: row["profile"] == p and row["Re"] == "100" and row["flag"] == "0")
          for p in ("u_at_x0.5", "v_at_y0.5")]
    return [(1 - c, value) for c, value in of[0]], [(c, -value) for c, value in of[1]]


def interpolated(values, walls, x):
    """Interpolates the values at the middles of the cells and at the two walls, cubic through the four nearest; x from 0 to 1."""
    n = len(values)
    places = np.concatenate([[0], (np.arange(n) + 0.5) / n, [1]])
    known = np.concatenate([[walls[0]], values, [walls[1]]])
    first = int(np.clip(np.searchsorted(places, x) - 2, 0, n - 2))
    near = places[first:first + 4]
    return sum(known[first + i] * np.prod([(x - near[j]) / (near[i] - near[j]) for j in range(4) if j != i]) for i in range(4))


def deviation(line, values, walls):
    return max(abs(interpolated(values, walls, x) - value) for x, value in line if 0 < x < 1)


def measure(run, outcome):
    if outcome.report["exit_reason"] != "steady":
        raise ValueError("the flow did not become steady")
    velocity = outcome.last_field("velocity") / LID  # [z][y][x][component]
    middle, centre = run.settings["N"] // 2, velocity.shape[0] // 2
    across, along = reference(run.settings["shape"])
    errors = (deviation(across, velocity[centre, middle, :, 1], (1, 0)), deviation(along, velocity[centre, :, middle, 0], (0, 0)))
    return {"error": 100 * max(errors), "along_lid": 100 * errors[0], "across": 100 * errors[1]}


def figures(measured):
    return {f"accuracy.cavity.{key}.error": Found(m["error"], (key,)) for key, m in measured.items()}


def curves(measured):
    lines = {}
    for shape, sizes in (("cube", CUBES), ("square", SQUARES)):
        for N in sizes:
            for precision in ("single", "double"):
                if m := measured.get(f"{shape}.n{N}.{precision}"):
                    lines.setdefault(f"{shape}, {precision}", []).append((m["core_seconds"], m["error"], f"{N}"))
    return [Curve(label, points) for label, points in lines.items()]
