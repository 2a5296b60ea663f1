"""Reads fields_STEP.hdf: the fluid at one time.

    field = Field("out/fields_000000002500.hdf")
    field.time, field.step, field.names         2.5, 2500, ["density", "velocity"]
    field["velocity"]                           [x, y, z, 3]; a scalar is [x, y, z]
    field.slice("velocity", z=16)               [x, y, 3]: only that plane is read
    field.x, field.y, field.z                   where the centres of the cells are
    field.lower, field.upper                    corners of the box of the cells
    field.unit("velocity"), field.unit()        "m/s"; that of lengths, "m"
"""
import h5py
import numpy as np

from .body_series import text

AXES = "xyz"


class Field:
    def __init__(self, path):
        self.path = path
        with h5py.File(path, "r") as f:
            grid = f["VTKHDF"]
            self.time, self.step = float(f.attrs["time"]), int(f.attrs["step"])
            self.names = sorted(grid["PointData"])
            low, high = np.array(grid.attrs["WholeExtent"]).reshape(3, 2).T
            self.size = tuple(int(n) for n in high - low + 1)
            origin, spacing = grid.attrs["Origin"], grid.attrs["Spacing"]
            self.x, self.y, self.z = (o + d * np.arange(n) for o, d, n in zip(origin, spacing, self.size))
            self.lower, self.upper = origin - 0.5 * spacing, origin + (np.array(self.size) - 0.5) * spacing
            self.case_text = text(f["provenance/case_text"][()])
            self.units = {name: text(grid["PointData"][name].attrs.get("unit", "")) for name in self.names}
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

    def _read(self, name, rows):
        if name not in self.names:
            raise KeyError(f"{name}: {self.path} has {', '.join(self.names)}")
        with h5py.File(self.path, "r") as f:
            values = f["VTKHDF/PointData"][name][rows[::-1]]  # in the file x is fastest
        kept = sum(isinstance(row, slice) for row in rows)
        return np.moveaxis(values, range(kept), range(kept)[::-1])
