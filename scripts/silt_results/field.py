"""Reads fields_STEP.hdf: the fluid at one time.

    field = Field("out/fields_000000002500.hdf")
    field.time, field.step, field.names         2.5, 2500, ["density", "velocity"]
    field["velocity"]                           [x, y, z, 3]; a scalar is [x, y, z]
    field.slice("velocity", z=16)               [x, y, 3]: only that plane is read
    field.x, field.y, field.z                   where the centres of the cells are
    field.lower, field.upper                    corners of the box of the cells
    field.unit("velocity"), field.unit()        "m/s"; that of lengths, "m"
Where cells have several widths, all this is of the finest lattice, in which a coarse cell's value is repeated, and
    field.levels                                how many widths there are
    field["level"]                              [x, y, z]: that of each cell, 0 for the finest of the run
    field.boxes("velocity")                     a list of Box, cells of one level each
"""
import collections

import h5py
import numpy as np

from .body_series import text

AXES = "xyz"
Box = collections.namedtuple("Box", "level lower spacing values")  # lower: its corner; values: [x, y, z] or [x, y, z, 3]
Part = collections.namedtuple("Part", "group level width first size place")  # cells of a level, width in those of the file's


class Field:
    def __init__(self, path):
        self.path = path
        with h5py.File(path, "r") as f:
            grid = f["VTKHDF"]
            self.time, self.step = float(f.attrs["time"]), int(f.attrs["step"])
            self._parts = [] if "WholeExtent" in grid.attrs else _parts_of(grid)  # the coarsest first, under the others
            if self._parts:
                data = grid["Level0/CellData"]
                self.levels = len({part.group for part in self._parts})
                spacing = grid[self._parts[-1].group].attrs["Spacing"]
                self._first = np.min([part.first * part.width for part in self._parts], axis=0)
                size = np.max([(part.first + part.size) * part.width for part in self._parts], axis=0) - self._first
                origin = grid.attrs["Origin"] + (self._first + 0.5) * spacing
            else:
                data, self.levels = grid["PointData"], 1
                low, high = np.array(grid.attrs["WholeExtent"]).reshape(3, 2).T
                origin, spacing, size = grid.attrs["Origin"], grid.attrs["Spacing"], high - low + 1
            self.names, self.size, self.spacing = sorted(data), tuple(int(n) for n in size), spacing
            self.x, self.y, self.z = (o + d * np.arange(n) for o, d, n in zip(origin, spacing, self.size))
            self.lower, self.upper = origin - 0.5 * spacing, origin + (np.array(self.size) - 0.5) * spacing
            self.case_text = text(f["provenance/case_text"][()])
            self.units = {name: text(data[name].attrs.get("unit", "")) for name in self.names}
            self.units["length"], self.units["time"] = (text(f.attrs.get(f"{of}_unit", "")) for of in ("length", "time"))

    def __getitem__(self, name):
        return self._read(name, (slice(None),) * 3)

    def slice(self, name, **at):
        """Returns the plane at one index along an axis: slice("density", y=3)."""
        (axis, index), = at.items()
        rows = [slice(None)] * 3
        rows[AXES.index(axis)] = range(self.size[AXES.index(axis)])[index]
        return self._read(name, tuple(rows))

    def unit(self, name="length"):
        return self.units[name]

    def boxes(self, name):
        """Returns the boxes of cells of each level, the coarsest first: what later ones cover is the mean of their values."""
        if not self._parts:
            return [Box(0, self.lower, self.spacing, self[name])]
        corner = self.lower - self._first * self.spacing
        return [Box(part.level, corner + part.first * part.width * self.spacing, part.width * self.spacing, values)
                for part, values in self._values(name)]

    def _values(self, name):
        with h5py.File(self.path, "r") as f:
            for part in self._parts:
                shape = tuple(part.size[::-1])  # in the file x is fastest
                if name == "level":
                    values = np.full(shape, part.level)
                else:
                    values = f["VTKHDF"][part.group]["CellData"][name][part.place:part.place + part.size.prod()]
                    values = values.reshape(shape + values.shape[1:])
                yield part, np.moveaxis(values, (0, 1, 2), (2, 1, 0))

    def _read(self, name, rows):
        if name not in self.names + ["level"]:
            raise KeyError(f"{name}: {self.path} has {', '.join(self.names)}")
        if self._parts:
            return self._on_finest(name, rows)
        if name == "level":
            return np.zeros([n for n, row in zip(self.size, rows) if isinstance(row, slice)], int)
        with h5py.File(self.path, "r") as f:
            values = f["VTKHDF/PointData"][name][rows[::-1]]  # in the file x is fastest
        kept = sum(isinstance(row, slice) for row in rows)
        return np.moveaxis(values, range(kept), range(kept)[::-1])

    def _on_finest(self, name, rows):
        """Coarse boxes first, so that finer ones have the last word."""
        kept = [d for d in range(3) if isinstance(rows[d], slice)]
        found = None
        for part, values in self._values(name):
            first = part.first * part.width - self._first
            if found is None:
                found = np.zeros([self.size[d] for d in kept] + list(values.shape[3:]), values.dtype)
            for d in set(range(3)) - set(kept):
                at = (rows[d] - first[d]) // part.width
                values = values.take([at], axis=d) if 0 <= at < part.size[d] else values[:0]
            if values.size == 0:
                continue
            for d in kept:
                values = values.repeat(part.width, axis=d)
            values = values.squeeze(tuple(set(range(3)) - set(kept)))
            found[tuple(slice(first[d], first[d] + part.size[d] * part.width) for d in kept)] = values
        return found


def _parts_of(grid):
    parts, groups = [], sorted(name for name in grid if name.startswith("Level"))
    levels = [int(grid[group].attrs["level"]) for group in groups]
    for group, level in zip(groups, levels):
        place = 0
        for box in grid[group]["AMRBox"][()].reshape(-1, 3, 2).astype(np.int64):
            size = box[:, 1] - box[:, 0] + 1
            parts.append(Part(group, level, 1 << (level - levels[-1]), box[:, 0], size, place))
            place += size.prod()
    return parts
