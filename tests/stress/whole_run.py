"""The scripts kills.py and errors.py share this: a run that nobody disturbs, and whether another came to the
same results."""
import csv
import json
import pathlib
import subprocess
import sys

import h5py
import numpy as np

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[1] / folder) for folder in ("", "adapters/hdf5")]
import over_time  # noqa: E402, I001
from silt_runs import ENVIRONMENT, MPIRUN  # noqa: E402, I001
from silt_results import COLUMNS, BodySeries  # noqa: E402


# These keys of a report are of the time it took, of the machine, or of the last start.
OF_THE_START = {"wall_seconds", "step_seconds", "stage_seconds", "mlups", "resumed_at", "traffic", "work", "balance", "memory_peak_bytes"}


def start(silt, ranks, *arguments, preload=None):
    command = [silt, *map(str, arguments)]
    if ranks > 1:
        command = [*MPIRUN, "-np", str(ranks), "env", *(f"{k}={v}" for k, v in (preload or {}).items()), *command]
    return subprocess.Popen(command, env=ENVIRONMENT | (preload or {}), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            text=True, start_new_session=True)


def finish(process, what):
    text, _ = process.communicate(timeout=300)
    if process.returncode != 0:
        sys.exit(f"{what}: exit {process.returncode}\n{text}")
    return text


def report_of(out):
    report = json.loads((out / "report.json").read_text())
    return {key: value for key, value in report.items() if key not in OF_THE_START}


def rows_of(out):
    with open(out / "series.csv", newline="") as file:
        return [{key: value for key, value in row.items() if key.split(".")[0] not in OF_THE_START} for row in csv.DictReader(file)]


def fields_of(out):
    """The values of every field and slice; a file that cannot be read is an error."""
    values = {}
    for path in sorted([*out.glob("fields_*.hdf"), *out.glob("slice_*.hdf")]):
        with h5py.File(path) as file:
            values[path.name] = {name: data[()].tobytes() for name, data in file["VTKHDF/PointData"].items()}
    return values


class Whole:
    """The results of a run that came to its end."""

    def __init__(self, out):
        self.report, self.rows, self.fields, self.bodies = report_of(out), rows_of(out), fields_of(out), BodySeries(out / "bodies.h5")

    def check_bodies(self, path, complete, what):
        """The frames there are those of the whole run; all of them, if the run has come to its end."""
        series, whole = BodySeries(path), self.bodies
        n = len(series)
        assert (series.step == whole.step[:n]).all() and (n == len(whole) or not complete), f"{what}: frames {series.step}"
        for name in COLUMNS:
            rows = series.columns[name]
            assert np.array_equal(rows, whole.columns[name][: len(rows)]), f"{what}: other {name}"
        return n

    def check(self, out, what):
        """All results are those of the whole run, and nothing else is left."""
        report = report_of(out)
        other = [key for key in report.keys() | self.report.keys() if report.get(key) != self.report.get(key)]
        assert not other, f"{what}: of the report, other {[(key, report.get(key), self.report.get(key)) for key in other]}"
        rows = rows_of(out)
        steps, whole_steps = ([row["steps"] for row in table] for table in (rows, self.rows))
        assert steps == whole_steps, f"{what}: rows of steps {steps} instead of {whole_steps}"
        for row, whole in zip(rows, self.rows):
            assert row == whole, f"{what}: in a row, other {[(key, row[key], whole[key]) for key in row if row[key] != whole[key]]}"
        fields = fields_of(out)
        assert fields.keys() == self.fields.keys(), f"{what}: fields {list(fields)}"
        assert fields == self.fields, f"{what}: other values of fields"
        self.check_bodies(out / "bodies.h5", True, what)
        over_time.check(out)
        left = [path.name for path in out.iterdir() if path.suffix == ".part" or path.name == "series.1.csv"]
        assert not left, f"{what}: left {left}"
