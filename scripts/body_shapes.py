"""The bodies of bodies.h5 in pictures: silhouettes seen from afar and cuts by a plane, from the meshes of their parts."""
import numpy as np

from silt_results.surfaces import rotations


class NoMesh(ValueError):
    """Raised where the file does not say what the bodies look like."""


class Mesh:
    """A Mesh is the closed surface of a part, convex but for bodies of triangles, in the frame of its body (origin at the centre of mass).

    vertices [V, 3]; triangles [T, 3], vertices counter-clockwise seen from outside; normals [N, 3], outward unit
    normals of the surface; triangle_normals [T, 3], which of them the corners of each triangle have.
    """

    def __init__(self, vertices, triangles, normals, triangle_normals):
        self.vertices, self.triangles = np.asarray(vertices, float), np.asarray(triangles, int)
        self.normals, self.triangle_normals = np.asarray(normals, float), np.asarray(triangle_normals, int)
        self.reach = np.linalg.norm(self.vertices, axis=1).max()  # the furthest point from the body's origin
        self.centre = self.vertices.mean(axis=0)
        a, b, c = (self.vertices[self.triangles[:, k]] for k in range(3))
        self.facing = np.cross(b - a, c - a)  # outward, as long as twice the triangle's area
        directed = np.stack([self.triangles, np.roll(self.triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
        owner = {tuple(edge): i // 3 for i, edge in enumerate(directed)}
        once = directed[:, 0] < directed[:, 1]
        self.edges = directed[once]  # [E, 2] vertices, each edge once
        try:
            self.sides = np.array([[owner[a, b], owner[b, a]] for a, b in map(tuple, self.edges)])
        except KeyError:
            raise NoMesh("the mesh of a body is not closed") from None
        if len(directed) != 2 * len(self.edges) or len(owner) != len(directed):
            raise NoMesh("the mesh of a body is not closed")
        self.is_convex = self._is_convex()

    def _is_convex(self):
        """Says whether at every edge each triangle is behind the plane of the other."""
        first, second = self.triangles[self.sides[:, 0]], self.triangles[self.sides[:, 1]]
        ahead = np.einsum("ed,ekd->ek", self.facing[self.sides[:, 0]], self.vertices[second] - self.vertices[first[:, :1]])
        return bool(ahead.max() <= 1e-5 * np.linalg.norm(self.facing, axis=1).max() * self.reach)


def turns(rows):
    """Returns the matrices [n, 3, 3] from the surfaces of kinds to bodies in the world: rotations, times the size of each body."""
    scales = rows.get("scale", np.ones(len(rows["kind"])))
    return scales[:, None, None] * rotations(rows["orientation"])


def meshes_of_kinds(series):
    """Returns the meshes of each kind's parts; raises NoMesh where the file has none of a kind that has bodies."""
    for kind in np.unique(series.columns["kind"]):
        if not 0 <= kind < len(series.meshes) or not series.meshes[kind]:
            name = f"'{series.kinds[kind]}'" if 0 <= kind < len(series.kinds) else f"number {kind}"
            raise NoMesh(f"bodies.h5 holds no mesh of the kind {name}: run the case again")
    return [[Mesh(**part) for part in parts] for parts in series.meshes]


def corners_of(lower, upper):
    """Returns the eight corners of a box."""
    return np.array([[(lower, upper)[i >> d & 1][d] for d in range(3)] for i in range(8)])


def in_order(points):
    """Returns the corners of a convex polygon counter-clockwise."""
    x, y = (points - points.mean(axis=0)).T
    return points[np.argsort(np.arctan2(y, x))]


def silhouette(mesh, position, turned, view):
    """Returns the outline [n, 2] of a part seen along the third row of `view` (rows: right, up, towards the eye), its
    body at `position` turned by the matrix `turned`: where triangles that face the eye meet others."""
    front = mesh.facing @ (turned.T @ view[2]) > 0
    rim = np.unique(mesh.edges[front[mesh.sides[:, 0]] != front[mesh.sides[:, 1]]])
    return in_order((position + mesh.vertices[rim] @ turned.T) @ view[:2].T)


def silhouettes(mesh, position, turned, view):
    """Returns polygons [n, 2] that cover what is seen of a part: its outline, or, if it is not convex, the triangles that face the eye."""
    if mesh.is_convex:
        return [silhouette(mesh, position, turned, view)]
    front = mesh.facing @ (turned.T @ view[2]) > 0
    return list(((position + mesh.vertices @ turned.T) @ view[:2].T)[mesh.triangles[front]])


def cuts(mesh, position, turned, axis, level):
    """Returns the outlines [n, 3] of a part's points with coordinate `axis` at `level`; those of holes go round the other way."""
    if mesh.is_convex:
        polygon = cut(mesh, position, turned, axis, level)
        return [polygon] if len(polygon) else []
    points = position + mesh.vertices @ turned.T
    height = points[:, axis] - level
    after = {}  # of an edge that goes up, in its triangle, the edge there that goes down: the next triangle's first
    above = height[mesh.triangles] > 0
    for triangle in mesh.triangles[above.any(axis=1) & ~above.all(axis=1)]:
        edges = list(zip(triangle, np.roll(triangle, -1)))
        up = next(e for e in edges if height[e[0]] <= 0 < height[e[1]])
        down = next(e for e in edges if height[e[1]] <= 0 < height[e[0]])
        after[up] = down[::-1]
    loops = []
    while after:
        start, edge = next(iter(after.items()))
        loop = [after.pop(start)]
        while loop[-1] in after:
            loop.append(after.pop(loop[-1]))
        a, b = np.array(loop).T
        share = (height[a] / (height[a] - height[b]))[:, None]
        loops.append(points[a] + share * (points[b] - points[a]))
    return loops


def cut(mesh, position, turned, axis, level):
    """Returns the polygon [n, 3] of a part's points with coordinate `axis` at `level`, in order; empty if there are none."""
    points = position + mesh.vertices @ turned.T
    height = points[:, axis] - level
    a, b = mesh.edges[(height[mesh.edges[:, 0]] > 0) != (height[mesh.edges[:, 1]] > 0)].T
    if len(a) < 3:
        return np.zeros((0, 3))
    share = (height[a] / (height[a] - height[b]))[:, None]
    crossing = points[a] + share * (points[b] - points[a])
    across = [d for d in range(3) if d != axis]
    x, y = (crossing - crossing.mean(axis=0))[:, across].T
    return crossing[np.argsort(np.arctan2(y, x))]


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
