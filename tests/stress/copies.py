"""A scene and a second copy of it behind the first: the same again, or its mirror image."""
import numpy as np
from crowd import extent
from random_scene import STONE
from symmetry import AXES, Symmetry, rotation, with_motion

CLEAR = 6  # cells from a surface to a plane of symmetry: along a row beside it links have no cell behind them (method-walls.md)
LISTS = ("shapes", "bodies", "fill", "springs", "outflow", "walls")


class Copy(Symmetry):
    """One of the copies: along the axis d a place x is at ±x + offset."""

    def __init__(self, size, d, sign=1, offset=0, suffix=""):
        super().__init__(size, range(3), [sign if a == d else 1 for a in range(3)], [0, 0, 0])
        self.offset, self.suffix = offset * np.eye(3)[d], suffix

    def points(self, x):
        return self.vectors(x) + self.offset

    def named(self, table, entry):
        """An entry of a table, with the names of the copy."""
        names = {key: entry[key] + self.suffix for key in ("name", "body", "to", "shape") if key in entry}
        file = dict(file="again.ply") if self.suffix and "file" in entry else {}
        return entry | (dict(name=entry["shape"] + self.suffix) if table in ("bodies", "fill") else {}) | names | file

    def entries(self, tables):
        """The tables of a case that are lists."""
        kinds = {shape["name"]: shape["type"] for shape in tables["shapes"]}

        def body(entry):
            return self.table(with_motion(entry)) | dict(orientation=self.orientation(entry.get("orientation"), kinds[entry["shape"]]))
        turn = dict(shapes=self.shape, bodies=body, walls=self.wall)
        return {table: [self.named(table, turn.get(table, self.table)(entry)) for entry in tables.get(table, [])] for table in LISTS}


class Same:
    """The scene itself, told as other tables."""

    def __init__(self, tables, told):
        self.size, self.told, self.copies = np.array(tables["domain"]["size"]), told, [Copy(tables["domain"]["size"], 0)]
        self.again = STONE

    def field(self, values):
        return values

    def quantity(self, quantity, value):
        return value


class Twice:
    """Two copies along the axis d: the second is the same (sign 1), or the mirror image in the plane x = plane, 0 or the size of the first."""

    def __init__(self, tables, d, sign, plane=0):
        self.size, self.d, n = np.array(tables["domain"]["size"]), d, tables["domain"]["size"][d]
        first = n if sign < 0 and not plane else 0
        self.copies = [Copy(self.size, d, 1, first), Copy(self.size, d, sign, n + plane, " again")]
        self.again = self.copies[1].mesh(*STONE)
        self.own = {wall["name"] for wall in tables.get("walls", []) if wall["type"] == "mesh"}  # walls of the first copy
        self.told = self.tables(tables)

    def tables(self, tables):
        size = (self.size * (1 + np.eye(3, dtype=int)[self.d])).tolist()
        sides = tables["domain"]["boundary"][AXES[self.d]]
        ends = [] if sides == "periodic" else [side for side in sides if side["type"] != "free-slip"]
        boundary = tables["domain"]["boundary"] | {AXES[self.d]: 2 * ends or "periodic"}
        tubes = [wall for wall in tables.get("walls", []) if wall["type"] == "tube"]  # both copies have it
        each = [copy.entries(tables | dict(walls=[wall for wall in tables.get("walls", []) if wall not in tubes])) for copy in self.copies]
        found = tables | {name: each[0][name] + each[1][name] for name in LISTS}
        if "fine" in tables.get("coarsening", {}):
            fine = [copy.table(box) for copy in self.copies for box in tables["coarsening"]["fine"]]
            found["coarsening"] = tables["coarsening"] | dict(fine=fine)
        return found | dict(walls=found["walls"] + tubes, domain=tables["domain"] | dict(size=size, boundary=boundary))

    def field(self, values):
        parts = [copy.cells(values) for copy in self.copies]
        return np.concatenate(parts[::1 if self.copies[0].offset[self.d] == 0 else -1], axis=self.d)

    def quantity(self, quantity, value):
        """The value of a quantity for both copies, from that for one."""
        if quantity["type"] == "mean-temperature" or quantity.get("side", " ")[0] == AXES[self.d] or quantity.get("wall") in self.own:
            return value
        again = self.copies[1]
        sign = again.signs[AXES.index(quantity["axis"])] if "axis" in quantity else 1
        return value * (1 + sign * (again.det if "torque" in quantity["type"] else 1))


def chosen_axis(tables, draw, wanted):
    """An axis along which there can be a second copy, if possible a wanted one (None: there is none). Tubes must be along it, cells of
    levels alike in both copies, and nothing flows in along it. A vessel would close out the other copy."""
    unit = 4 * 2 ** tables["coarsening"]["levels"] if "coarsening" in tables else 1
    tubes = {wall["axis"] for wall in tables.get("walls", []) if wall["type"] == "tube"}
    sides, size = tables["domain"]["boundary"], tables["domain"]["size"]
    axes = [d for d, axis in enumerate(AXES) if tubes <= {axis} and size[d] % unit == 0 and
            (sides[axis] == "periodic" or sides[axis][0]["type"] != "velocity-inlet")]
    if any(wall.get("solid") == "outside" for wall in tables.get("walls", [])):
        return None
    return draw.choice([d for d in axes if wanted(d)] or axes or [None])


def with_sides(tables, d, sides):
    """The tables with other sides across an axis, with the quantities that there still are. A quiet start takes as long as sound takes to
    cross the domain, so there is none."""
    boundary = tables["domain"]["boundary"] | {AXES[d]: sides}
    walls = {f"{axis}-{end}" for axis, both in boundary.items() if both != "periodic"
             for end, side in zip(("low", "high"), both) if side["type"] in ("no-slip", "moving")} | {wall["name"] for wall in tables.get("walls", [])}

    def remains(quantity):
        of_bodies = quantity["type"].split("-")[0] == "contact" or (quantity["type"] == "heat-flow" and not {"side", "wall"} & set(quantity))
        return {quantity.get("side"), quantity.get("wall")} <= walls | {None} and (tables["bodies"] or not of_bodies)
    found = tables | dict(domain=tables["domain"] | dict(boundary=boundary), quantities=[q for q in tables["quantities"] if remains(q)])
    if "fluid" in tables:
        found["fluid"] = {key: value for key, value in tables["fluid"].items() if key != "quiet_start"}
    return found


def doubled(tables, draw):
    """Returns a scene that is periodic along an axis, and two of them."""
    d = chosen_axis(tables, draw, lambda d: tables["domain"]["boundary"][AXES[d]] == "periodic")
    if d is None:
        return None
    n = tables["domain"]["size"][d]
    for spring in tables["springs"]:  # the shortest way across periodic sides is another one in a longer domain
        spring["ends"][1][d] -= n * round((spring["ends"][1][d] - spring["ends"][0][d]) / n)
    tables = with_sides(tables, d, "periodic")
    return tables, Twice(tables, d, 1)


def mirrored(tables, draw):
    """Returns a scene without levels, which take slopes from inside alone at sides, with one free-slip side or two across an axis, nothing
    near them and no forces across them; and the scene with its mirror image."""
    d = chosen_axis(tables, draw, lambda d: tables["domain"]["boundary"][AXES[d]] != "periodic")
    if d is None or "coarsening" in tables or any(tables.get("heat", {}).get("mean_gradient", [])):
        return None
    n, sides, mirror = tables["domain"]["size"][d], tables["domain"]["boundary"][AXES[d]], dict(type="free-slip")
    sides = draw.choice([[mirror, mirror]] if sides == "periodic" else [[mirror, mirror], [mirror, sides[1]], [sides[1], mirror]])
    planes = [plane for plane, side in zip((0, n), sides) if side is mirror]
    shapes = {shape["name"]: shape for shape in tables["shapes"]}

    def flat(table):
        return {key: flat(value) if isinstance(value, dict) else [x * (a != d) for a, x in enumerate(value)] if key in
                ("velocity", "acceleration", "body_force", "superficial_velocity") else value for key, value in table.items()}

    def is_clear(entry):
        turned = rotation(entry.get("orientation") if "position" in entry else None)
        shape = shapes[entry["shape"]] if "shape" in entry else dict(type="mesh")
        position = entry["position"] if "position" in entry else np.mean(entry["box"], axis=0)
        return all(abs(position[d] - plane) - extent(shape, turned[d] * (1 if plane else -1)) > CLEAR for plane in planes)
    boundary = {axis: both if both == "periodic" else [flat(side) for side in both] for axis, both in tables["domain"]["boundary"].items()}
    tables = tables | dict(domain=tables["domain"] | dict(boundary=boundary)) | {key: flat(tables[key]) for key in ("gravity", "fluid") if key in tables}
    if not any(tables.get("fluid", {}).get("superficial_velocity", [1])):
        del tables["fluid"]["superficial_velocity"]
    bounce = tables.get("coupling", {}).get("wall_scheme") == "bounce-back"  # which needs no cell behind
    tables["walls"] = [wall for wall in tables.get("walls", []) if (bounce if wall["type"] == "tube" else is_clear(wall))]
    for key in ("bodies", "fill"):
        tables[key] = [entry for entry in tables[key] if is_clear(entry)]
    tables["springs"] = [spring for spring in tables["springs"] if spring["body"] in [body.get("name") for body in tables["bodies"]]]
    tables = with_sides(tables, d, sides)
    return tables, Twice(tables, d, -1, draw.choice(planes))
