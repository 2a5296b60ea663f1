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


def reach(part):
    """Radius about the body's origin that the part stays within."""
    size = np.linalg.norm(part["vertices"], axis=1).max() if part["type"] == "polyhedron" else part["size"].sum()
    return np.linalg.norm(part["position"]) + size


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
    size, kind = part["size"], part["type"]
    seen = lambda local: (centre + local @ turned.T) @ view[:2].T  # noqa: E731
    if kind == "box":
        return hull(seen(np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, 8).T * size))
    if kind == "polyhedron":
        return hull(seen(part["vertices"]))
    angle = np.linspace(0, 2 * np.pi, 33)[:-1]
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    if kind == "ellipsoid":  # furthest along each direction across the view
        normal = (circle @ view[:2]) @ turned * size
        return seen(size * normal / np.linalg.norm(normal, axis=1, keepdims=True))
    if kind == "cylinder":
        rim = np.column_stack([size[0] * circle, np.full(len(circle), size[1])])
        return hull(seen(np.vstack([rim, rim * [1, 1, -1]])))
    circle = size[0] * circle
    half = turned[:, 2] * (size[1] if kind == "capsule" else 0)
    ends = [(centre + half) @ view[:2].T, (centre - half) @ view[:2].T]
    return circle + ends[0] if not half.any() else hull(np.vstack([circle + e for e in ends]))


def face_planes(part):
    """Outward unit normals and offsets of a polyhedron's faces."""
    normals, offsets = [], []
    for loop in part["faces"]:
        corners = part["vertices"][loop]
        normal = np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0]).sum(axis=0)
        normals.append(normal / np.linalg.norm(normal))
        offsets.append((corners @ normals[-1]).mean())
    return np.array(normals), np.array(offsets)


def signed_distance(part, centre, turned, points):
    """Distance of points [..., 3] to the surface of a part, negative inside. For cuts: of an ellipsoid and of a
    polyhedron a function of the same sign, exact on the surface and to first order beside it (on faces)."""
    local, size, kind = (points - centre) @ turned, part["size"], part["type"]
    if kind == "box":
        outside = np.abs(local) - size
        return np.linalg.norm(np.maximum(outside, 0), axis=-1) + np.minimum(outside.max(axis=-1), 0)
    if kind == "polyhedron":
        normals, offsets = face_planes(part)
        return (local @ normals.T - offsets).max(axis=-1)
    if kind == "ellipsoid":
        scaled = np.linalg.norm(local / size, axis=-1)
        slope = np.linalg.norm(local / size**2, axis=-1)
        return scaled * (scaled - 1) / np.maximum(slope, 1e-300)
    if kind == "cylinder":
        outside = np.stack([np.hypot(local[..., 0], local[..., 1]) - size[0], np.abs(local[..., 2]) - size[1]], axis=-1)
        return np.linalg.norm(np.maximum(outside, 0), axis=-1) + np.minimum(outside.max(axis=-1), 0)
    if kind == "capsule":
        local = local.copy()
        local[..., 2] -= np.clip(local[..., 2], -size[1], size[1])
    return np.linalg.norm(local, axis=-1) - size[0]
