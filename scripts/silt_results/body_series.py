"""Reads bodies.h5 and the files that go on from it: a series of bodies whose number may change from time to time.

    series = BodySeries("out/bodies.h5")
    series.time, series.step, series.count      one entry a time
    series.at(-1)["position"]                   rows of one time, sorted by id
    series.array("position")                    [time, body, 3], where the bodies are the same at all times
    series.unwrapped()                          the same for positions, not wrapped into the domain
    series.of_body(7, "velocity")               (times, values) of one body
    series.columns                              every column, by name: contact_force only where it was asked for
    series.unit("velocity")                     "m/s"
    series.write_positions("settled.csv", "ball")    the poses of a kind at the end, as positions of another case
    series.meshes[kind]                         the surfaces of a kind's convex parts (body_shapes.Mesh)
An append that was cut off by a killed run is left out.
"""
import pathlib

import h5py
import numpy as np

COLUMNS = ("id", "kind", "image", "position", "orientation", "velocity", "angular_velocity", "force", "torque")
SOMETIMES = ("mass", "scale", "buoyancy", "contact_force", "contact_torque", "spring_force", "spring_torque")


def read_meshes(kinds, count):
    """Returns the meshes of each kind's convex parts, as dictionaries of arrays (body_shapes.Mesh says which)."""
    tables = {"vertices": ("vertex", "vertex_offset"), "normals": ("normal", "normal_offset"),
              "triangles": ("triangle", "triangle_offset"), "triangle_normals": ("triangle_normal", "triangle_offset")}
    read = {name: (kinds[values][:], kinds[offsets][:]) for name, (values, offsets) in tables.items()}
    meshes = [[] for _ in range(count)]
    for part, kind in enumerate(kinds["part_kind"][:]):
        meshes[kind].append({name: values[offsets[part]:offsets[part + 1]] for name, (values, offsets) in read.items()})
    return meshes


def files_of(first):
    """Returns the files of a series in their order: bodies.h5, and bodies_STEP.h5 that go on from it."""
    first = pathlib.Path(first)
    later = [path for path in first.parent.glob(f"{first.stem}_*{first.suffix}") if path.stem[len(first.stem) + 1:].isdigit()]
    return [first, *sorted(later, key=lambda path: int(path.stem[len(first.stem) + 1:]))]


def whole_times(f):
    """Returns how many times of a file are whole and how many rows they have: of an append that was cut off, or that is under way,
    some columns are shorter than others."""
    times = min(len(f[name]) for name in ("time", "step", "offset", "count"))
    rows = min(len(column) for column in f["bodies"].values())
    ends = f["offset"][:times].astype(int) + f["count"][:times].astype(int)
    whole = np.searchsorted(ends, rows, side="right")
    return whole, ends[whole - 1] if whole else 0


class BodySeries:
    def __init__(self, path):
        columns, times = {}, {}
        for number, file in enumerate(files_of(path)):
            with h5py.File(file, "r") as f:
                if number == 0:
                    self.read_head(f)
                whole, rows = whole_times(f)
                for name in ("time", "step", "count"):
                    times.setdefault(name, []).append(f[name][:whole])
                for name in [name for name in self.units if name != "time"]:
                    columns.setdefault(name, []).append(f["bodies"][name][:rows])
        self.columns = {name: np.concatenate(parts) for name, parts in columns.items()}
        self.time, self.step, count = (np.concatenate(parts) for parts in times.values())
        self.count = count.astype(int)
        self.offset = np.cumsum(self.count) - self.count

    def read_head(self, f):
        names = COLUMNS + tuple(name for name in SOMETIMES if name in f["bodies"])
        self.units = {name: f["bodies"][name].attrs.get("unit", b"") for name in names}
        self.units["time"] = f["time"].attrs.get("unit", b"")
        self.kinds = [text(k) for k in f["bodies"].attrs.get("kind_names", [])]
        self.domain = np.array([f.attrs["domain_lower"], f.attrs["domain_upper"]])
        kinds = f["kinds"]
        self.bounding_radius = kinds["bounding_radius"][:]
        self.meshes = read_meshes(kinds, len(self.bounding_radius))
        self.provenance = {name: text(value) for name, value in f["provenance"].attrs.items()}
        self.case_text = text(f["provenance/case_text"][()])

    def __len__(self):
        return len(self.time)

    def at(self, index):
        """Returns the columns of one time."""
        index = range(len(self))[index]
        rows = slice(self.offset[index], self.offset[index] + self.count[index])
        return {name: values[rows] for name, values in self.columns.items()}

    def array(self, name):
        """Returns a column as [time, body, ...]; raises ValueError where the bodies are not the same at all times."""
        if len(set(self.count)) > 1:
            raise ValueError("the number of bodies changes: use at(index) or of_body(id, name)")
        shape = (len(self), self.count[0] if len(self) else 0)
        ids = self.columns["id"].reshape(shape)
        if len(self) and (ids != ids[0]).any():
            raise ValueError("the bodies change: use at(index) or of_body(id, name)")
        values = self.columns[name]
        return values.reshape(shape + values.shape[1:])

    def unwrapped(self):
        """Returns positions as array does, but continued across periodic sides."""
        return self.array("position") + self.array("image") * (self.domain[1] - self.domain[0])

    def of_body(self, body, name):
        """Returns the times and values of a column for one body."""
        rows = np.flatnonzero(self.columns["id"] == body)
        return np.repeat(self.time, self.count)[rows], self.columns[name][rows]

    def write_positions(self, path, kind, index=-1):
        """Writes the bodies of a kind at one time as `positions` of a [[bodies]] entry with origin = "centre": where they are, how
        they are turned and how they move, each number so that it is read back bitwise."""
        if kind not in self.kinds:
            raise ValueError(f"there is no kind {kind}; there are {', '.join(self.kinds)}")
        rows = self.at(index)
        chosen = rows["kind"] == self.kinds.index(kind)
        if not chosen.any():
            raise ValueError(f"there is no body of the kind {kind} at time {self.time[index]:g}")
        if "scale" in rows and np.ptp(rows["scale"][chosen]) > 0:
            raise ValueError(f"the bodies of the kind {kind} differ in size, those of a [[bodies]] entry do not")
        numbers = np.hstack([rows[name][chosen] for name in ("position", "orientation", "velocity", "angular_velocity")])
        names = ["x", "y", "z", *(f"orientation.{a}" for a in "wxyz"), *(f"{of}.{a}" for of in ("velocity", "angular_velocity") for a in "xyz")]
        lines = [f"# {kind!r} at step {self.step[index]}: the positions are those of centres of mass (origin = \"centre\")", ",".join(names),
                 *(",".join(map(repr, row)) for row in numbers.tolist())]
        pathlib.Path(path).write_text("\n".join(lines) + "\n")

    def unit(self, name):
        return text(self.units[name])


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)
