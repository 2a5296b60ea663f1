"""A bed of equal spheres dropped one after another, in diameters: periodic across, z upwards from the centres of the lowest.

The lowest spheres lie at random on a floor until no more finds room. Each of the others lies on three, at the lowest place of all that
there are, which for that reason bear its weight. So spheres touch as in a dry bed: nearly, because surfaces are GAP apart.
"""
import itertools

import numpy as np

GAP = 1e-5
CONTACT = 1 + GAP                # of centres
TRIES = 2000                     # for room on the floor


def packing(count, width, seed):
    """Returns the centres, [count, 3]."""
    generator, bed, places = np.random.default_rng(seed), np.empty((0, 3)), np.empty((0, 3))
    for x, y in generator.random((TRIES, 2)) * width:
        if has_room(np.array([x, y, 0]), bed, width) and len(bed) < count:
            bed, places = added(bed, places, np.array([x, y, 0]), width)
    while len(bed) < count:
        bed, places = added(bed, places, places[places[:, 2].argmin()], width)
    return bed


def across(away, width):
    """Returns vectors to the nearest of periodic images."""
    return away - [width, width, 0] * np.round(away / width)


def has_room(place, bed, width):
    return (np.linalg.norm(across(bed - place, width), axis=1) > CONTACT - 1e-9).all()


def added(bed, places, new, width):
    """Returns the bed with a sphere more, and the places on three spheres where another has room."""
    near = across(bed - new, width)
    near = near[np.linalg.norm(near, axis=1) < 2 * CONTACT]
    bed = np.vstack([bed, new])
    found = [new + at for pair in itertools.combinations(near, 2) if (at := resting(*pair)) is not None]
    kept = [at % [width, width, np.inf] for at in (*places, *found) if has_room(at, bed, width)]
    return bed, np.array(kept).reshape(-1, 3)


def resting(a, b):
    """Returns the centre of a sphere that lies on spheres at 0, a and b, or None."""
    normal = np.cross(a, b)
    if abs(normal[2]) < 1e-9:
        return None
    middle = np.linalg.solve([a, b, normal], [a @ a / 2, b @ b / 2, 0])
    if (square := CONTACT**2 - middle @ middle) < 0:
        return None
    return middle + np.sqrt(square) * np.sign(normal[2]) * normal / np.linalg.norm(normal)


def solid_fraction(bed, width, low, high):
    """Returns the solid share of the space between two heights."""
    heights = low + (np.arange(2000) + 0.5) / 2000 * (high - low)
    sections = np.pi * np.maximum(0, 0.25 - (heights[:, None] - bed[:, 2])**2).sum(1) / width**2
    return float(sections.mean())
