#!/usr/bin/python3
"""Writes reference/stokes_boxes.csv: the Stokes flow in the boxes of the problems, at two finenesses.

A problem has SETUPS (names) and exact(setup, fineness) -> {quantity: value}; the finer one has more points.
"""
import csv
import importlib
import sys

from stokes_scene import REFERENCE

PROBLEMS = ("two_spheres", "sphere_at_wall", "rotating_sphere", "spheroid", "cube", "random_array", "arrangements", "torus", "stirrer")
HEAD = """# Stokes flow around bodies in the boxes that the problems of this folder simulate, computed by stokes_periodic.py
# and stokes_panels.py (scripts/accuracy/stokes_boxes.py). Quantities, lengths and setups as in the module named "problem". change: of the value
# from fewer point forces or panels, relative: a bound of its error.
"""


def rows(problem):
    module = importlib.import_module(problem)
    for setup in module.SETUPS:
        coarse, fine = module.exact(setup, 1), module.exact(setup, 2)
        for quantity, value in fine.items():
            yield [problem, setup, quantity, f"{value:.8g}", f"{abs(coarse[quantity] / value - 1):.0e}"]
            print(*([problem, setup, quantity, f"{value:.8g}", f"{coarse[quantity] / value - 1:.1e}"]), flush=True)


def main(wanted):
    for problem in wanted:
        write(problem, list(rows(problem)))


def write(problem, found):
    """Puts the rows of a problem into the table in place of its old ones."""
    kept = []
    if REFERENCE.exists():
        with open(REFERENCE) as stream:
            kept = [row for row in list(csv.reader(line for line in stream if line[0] != "#"))[1:] if row[0] != problem]
    table = sorted(kept + found, key=lambda row: PROBLEMS.index(row[0]))
    with open(REFERENCE, "w") as stream:
        stream.write(HEAD)
        csv.writer(stream, lineterminator="\n").writerows([["problem", "setup", "quantity", "value", "change"], *table])


if __name__ == "__main__":
    main(sys.argv[1:] or PROBLEMS)
