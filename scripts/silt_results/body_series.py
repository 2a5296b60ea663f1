"""Reads bodies.h5: a series of bodies whose number may change from time to time.

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
import io
import pathlib

import h5py
import numpy as np

COLUMNS = ("id", "kind", "image", "position", "orientation", "velocity", "angular_velocity", "force", "torque")
SOMETIMES = ("mass", "scale", "buoyancy", "contact_force", "contact_torque")


def read_meshes(kinds, count):
    """Returns the meshes of each kind's convex parts, as dictionaries of arrays (body_shapes.Mesh says which), or None
    where the file is of format 1, which has none."""
    if "triangle" not in kinds:
        return None
    tables = {"vertices": ("vertex", "vertex_offset"), "normals": ("normal", "normal_offset"),
              "triangles": ("triangle", "triangle_offset"), "triangle_normals": ("triangle_normal", "triangle_offset")}
    read = {name: (kinds[values][:], kinds[offsets][:]) for name, (values, offsets) in tables.items()}
    meshes = [[] for _ in range(count)]
    for part, kind in enumerate(kinds["part_kind"][:]):
        meshes[kind].append({name: values[offsets[part]:offsets[part + 1]] for name, (values, offsets) in read.items()})
    return meshes


PAGE = 4096


def whole_file(path):
    """Returns what h5py opens: the path, or, where a run was killed as it ended an append, the file's content with the
    pages that the journal keeps for it (adapters/hdf5/journal.hpp)."""
    journal = pathlib.Path(f"{path}.journal")
    if not journal.exists():
        return path
    pages, data = journal.read_bytes(), bytearray(pathlib.Path(path).read_bytes())
    for at in range(8, len(pages), 8 + PAGE):
        first = int.from_bytes(pages[at:at + 8], "little") * PAGE
        data[first:first + PAGE] = pages[at + 8:at + 8 + PAGE]
    return io.BytesIO(data)


class BodySeries:
    def __init__(self, path):
        with h5py.File(whole_file(path), "r") as f:
            times = min(len(f[name]) for name in ("time", "step", "offset", "count"))
            offset, count = f["offset"][:times].astype(int), f["count"][:times].astype(int)
            names = COLUMNS + tuple(name for name in SOMETIMES if name in f["bodies"])
            rows = min(len(f["bodies"][name]) for name in names)
            whole = 0
            while (whole < times and offset[whole] == count[:whole].sum() and offset[whole] + count[whole] <= rows):
                whole += 1
            self.time, self.step = f["time"][:whole], f["step"][:whole]
            self.offset, self.count = offset[:whole], count[:whole]
            self.columns = {name: f["bodies"][name][: self.count.sum()] for name in names}
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
        they are turned and how they move, each number so that it is read back to the bit."""
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
