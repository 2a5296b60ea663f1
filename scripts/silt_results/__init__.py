"""Reads what a run of Silt wrote (cases/OUTPUT.md): numpy and h5py are all it needs.

    import silt_results
    run = silt_results.open("cases/segregation")        # a case, or a folder of results
    run.report["quantities"]                             # report.json as a dictionary
    run.series["energy.fluid"]                           # a column of series.csv, as an array
    run.table("forces")["drag"]                          # one of series_forces.csv ([[output.series]])
    run.probes("axis").of("velocity.x")[-1]              # along a line at the last time ([[output.probes]])
    run.bodies.at(-1)["position"]                        # bodies.h5: silt_results.BodySeries
    run.fields[-1]["velocity"]                           # a field of the fluid at the last time, [x, y, z, 3]
    run.scene.walls                                      # the case as it was run: silt_results.Scene
Files that a run has not written raise FileNotFoundError, which names the key of the case that asks for them.
"""
import builtins
import fcntl
import functools
import json
import pathlib
import sys

try:
    import h5py  # noqa: F401
    import numpy  # noqa: F401
except ImportError as error:
    raise SystemExit(f"silt_results: {error} ({sys.executable}); use /usr/bin/python3, with Debian's python3-h5py, "
                     "or install h5py and numpy for this one") from None

from .body_series import COLUMNS, BodySeries, text
from .field import Field
from .scalars import Probes, Scalars
from .scene import Scene

__all__ = ["COLUMNS", "BodySeries", "Field", "Probes", "Run", "Scalars", "Scene", "open", "text"]


class Run:
    """Run is a folder of results. Files are opened when they are first asked for."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)

    def file(self, name, wanted):
        path = self.folder / name
        if not path.exists():
            raise FileNotFoundError(f"{path}: not there; a run writes it with {wanted}")
        return path

    @property
    def under_way(self):
        """Says whether a run is writing to the folder: it holds the lock there."""
        try:
            with builtins.open(self.folder / "run.lock", "rb") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except FileNotFoundError:
            return False
        except OSError:
            return True
        return False

    @functools.cached_property
    def report(self):
        """report.json as a dictionary. ValueError: the file is cut off, or none of JSON."""
        path = self.file("report.json", "output.report, and at its end")
        try:
            report = json.loads(path.read_text())
            if not isinstance(report, dict):
                raise ValueError("it is no report of a run")
            return report
        except ValueError as error:
            raise ValueError(f"{path}: not whole: {error}; let the run write it again (silt resume)") from None

    @functools.cached_property
    def series(self):
        """series.csv: Scalars."""
        return Scalars(self.file("series.csv", "output.report = { every = N }"))

    def table(self, name):
        """series_NAME.csv: Scalars."""
        return Scalars(self.file(f"series_{name}.csv", f'[[output.series]] of the name "{name}"'))

    def probes(self, name):
        """probes_NAME.csv: Probes."""
        return Probes(self.file(f"probes_{name}.csv", f'[[output.probes]] of the name "{name}"'))

    @functools.cached_property
    def bodies(self):
        """bodies.h5: a BodySeries."""
        return BodySeries(self.file("bodies.h5", "output.bodies = { every = N }"))

    @functools.cached_property
    def scene(self):
        """scene.h5, the case as it was run: a Scene."""
        return Scene(self.file("scene.h5", "its start"))

    @functools.cached_property
    def mean(self):
        """The newest mean_*.hdf, means of the fluid over time: a Field."""
        paths = sorted(self.folder.glob("mean_*.hdf"))
        return Field(paths[-1] if paths else self.file("mean_*.hdf", "output.mean = { from = T, every = N }, at its end"))

    @functools.cached_property
    def fields(self):
        """The fields of the fluid, a Field a time, in order."""
        paths = sorted(self.folder.glob("fields_*.hdf"))
        if not paths:
            self.file("fields_*.hdf", "output.fields = { every = N }")
        return [Field(path) for path in paths]


def open(path):  # noqa: A001: silt_results.open reads as it should
    """Returns the Run of a folder of results, or of a case whose results are in its folder out."""
    path = pathlib.Path(path)
    if path.suffix == ".toml":
        path = path.parent
    return Run(path / "out" if (path / "case.toml").exists() else path)
