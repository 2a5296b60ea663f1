"""A reference problem: the cases that are run, the numbers read out of each, and the figures made of them.

A problem is a module of this folder, named after it:

    GOALS = [Goal("accuracy.tencate.e4.d9.error", 1.0)]         # |figure| in percent must not be above
    CLAIMS = {"accuracy.tencate.{e}.d{D}.error": Claim(...)}      # what goals of these names say, and whence it is known
    def runs(level):      -> [Run]                                # level: "short" (seconds, in CI) or "full"
    def measure(run, outcome):  -> {name: number}                 # of one run; kept with it
    def figures(measured):      -> {figure: number or Found}      # measured: {run.key: {name: number}}; runs may be missing

and may have

    SHORT_GOALS = [...]   # what CI holds it to instead; without it, those of GOALS whose figures the short runs give
    def curves(measured): -> [Curve]  # for the plot; without it, |error| of each run that measured an "error"

and scripts/bench accuracy does the rest: it runs what has not been run yet with this program, keeps what was measured
with the core-seconds, compares with the goals, and leaves JSON, CSV, tables and plots. To what measure gives it adds
"core_seconds" (time in the steps, times the ranks), "steps" and "mlups". A figure is an error in percent
unless its name says otherwise; the sign is found - reference. The module's docstring gives the reference and its source.
A module without GOALS is no problem, but what some share.
"""
import dataclasses
import json
import pathlib

import h5py
from silt_results import BodySeries


@dataclasses.dataclass(frozen=True)
class Goal:
    figure: str
    limit: float          # largest magnitude
    low: float = None     # a goal that is a range: [low, limit]

    def met(self, found):
        """Says whether the goal is met; False for what is not a number."""
        return self.low <= found <= self.limit if self.low is not None else abs(found) <= self.limit

    def __str__(self):
        return f"{self.low:g} to {self.limit:g}" if self.low is not None else f"{self.limit:g}"


@dataclasses.dataclass(frozen=True)
class Claim:
    """A Claim describes the goals of one form of name, for scripts/ledger. Its texts may hold the fields of the name, {D}."""
    quantity: str
    regime: str
    resolution: str
    source: str           # a citation, or how the reference was computed
    doi: str = ""         # of the source, one that is known to be right
    kind: str = "theory"  # "experiment"; "computation": others' or by another method; "convergence": our own finest run
    expected: object = None  # value of the quantity, or a function of the name's fields, where the figure is its relative error
    uncertainty: str = ""    # of what is expected
    unit: str = "%"       # of the figure
    note: str = ""        # why it is missed, or why its goal is wide


@dataclasses.dataclass(frozen=True)
class Run:
    key: str              # unique within the problem, e.g. "e4.d9.cli.single"
    case: str             # text of case.toml
    settings: dict = dataclasses.field(default_factory=dict, hash=False)  # for tables and plots: D, scheme, precision, ...
    files: dict = dataclasses.field(default_factory=dict, hash=False)     # further files of the case: name -> text
    ranks: int = 1


@dataclasses.dataclass(frozen=True)
class Found:
    """Found is a figure that says which runs it is made of: the table then gives their core-seconds."""
    value: float
    runs: tuple


@dataclasses.dataclass(frozen=True)
class Curve:
    """A Curve is a line of the plot of error against cost; curves of one plot share its picture."""
    label: str
    points: list          # of (core-seconds, error in percent, note at the point such as "D = 8")
    plot: str = ""


class Outcome:
    """An Outcome is the results folder of a run that ended well."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.report = json.loads((self.folder / "report.json").read_text())

    def quantity(self, name):
        return self.report["quantities"][name]

    def last_field(self, name):
        """Returns a field of the last time written: [z, y, x], and for the velocity [z, y, x, 3]."""
        with h5py.File(sorted(self.folder.glob("fields_*.hdf"))[-1]) as f:
            return f[f"VTKHDF/PointData/{name}"][...]

    def mean_velocity(self):
        """Returns the mean over the whole box at the last time written, bodies included."""
        return self.last_field("velocity").mean(axis=(0, 1, 2), dtype=float)

    @property
    def bodies(self):
        """Returns the series of bodies.h5: outcome.bodies.time, .array("position"), .of_body(0, "velocity"), ..."""
        return BodySeries(self.folder / "bodies.h5")
