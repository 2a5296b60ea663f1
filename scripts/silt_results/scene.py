"""Reads scene.h5: the case as it was run, with its overrides, as far as a picture needs it.

    scene = Scene("out/scene.h5")
    scene.title, scene.gravity, scene.domain    of the case; domain: lower and upper corner
    scene.sides                                 ["periodic", "periodic", "no-slip", ...]: x-low, x-high, y-low, ...
    scene.driven                                names of kinds that hold bodies which are fixed or driven
    scene.walls                                 a Wall for each of [[walls]]
    scene.walls[0].corners(2.5)                 its triangles [T, 3, 3] at a time, as the program moved them
"""
import h5py
import numpy as np

from .body_series import text
from .surfaces import rotations


class Wall:
    """A Wall is a tube (position, axis, sizes: {"radius": 3.0}) or a mesh (vertices, triangles, hollow: a vessel), in the units of
    the case."""

    def __init__(self, group):
        self.name, self.type = text(group.attrs["name"]), text(group.attrs["type"])
        self.position = group.attrs["position"]
        if self.type != "mesh":
            self.axis = group.attrs["axis"]
            self.sizes = {key: float(value) for key, value in group.attrs.items() if key not in ("name", "type", "position", "axis")}
            self.radius = self.sizes.get("radius")
            return
        self.hollow = text(group.attrs["solid"]) == "outside"
        self.vertices, self.triangles, self.table = group["vertices"][:], group["triangles"][:].astype(int), group["table"][:]
        self.orientation, self.velocity, self.angular_velocity, self.amplitude = (
            group.attrs[name] for name in ("orientation", "velocity", "angular_velocity", "amplitude"))
        self.frequency = float(group.attrs["frequency"])

    @property
    def moves(self):
        """Says whether the surface of a mesh goes anywhere; that of a tube slides along itself."""
        return self.type == "mesh" and (len(self.table) > 1 or self.velocity.any() or self.angular_velocity.any()
                                        or bool(self.amplitude.any() and self.frequency))

    def from_table(self, time):
        """Returns displacement and rotation vector at a time from the table of a motion (cases/README.md, walls.motion): cubics with
        the slopes of parabolas through three rows, 0 at both ends; before and after it what the first and the last row say."""
        if len(self.table) < 2:
            return (self.table[0, 1:] if len(self.table) else np.zeros(6)).reshape(2, 3)
        t, moved = self.table[:, 0], self.table[:, 1:]
        slopes = np.gradient(moved, t, axis=0)
        slopes[[0, -1]] = 0
        k = np.clip(np.searchsorted(t, time, "right") - 1, 0, len(t) - 2)
        length = t[k + 1] - t[k]
        s = np.clip((time - t[k]) / length, 0, 1)
        return ((1 + 2 * s) * (1 - s)**2 * moved[k] + s**2 * (3 - 2 * s) * moved[k + 1]
                + length * s * (1 - s) * ((1 - s) * slopes[k] - s * slopes[k + 1])).reshape(2, 3)

    def points(self, time):
        """Returns where the vertices of a mesh are at a time."""
        displacement, rotation = self.from_table(time)
        to = self.position + self.velocity * time + self.amplitude * np.sin(2 * np.pi * self.frequency * time) + displacement
        spin = self.angular_velocity * time + rotation
        angle = np.linalg.norm(spin)
        turn = np.append(np.cos(angle / 2), np.sin(angle / 2) * spin / (angle or 1))
        turned, as_at_rest = rotations(np.array([turn, self.orientation]))
        return to + self.vertices @ as_at_rest.T @ turned.T

    def corners(self, time):
        """Returns the corners [T, 3, 3] of a mesh's triangles at a time, counter-clockwise seen from outside the surface."""
        return self.points(time)[self.triangles]


class Scene:
    def __init__(self, path):
        with h5py.File(path, "r") as f:
            self.title, self.length_unit, self.time_unit = (text(f.attrs[name]) for name in ("title", "length_unit", "time_unit"))
            self.gravity = f.attrs["gravity"]
            self.domain = np.array([np.zeros(3), f.attrs["domain_upper"]])
            self.sides = [text(side) for side in f.attrs["sides"]]
            self.driven = [text(kind) for kind in f.attrs.get("driven_kinds", [])]
            self.walls = [Wall(f["walls"][str(k)]) for k in range(len(f["walls"]))]

    @property
    def up(self):
        """The axis against gravity; z without it."""
        return int(np.argmax(np.abs(self.gravity))) if self.gravity.any() else 2

    @property
    def periodic(self):
        return [self.sides[2 * axis] == "periodic" for axis in range(3)]
