"""Places for the bodies of a scene at random: close to one another and to sides, and moving towards them."""
import random

import numpy as np
from random_scene import STONE
from symmetry import AXES, UNTURNED, rotation


def extent(shape, n):
    """The largest n·x of a shape in its own frame."""
    reach = dict(sphere=lambda s: s["diameter"] / 2, box=lambda s: np.abs(n) @ s["edges"] / 2,
                 capsule=lambda s: s["diameter"] / 2 + s["length"] / 2 * abs(n[2]),
                 ellipsoid=lambda s: np.linalg.norm(n * s["diameters"]) / 2,
                 cylinder=lambda s: s["diameter"] / 2 * np.hypot(n[0], n[1]) + s["length"] / 2 * abs(n[2]),
                 mesh=lambda s: max(STONE[0] @ n), polyhedron=lambda s: max(s["vertices"] @ n),
                 compound=lambda s: max(p.get("position", [0, 0, 0]) @ n + extent(p, rotation(p.get("orientation")).T @ n) for p in s["parts"]))
    return reach[shape["type"]](shape)


class Crowd(random.Random):
    """Bodies placed one after another: most of them close to an earlier one or to a side, and moving towards it."""

    def __init__(self, seed, tables):
        super().__init__(f"crowd {seed}")
        self.tables, self.size = tables, np.array(tables["domain"]["size"])
        self.periodic = np.array([tables["domain"]["boundary"][axis] == "periodic" for axis in AXES])
        self.shapes = {shape["name"]: shape for shape in tables["shapes"]}
        self.placed = [(wall["position"], np.eye(3), dict(type="mesh")) for wall in tables.get("walls", []) if wall.get("solid") == "inside"]
        self.vessels = [wall for wall in tables.get("walls", []) if wall.get("solid") == "outside"]
        self.tubes = [wall for wall in tables.get("walls", []) if wall["type"] == "tube"]

    def direction(self):
        v = np.array([self.gauss(0, 1) for _ in AXES])
        return v / np.linalg.norm(v)

    def way(self, a, b):
        """From one place to another, the shortest across periodic sides."""
        way = np.subtract(b, a)
        return way - np.where(self.periodic, self.size * np.round(way / self.size), 0)

    def reach(self, body, n):
        return extent(body[2], body[1].T @ n)

    def fits(self, body):
        for n in np.eye(3)[~self.periodic]:
            if n @ body[0] < self.reach(body, -n) + 0.02 or n @ body[0] > n @ self.size - self.reach(body, n) - 0.02:
                return False
        for tube in self.tubes:
            across = np.array([axis != tube["axis"] for axis in AXES])
            if np.linalg.norm(across * (body[0] - tube["point"])) > tube["radius"] - 5.5:
                return False
        for vessel in self.vessels:  # whose corners are 2.5 off its middle, at least
            if any(n @ (body[0] - vessel["position"]) + self.reach(body, n) > 2.5 * vessel["scale"] for n in (*np.eye(3), *-np.eye(3))):
                return False
        for other in self.placed:
            way = self.way(other[0], body[0])
            n = way / np.linalg.norm(way)
            if n @ way < self.reach(other, n) + self.reach(body, -n) + 0.02:
                return False
        return True

    def place_in_box(self, shape, wide):
        """Returns the middle of a box that lies in the domain and in which there is room (None: no room)."""
        for _ in range(100):
            body = (np.array([self.uniform(min(wide, n - wide), max(wide, n - wide)) for n in self.size]), np.eye(3), shape)
            if min(self.size) > 2 * wide and self.fits((body[0], np.eye(3), dict(type="sphere", diameter=2 * wide))):
                self.placed.append(body)
                return [round(x, 6) for x in body[0].tolist()]
        return None

    def place(self, shape, turn, gap):
        """Returns a place for a body, and the direction away from what it is close to (None: no room)."""
        for _ in range(100):
            n, gap = self.direction(), gap if self.random() < 0.8 else 3
            body = [self.size * [self.uniform(0.25, 0.75) for _ in AXES], turn, shape]
            if self.placed and self.random() < 0.8:
                other = self.choice(self.placed)
                body[0] = other[0] + n * (self.reach(other, n) + self.reach(body, -n) + gap)
            elif not self.periodic.all() and not self.vessels:
                n = self.choice([1, -1]) * np.eye(3)[self.choice(np.flatnonzero(~self.periodic))]
                body[0] = np.where(n == 0, body[0], self.reach(body, -n) + gap if n.sum() > 0 else self.size - self.reach(body, -n) - gap)
            body[0] = np.where(self.periodic, body[0] % self.size, body[0])
            if self.fits(body):
                self.placed.append(tuple(body))
                return [round(x, 6) for x in body[0].tolist()], n
        return None, None

    def body(self, entry, **turned):
        """Yields an entry of [[bodies]] with a place and a velocity, if there is room."""
        position, n = self.place(self.shapes[entry["shape"]], rotation(turned.get("orientation")), self.uniform(0.02, 0.4))
        if position is not None:
            kept = {key: value for key, value in entry.items() if key not in ("velocity", "angular_velocity")}
            yield kept | dict(position=position) | self.motion(entry, n) | turned

    def motion(self, entry, n):
        """The keys of a body's motion, against n if it is free to choose."""
        velocity = (-self.uniform(0.005, 0.02) * n + 0.004 * self.direction()).tolist()
        if entry.get("motion") == "fixed":
            return {}
        if entry.get("motion") == "prescribed" and self.random() < 0.5:
            return dict(motion=dict(velocity=velocity, angular_velocity=0.005, axis=self.direction().tolist(),
                                    amplitude=(0.5 * self.direction()).tolist(), frequency=0.01))
        return dict(velocity=velocity) | (dict(angular_velocity=(0.01 * self.direction()).tolist()) if "locked" not in entry else {})

    def bodies(self):
        """The entries of [[bodies]]: those of the scene, and those of its fills, turned at random unless aligned."""
        entries = []
        for body in self.tables.get("bodies", []):
            entries += self.body(body, **({"orientation": body["orientation"]} if "orientation" in body else {}))
        for fill in self.tables.get("fill", []):
            kept = {key: fill[key] for key in ("shape", "material", "density", "temperature", "heat_capacity", "heat_source") if key in fill}
            for _ in range(0 if "every" in fill else fill["count"]):
                orientation = dict(axis=self.direction().tolist(), degrees=self.uniform(0, 180))
                entries += self.body(kept, **({} if fill.get("orientation") == "aligned" else dict(orientation=orientation)))
        return entries

    def fills(self):
        """Fills that go on, each with a box for one aligned body: their places are the middles of their boxes."""
        for fill in self.tables.get("fill", []):
            shape = self.shapes[fill["shape"]]
            if "every" not in fill or shape["type"] in UNTURNED:
                continue
            wide = 1.2 * max(extent(shape, self.direction()) for _ in range(200))
            position = self.place_in_box(shape, wide)
            if position is not None:
                yield {key: value for key, value in fill.items() if key != "gap"} | dict(count=1, arrangement="simple-cubic",
                    orientation="aligned", box=[[x - wide for x in position], [x + wide for x in position]])
