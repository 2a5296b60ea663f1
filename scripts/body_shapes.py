"""The shapes of bodies.h5 in pictures: silhouettes seen from afar, and cuts by a plane."""
import numpy as np


def rotation(q):
    """Matrix of a unit quaternion w, x, y, z: body to world."""
    w, x, y, z = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def parts_of_kinds(series):
    """The parts of each kind; a kind without any is its bounding sphere."""
    kinds = max([len(series.bounding_radius), *(series.columns["kind"] + 1)], default=0)
    parts = [[p for p in series.parts if p["kind"] == k] for k in range(kinds)]
    for k in range(kinds):
        if not parts[k]:
            radius = series.bounding_radius[k] if k < len(series.bounding_radius) else 0
            parts[k] = [dict(type="sphere", position=np.zeros(3), orientation=np.array([1.0, 0, 0, 0]),
                             size=np.array([radius, 0, 0]))]
    return parts


def placed(part, position, orientation):
    """Centre and rotation of a part of a body, in the world."""
    body = rotation(orientation)
    return position + body @ part["position"], body @ rotation(part["orientation"])


def corners_of(lower, upper):
    """The eight corners of a box."""
    return np.array([[(lower, upper)[i >> d & 1][d] for d in range(3)] for i in range(8)])


def hull(points):
    """Convex hull of points in a plane, counter-clockwise (Andrew's monotone chain)."""
    points = sorted(map(tuple, points))
    lower, upper = [], []
    for chain, order in ((lower, points), (upper, points[::-1])):
        for p in order:
            while len(chain) > 1 and np.cross(np.subtract(chain[-1], chain[-2]), np.subtract(p, chain[-1])) <= 0:
                chain.pop()
            chain.append(p)
    return np.array(lower[:-1] + upper[:-1])


def silhouette(part, centre, turned, view):
    """Outline of a part seen along the third row of `view` (rows: right, up, towards the eye)."""
    size = part["size"]
    if part["type"] == "box":
        corners = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, 8).T * size
        return hull((centre + corners @ turned.T) @ view[:2].T)
    angle = np.linspace(0, 2 * np.pi, 33)[:-1]
    circle = size[0] * np.column_stack([np.cos(angle), np.sin(angle)])
    half = turned[:, 2] * (size[1] if part["type"] == "capsule" else 0)
    ends = [(centre + half) @ view[:2].T, (centre - half) @ view[:2].T]
    return circle + ends[0] if not half.any() else hull(np.vstack([circle + e for e in ends]))


def signed_distance(part, centre, turned, points):
    """Distance of points [..., 3] to the surface of a part, negative inside."""
    local, size = (points - centre) @ turned, part["size"]
    if part["type"] == "box":
        outside = np.abs(local) - size
        return np.linalg.norm(np.maximum(outside, 0), axis=-1) + np.minimum(outside.max(axis=-1), 0)
    if part["type"] == "capsule":
        local = local.copy()
        local[..., 2] -= np.clip(local[..., 2], -size[1], size[1])
    return np.linalg.norm(local, axis=-1) - size[0]
