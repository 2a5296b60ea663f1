"""Turned, mirrored and shifted scenes: a symmetry of the lattice acts on the tables of a case and on the results of its run.

A symmetry maps x to M (x - m) + m' + s, where M permutes the axes and reverses some of them, m and m' are the middles of the
domain before and after, and s is a shift by whole cells along periodic axes. Velocities and forces turn with M, angular velocities and
torques with det(M) M. A shape turns with its body: with P = M it is another shape of the same kind, and the body's rotation R becomes
M R / P. P is det(M) where the shape's frame is a matter of the kind: the axis of capsules and cylinders is z, and the mass of parts that
overlap is integrated along z, to 1e-6.
"""
import numpy as np

AXES = "xyz"
UNTURNED = ("capsule", "cylinder", "compound")
POLAR = ("velocity", "acceleration", "body_force", "superficial_velocity", "mean_gradient", "amplitude", "axis")


def rotation(orientation):
    """The matrix of an orientation of a case: none, the direction of the z axis, a quaternion, or axis and angle."""
    if orientation is None:
        return np.eye(3)
    if isinstance(orientation, dict):
        half, axis = np.radians(orientation["degrees"]) / 2, np.array(orientation["axis"]) / np.linalg.norm(orientation["axis"])
        orientation = [np.cos(half), *np.sin(half) * axis]
    if len(orientation) == 3:
        x, y, z = orientation
        orientation = np.array([1 + z, -y, x, 0]) / np.sqrt(2 + 2 * z)
    w, v = orientation[0], np.array(orientation[1:])
    cross = np.cross(np.eye(3), v)
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


def quaternion(matrix):
    """The quaternion [w, x, y, z] of a rotation: the eigenvector of this form, which is 1 at it and less at all others."""
    m = matrix
    form = np.array([[m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
                     [0, m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]],
                     [0, 0, m[1, 1] - m[0, 0] - m[2, 2], m[1, 2] + m[2, 1]], [0, 0, 0, m[2, 2] - m[0, 0] - m[1, 1]]])
    return np.linalg.eigh(form, UPLO="U")[1][:, -1]


def directed(table):
    """A table with an axis, whose letter becomes a direction, which can point to either side."""
    axis = table.get("axis", "z")
    return table | dict(axis=[float(axis == a) for a in AXES] if isinstance(axis, str) else axis)


def with_motion(table):
    return table | dict(motion=directed(table["motion"])) if isinstance(table.get("motion"), dict) else table


class Symmetry:
    def __init__(self, size, order, signs, shift):
        """The new axis a is the axis order[a] of before, reversed where signs[a] is -1; the shift is along new axes."""
        self.order, self.signs, self.shift = list(order), np.array(signs), np.array(shift)
        self.size = np.array(size)[self.order]
        self.matrix = self.signs[:, None] * np.eye(3)[self.order]
        self.det = round(np.linalg.det(self.matrix))

    def vectors(self, v):
        """Turns rows of velocities, forces or the like."""
        return np.asarray(v)[..., self.order] * self.signs

    def points(self, x):
        turned = self.vectors(x) + np.where(self.signs < 0, self.size, 0) + self.shift
        return np.where(self.shift != 0, turned % self.size, turned)

    def cells(self, field):
        """Turns a field, [x, y, z] or [x, y, z, 3]."""
        turned = np.transpose(field, [*self.order, *range(3, field.ndim)])
        turned = np.roll(np.flip(turned, np.flatnonzero(self.signs < 0)), self.shift, (0, 1, 2))
        return self.vectors(turned) if field.ndim == 4 else turned

    def axis(self, letter):
        """Returns the name of an axis, and the sign with which components along it change theirs."""
        a = self.order.index(AXES.index(letter))
        return AXES[a], self.signs[a]

    def side(self, name):
        """The name of a side, such as x-low."""
        axis, sign = self.axis(name[0])
        return f"{axis}-{name[2:] if sign > 0 else dict(low='high', high='low')[name[2:]]}"

    def turn_of(self, kind):
        """P of a kind of shape."""
        return self.det * np.eye(3) if kind in UNTURNED else self.matrix

    def orientation(self, orientation, kind):
        return quaternion(self.matrix @ rotation(orientation) @ self.turn_of(kind).T).tolist()

    def mesh(self, vertices, triangles):
        """The vertices and triangles of a mesh, turned and mirrored in its own frame."""
        return self.vectors(vertices).tolist(), [t[::self.det] for t in triangles]

    def shape(self, shape):
        """A shape in its own frame, turned with P. That of a mesh is in its file."""
        turn, turned = self.turn_of(shape["type"]), dict(shape)
        for key in ("edges", "diameters"):
            if key in shape:
                turned[key] = (np.abs(turn) @ shape[key]).tolist()
        if "vertices" in shape:
            turned["vertices"] = (shape["vertices"] @ turn.T).tolist()
        if "parts" in shape:  # all of them are their own mirror images in a point
            turned["parts"] = [part | dict(position=(turn @ part.get("position", [0, 0, 0])).tolist()) for part in shape["parts"]]
        return turned

    def boundary(self, sides):
        turned = {}
        for axis in AXES:
            name, sign = self.axis(axis)
            both = sides[axis]
            turned[name] = both if both == "periodic" else [self.table(side) for side in both][::sign]
        return {axis: turned[axis] for axis in AXES}

    def value(self, key, value):
        """The value of a key of any table but [[shapes]], or None if that is not a matter of directions."""
        if key in POLAR and isinstance(value, list):
            return self.vectors(value).tolist()
        if key == "angular_velocity":
            return self.det * value if np.isscalar(value) else (self.det * self.vectors(value)).tolist()
        if key in ("position", "point"):
            return self.points(value).tolist()
        if key in ("ends", "line", "points"):
            return self.points(value).tolist()
        if key == "box":
            return np.sort(self.points(value), axis=0).tolist()
        if key in ("size", "blocks"):
            return np.array(value)[self.order].tolist()
        if key == "locked":
            return [name[:-1] + self.axis(name[-1])[0] for name in value]
        return dict(side=self.side, boundary=self.boundary).get(key, lambda same: None)(value)

    def table(self, table):
        """A table of the case, and the tables in it."""
        turned = {}
        for key, value in table.items():
            new = self.value(key, value)
            if new is None and isinstance(value, dict) and key != "orientation":
                new = self.table(value)
            if new is None and isinstance(value, list) and value and isinstance(value[0], dict):
                new = [self.table(entry) for entry in value]
            turned[key] = value if new is None else new
        return turned

    def wall(self, wall):
        """An entry of [[walls]]."""
        if wall["type"] == "tube":
            return self.table(directed(wall))
        return self.table(with_motion(wall)) | dict(orientation=self.orientation(wall.get("orientation"), "mesh"))

    def scene(self, tables):
        """The tables of a case."""
        kinds = {shape["name"]: shape["type"] for shape in tables["shapes"]}

        def body(entry):
            turned = self.table(with_motion(entry))
            return turned | dict(orientation=self.orientation(entry.get("orientation"), kinds[entry["shape"]])) if "position" in entry else turned
        special = dict(shapes=self.shape, walls=self.wall, bodies=body, quantities=lambda q: self.quantity(q)[0])
        return self.table({key: value for key, value in tables.items() if key not in special}) | {
            key: [turn(entry) for entry in tables.get(key, [])] for key, turn in special.items()}

    def quantity(self, quantity):
        """An entry of [[quantities]] about an axis or a side, and the sign that its value gets."""
        turned, sign = self.table(quantity), 1
        if "axis" in quantity:
            turned["axis"], sign = self.axis(quantity["axis"])
        return turned, sign * (self.det if "torque" in quantity["type"] else 1)
