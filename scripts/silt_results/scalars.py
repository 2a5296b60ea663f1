"""Reads series.csv, what a run said of itself each time it reported, and series_NAME.csv, values of quantities in steps.

    series = Scalars("out/series.csv")
    series.names                                steps, time, energy.fluid, quantities.NAME, ...
    series["time"], series["energy.fluid"]      arrays, a value a report; NaN is what was not known
A row that was cut off by a killed run is left out.
"""
import csv
import io

import numpy as np


class Scalars:
    def __init__(self, path):
        with open(path, newline="") as stream:
            whole = stream.read().rsplit("\n", 1)[0]
        self.names, *rows = csv.reader(io.StringIO(whole, newline=""))
        rows = [row for row in rows if len(row) == len(self.names)]
        values = np.array([[float(x) if x else np.nan for x in row] for row in rows]).reshape(len(rows), len(self.names))
        self.columns = dict(zip(self.names, values.T))

    def __len__(self):
        return len(self.columns[self.names[0]])

    def __getitem__(self, name):
        if name not in self.columns:
            raise KeyError(f"{name}; there are {', '.join(self.names)}")
        return self.columns[name]


class Probes(Scalars):
    """probes_NAME.csv, fields of the fluid at points over time ([[output.probes]]):

    probes = Probes("out/probes_axis.csv")
    probes.time                                 of each look
    probes.of("velocity.x")                     an array [look, point]; NaN where there is no fluid
    probes.of("z")[0]                           where the points are
    """
    @property
    def time(self):
        return self["time"][self["point"] == 0]

    def of(self, name):
        points = int(self["point"].max()) + 1
        return self[name][:len(self) // points * points].reshape(-1, points)
