#!/usr/bin/python3
"""scripts/body_shapes.py: silhouettes and cuts of meshes against the support function, the planes of the faces and the
volume; and what it refuses."""
import pathlib
import sys
import types

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))
from body_shapes import Mesh, NoMesh, cut, meshes_of_kinds, silhouette, turns  # noqa: E402
from silt_results.surfaces import rotations  # noqa: E402

random = np.random.default_rng(3)


def flat_sided(vertices, triangles):
    """A mesh whose normals are its faces'."""
    vertices, triangles = np.array(vertices, float), np.array(triangles)
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    return dict(vertices=vertices, triangles=triangles, normals=normals / np.linalg.norm(normals, axis=1)[:, None],
                triangle_normals=np.repeat(np.arange(len(triangles))[:, None], 3, axis=1))


def ellipsoid(half_axes, rings=16, sectors=24):
    """Rings of vertices about z between two poles."""
    polar, azimuth = np.meshgrid(np.arange(1, rings) * np.pi / rings, np.arange(sectors) * 2 * np.pi / sectors, indexing="ij")
    ring = np.stack([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)], axis=-1)
    vertices = np.vstack([ring.reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    north, south, last = len(vertices) - 2, len(vertices) - 1, (rings - 2) * sectors
    triangles = []
    for i in range(sectors):
        j = (i + 1) % sectors
        triangles += [[north, i, j], [south, last + j, last + i]]
        for r in range(0, last, sectors):
            triangles += [[r + i, r + sectors + i, r + sectors + j], [r + i, r + sectors + j, r + j]]
    return flat_sided(vertices * half_axes, triangles)


def box(half_edges):
    vertices = [[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return flat_sided(np.array(vertices) * half_edges, [t for q in quads for t in (q[:3], [q[0], q[2], q[3]])])


def tetrahedron(shift):
    corners = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2.0]]) + shift
    return flat_sided(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


def area(polygon):
    x, y = polygon.T
    return 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))


def volume(mesh):
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def check_silhouette(mesh, position, turned, view):
    """It is convex and reaches exactly as far as the vertices in every direction."""
    outline = silhouette(mesh, position, turned, view)
    seen = (position + mesh.vertices @ turned.T) @ view[:2].T
    along = np.roll(outline, -1, axis=0) - outline
    after = np.roll(along, -1, axis=0)
    assert (along[:, 0] * after[:, 1] - along[:, 1] * after[:, 0] > -1e-12).all()
    for angle in np.linspace(0, 2 * np.pi, 64, endpoint=False):
        d = np.array([np.cos(angle), np.sin(angle)])
        assert abs((outline @ d).max() - (seen @ d).max()) < 1e-12


def check_cuts(mesh, position, turned, axis):
    """The corners of cuts are in the plane and on the surface; areas over the levels make up the volume."""
    points = position + mesh.vertices @ turned.T
    normals = mesh.facing / np.linalg.norm(mesh.facing, axis=1)[:, None] @ turned.T
    offsets = np.einsum("ij,ij->i", normals, points[mesh.triangles[:, 0]])
    lower, upper = points[:, axis].min(), points[:, axis].max()
    levels = lower + (np.arange(400) + 0.5) * (upper - lower) / 400
    areas = []
    for level in levels:
        polygon = cut(mesh, position, turned, axis, level)
        assert (np.abs(polygon[:, axis] - level) < 1e-12).all()
        assert (np.abs((polygon @ normals.T - offsets).max(axis=1)) < 1e-12).all()
        areas.append(area(np.delete(polygon, axis, axis=1)))
    assert (np.array(areas) > 0).all()
    assert abs(np.mean(areas) * (upper - lower) / volume(mesh) - 1) < 1e-3
    for outside in (lower - 0.1, upper + 0.1):
        assert len(cut(mesh, position, turned, axis, outside)) == 0


def refused(act, *words):
    try:
        act()
    except NoMesh as error:
        assert all(word in str(error) for word in words), error
    else:
        raise AssertionError(f"not refused: {words}")


for part in (ellipsoid([1.4, 0.5, 0.9]), box([0.5, 1.1, 0.8]), tetrahedron(-0.5), tetrahedron(3.0)):
    mesh = Mesh(**part)
    assert mesh.reach == np.linalg.norm(part["vertices"], axis=1).max()
    for axis in (0, 1, 2, 0, 1, 2):
        q = random.normal(size=(2, 4))
        q /= np.linalg.norm(q, axis=1, keepdims=True)
        turned, view = rotations(q)
        sizes = turns({"kind": [0, 0], "orientation": q, "scale": np.array([0.5, 3])})
        assert np.allclose(sizes, [0.5 * turned, 3 * view])
        position = random.normal(size=3)
        check_silhouette(mesh, position, turned, view)
        check_cuts(mesh, position, turned, axis)
check_silhouette(Mesh(**box([1, 1, 1])), np.zeros(3), np.eye(3), np.eye(3))  # faces seen edge-on

opened = tetrahedron(0)
opened = dict(opened, triangles=opened["triangles"][1:], triangle_normals=opened["triangle_normals"][1:])
refused(lambda: Mesh(**opened), "not closed")
turned_over = tetrahedron(0)
turned_over["triangles"][0] = turned_over["triangles"][0][::-1]
refused(lambda: Mesh(**turned_over), "not closed")
series = types.SimpleNamespace(meshes=[[box([1, 1, 1])], []], kinds=["boxes", "cones"], columns={"kind": np.array([0, 0])})
assert len(meshes_of_kinds(series)[0]) == 1
series.columns["kind"][1] = 1
refused(lambda: meshes_of_kinds(series), "'cones'", "run the case again")
series.columns["kind"][1] = 7
refused(lambda: meshes_of_kinds(series), "number 7")
print("silhouettes and cuts are those of the meshes")
