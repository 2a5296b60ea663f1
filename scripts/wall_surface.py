"""Walls of triangles in pictures: their surfaces from the files of a case, where they are at a time."""
import csv
import pathlib

import numpy as np

from body_shapes import rotation


def triangles_of(file):
    """Returns the corners [T, 3, 3] of a binary STL file or an OBJ file; ValueError for another."""
    data = pathlib.Path(file).read_bytes()
    if len(data) >= 84 and len(data) == 84 + 50 * int.from_bytes(data[80:84], "little"):
        rows = np.frombuffer(data[84:], np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]))
        return rows["corners"].astype(float)
    if pathlib.Path(file).suffix == ".obj":
        lines = [line.split() for line in data.decode().splitlines()]
        points = np.array([line[1:4] for line in lines if line[:1] == ["v"]], float)
        faces = [[int(word.split("/")[0]) - 1 for word in line[1:]] for line in lines if line[:1] == ["f"]]
        return np.array([points[[face[0], face[k], face[k + 1]]] for face in faces for k in range(1, len(face) - 1)])
    raise ValueError(f"{file}: neither a binary STL file nor an OBJ file")


def about(axis, angle):
    """Returns the matrix of a rotation by an angle (radian)."""
    return rotation([np.cos(angle / 2), *(np.sin(angle / 2) * axis)])


def turned_as_at_rest(wall):
    """Returns the matrix from the file's frame to the domain's."""
    if "axis_angle" in wall:
        axis = np.array(wall["axis_angle"]["axis"], float)
        return about(axis / np.linalg.norm(axis), np.radians(wall["axis_angle"]["degrees"]))
    if "axis" in wall:
        axis = np.array(wall["axis"], float) / np.linalg.norm(wall["axis"])
        across = np.cross((0, 0, 1), axis)
        size = np.linalg.norm(across)
        return about(across / size if size > 0 else np.array([1.0, 0, 0]), np.arctan2(size, axis[2]))
    return rotation(np.array(wall.get("orientation", (1, 0, 0, 0)), float) / np.linalg.norm(wall.get("orientation", (1, 0, 0, 0))))


def is_number(text):
    try:
        return float(text) == float(text)
    except ValueError:
        return False


def from_table(file, time):
    """Returns displacement and rotation vector at a time from a CSV file of a motion (cases/README.md, walls.motion): cubics with
    the slopes of parabolas through three lines, 0 at both ends; before and after it what the first and the last line say."""
    lines = [line.strip() for line in file.read_text("utf-8-sig").splitlines()]
    rows = csv.reader([line for line in lines if line and not line.startswith("#")], skipinitialspace=True)
    rows = np.array([[float(word) for word in row] for row in rows if is_number(row[0])])  # not headings
    t, moved = rows[:, 0], rows[:, 1:]
    slopes = np.gradient(moved, t, axis=0)
    slopes[[0, -1]] = 0
    k = np.clip(np.searchsorted(t, time, "right") - 1, 0, len(t) - 2)
    length = t[k + 1] - t[k]
    s = np.clip((time - t[k]) / length, 0, 1)
    at = ((1 + 2 * s) * (1 - s)**2 * moved[k] + s**2 * (3 - 2 * s) * moved[k + 1]
          + length * s * (1 - s) * ((1 - s) * slopes[k] - s * slopes[k + 1]))
    return at[:3], at[3:]


def at_time(wall, folder, time):
    """Returns the corners [T, 3, 3] of a wall of a case's folder, moved as its `motion` says."""
    turned, position = turned_as_at_rest(wall), np.array(wall.get("position", (0, 0, 0)), float)
    points = position + wall.get("scale", 1) * triangles_of(folder / wall["file"]) @ turned.T
    motion = wall.get("motion", {})
    axis = motion.get("axis", turned[:, 2])
    axis = np.eye(3)["xyz".index(axis)] if isinstance(axis, str) else np.array(axis, float) / np.linalg.norm(axis)
    point = np.array(motion.get("point", position), float)
    to, spin = np.array(motion.get("velocity", (0, 0, 0)), float) * time, axis * motion.get("angular_velocity", 0) * time
    if swing := motion.get("oscillation"):
        to += np.array(swing["amplitude"], float) * np.sin(2 * np.pi * swing["frequency"] * time + np.radians(swing.get("phase", 0)))
    if "table" in motion:
        moved, rotated = from_table(folder / motion["table"], time)
        to, spin = to + moved, spin + rotated
    angle = np.linalg.norm(spin)
    spun = about(spin / angle if angle > 0 else axis, angle)
    return point + to + (points - point) @ spun.T


def outline(corners, view, crease=30):
    """Returns the edges [N, 2, 3] of triangles [T, 3, 3] that a drawing has: those of one triangle, those whose
    triangles turn by more than `crease` degrees, and those between a triangle that faces the eye and one that does not."""
    points, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    triangles = index.reshape(-1, 3)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges, edge, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    of_edge = np.argsort(edge.ravel(), kind="stable") % len(triangles)  # triangles, edge by edge
    begin = np.concatenate([[0], np.cumsum(count)])
    first, last = of_edge[begin[:-1]], of_edge[begin[1:] - 1]
    sharp = np.einsum("ij,ij->i", normals[first], normals[last]) < np.cos(np.radians(crease))
    facing = normals @ view[2] > 0
    return points[edges[(count == 1) | sharp | (facing[first] != facing[last])]]
