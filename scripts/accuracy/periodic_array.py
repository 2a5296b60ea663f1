"""Flow through a simple cubic array of spheres: the scene and its reference, shared by several problems.

A body force drives slow flow past a sphere in a periodic cube of a whole number of cells; the diameter is what gives
the solid fraction exactly. K = F / (6 pi mu a U), F the whole force on the sphere (at its wall, and the body force on
its volume), U the mean velocity over the whole cube relative to the sphere. Reference: reference/01_periodic_arrays_*
(computed; Sangani, Acrivos, Int. J. Multiphase Flow 8 (1982) 343; Zick, Homsy, J. Fluid Mech. 115 (1982) 13).
"""
import csv
import math
import pathlib
import random
import tomllib

from case_text import case_text, cube, sphere

REFERENCE = pathlib.Path(__file__).parent / "reference"
REYNOLDS = 0.01  # U D / nu: inertia adds less than 1e-5 to K (it grows with the square)


def exact_drag(fraction):
    """K of the simple cubic array: of the table, or, for other fractions up to 0.1, of the series (good to 1e-6 there)."""
    with open(REFERENCE / "01_periodic_arrays_stokes.csv") as stream:
        rows = csv.DictReader(line for line in stream if not line.startswith("#"))
        table = {float(row["phi"]): float(row["K_computed"]) for row in rows if row["lattice"] == "SC"}
    if fraction in table:
        return table[fraction]
    if fraction > 0.1:
        raise ValueError(f"there is no drag of a solid fraction of {fraction}")
    with open(REFERENCE / "01_periodic_arrays_series.toml", "rb") as stream:
        series = tomllib.load(stream)["sangani_acrivos_SC"]
    chi = (fraction / series["phi_max"]) ** (1 / 3)
    return sum(q * chi**s for s, q in enumerate(series["q"]))


def cube_of(fraction, cells_across):
    """(edge of the cube in cells, diameter): the whole edge whose diameter is nearest to cells_across."""
    ratio = (6 * fraction / math.pi) ** (1 / 3)
    edge = round(cells_across / ratio)
    return edge, edge * ratio


def offsets(number):
    """Positions of a centre in its cell, [0, 1)^3: random, always the same."""
    generator = random.Random(1959)
    return [tuple(round(generator.random(), 6) for _ in range(3)) for _ in range(number)]


def drive(fraction, edge, diameter, viscosity, speed):
    """The acceleration of the fluid that balances the exact drag at this mean velocity."""
    return 3 * math.pi * viscosity * diameter * speed * exact_drag(fraction) / edge**3


def fixed_case(fraction, cells_across, offset, relaxation_time, fluid=None, coupling=None, change=1e-4, position=None):
    """The text of the case. It ends when K has less than `change` still before it, looked at 30 times in L^2 / nu (some 40 e-foldings of the slowest mode),
    after even numbers of steps: in a box of an even number of cells (in no other) the lattice keeps a staggered mode, and
    with it the drag alternates from step to step by some 5e-5 of it; with cli walls at solid fraction 0.45 in 6 cells by
    2e-3, which take 500 steps to fade by e. Hence the least number of steps."""
    edge, diameter = cube_of(fraction, cells_across)
    viscosity = (relaxation_time - 0.5) / 3
    middle = edge // 2
    force = drive(fraction, edge, diameter, viscosity, REYNOLDS * viscosity / diameter)
    return case_text(
        f"Simple cubic array, solid fraction {fraction:g}, {diameter:.3f} cells across", domain=cube(edge),
        fluid=dict(relaxation_time=relaxation_time, **(fluid or {}), body_force=[force, 0, 0]), coupling=coupling,
        shapes=[sphere(diameter)],
        bodies=[dict(shape="sphere", density=1, motion="fixed", position=position or [middle + o for o in offset])],
        run=dict(steps=20 * max(500, round(edge**2 / viscosity)),
                 steady=dict(quantity="K", change=change, every=max(4, 2 * round(edge**2 / viscosity / 60)))),
        quantities=[dict(name="K", type="drag-coefficient", axis="x")])


def drag_error(fraction, outcome):
    """Of a run of fixed_case, in percent. ValueError if it did not settle."""
    if outcome.report["exit_reason"] != "steady":
        raise ValueError(f"the drag was not steady after {outcome.report['steps']} steps")
    return 100 * (outcome.quantity("K") / exact_drag(fraction) - 1)


def mean(values):
    return sum(values) / len(values)


def root_mean_square(values):
    return math.sqrt(mean([v * v for v in values]))
