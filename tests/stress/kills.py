#!/usr/bin/python3
"""Runs that are killed while they write, and gone on with: kills.py --silt SILT --preload LIBRARY [--writes
N] [--appends N] [--rows N] [--moments N] [--ranks N] [--seed N] [--wet]. With --wet they have a fluid, and write fields
and slices too. Each is killed in the middle of one of its
changes of the result folder (N of them, evenly spread over the run, over the appends to bodies.h5 around the
one that goes on in another file, or over the changes of series.csv and report.json; fault_at_write.cpp) or at
a random moment, without warning. Then the series of the bodies and the files over time must be readable and hold
frames as they were written, and the run that goes on must come to the same bits, files, rows of series.csv and report
as one that nobody killed."""
import argparse
import functools
import os
import pathlib
import random
import shutil
import subprocess
import tempfile
import time

from whole_run import Whole, finish, over_time, start
from silt_runs import WALLS_ACROSS_Z, domain_of, fill_of, shape_of  # on the path by whole_run

CASE = (domain_of([160, 160, 160]) + "[gravity]\nacceleration = [0, 0, -1e-3]\n" +
        shape_of("ball", "sphere", "radius = 2") + fill_of("ball", 2, 3000, "gap = 0.5") +
        "[run]\nsteps = 40\n" +
        "[output]\nbodies = { every = 1 }\ncheckpoint = { every = 10, keep = 2 }\n" +
        "report = { every = 5 }\n")

# Bodies are dropped in as the run goes on, so times have ever more of them.
WET = (domain_of([16, 16, 24], WALLS_ACROSS_Z) + "[fluid]\nrelaxation_time = 0.8\n" +
       "[gravity]\nacceleration = [0, 0, -1e-4]\n" + shape_of("ball", "sphere", "radius = 2.5") +
       fill_of("ball", 2, 1, "every = 30", "gap = 0.5", "box = [[0, 0, 16], [16, 16, 24]]", "velocity = [0, 0, -0.05]") +
       "[run]\nsteps = 90\n" +
       "[output]\nbodies = { every = 1 }\nfields = { every = 15 }\n" +
       "checkpoint = { every = 30, keep = 2 }\nreport = { every = 30 }\n" +
       '[[output.slices]]\nname = "middle"\nbox = [[0, 8, 0], [16, 8, 24]]\nevery = 6\n')

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--silt", required=True)
parser.add_argument("--preload", required=True)
parser.add_argument("--writes", type=int, default=0)
parser.add_argument("--appends", type=int, default=0)
parser.add_argument("--rows", type=int, default=0)
parser.add_argument("--moments", type=int, default=0)
parser.add_argument("--ranks", type=int, default=1)
parser.add_argument("--seed", type=int, default=1)
parser.add_argument("--wet", action="store_true")
options = parser.parse_args()
launch = functools.partial(start, options.silt, options.ranks)


def kill_settings(out, at):
    return {"LD_PRELOAD": options.preload, "SILT_FAULT_FOLDER": str(out), "SILT_FAULT_AT": str(at)}


def spread(first, last, n):
    n = min(n, last - first)
    return [first + (2 * i + 1) * (last - first) // (2 * n) for i in range(n)]


def descendants(pid):
    """Returns a process and all it has started; mpirun gives each rank a group of its own."""
    children = subprocess.run(["pgrep", "-P", str(pid)], capture_output=True, text=True).stdout.split()
    return [pid, *(below for child in children for below in descendants(int(child)))]


def kill_all(process):
    """Kills them all, and waits until they are gone: the lock of a folder is theirs as long as they live."""
    pids = descendants(process.pid)
    for pid in pids:
        try:
            os.kill(pid, 9)
        except ProcessLookupError:
            pass
    process.wait()
    while any(pathlib.Path(f"/proc/{pid}/cmdline").exists() and pathlib.Path(f"/proc/{pid}/cmdline").read_bytes() for pid in pids):
        time.sleep(0.01)


def kill_one(scratch, whole, case, at=None, after=None):
    out = scratch / "out"
    what = f"killed at change {at}" if at else f"killed after {after:.3f} s"
    process = launch("run", case, "--out", out, preload=kill_settings(out, at) if at else None)
    if after:
        time.sleep(after)
        kill_all(process)
    process.communicate(timeout=300)
    frames = whole.check_bodies(out / "bodies.h5", False, what) if (out / "bodies.h5").exists() else 0
    over_time.check(out, whole=False)
    again = "resume" if list(out.glob("checkpoint_*.h5")) else "run"
    finish(launch(again, case, "--out", out, *["--overwrite"] * (again == "run")), f"{what}, {frames} frames, {again}")
    whole.check(out, what)
    print(f"{what}: {frames} frames, {again}", flush=True)
    shutil.rmtree(out)


def main():
    with tempfile.TemporaryDirectory(prefix="silt-kills-") as folder:
        scratch = pathlib.Path(folder)
        case = scratch / "case.toml"
        case.write_text(WET if options.wet else CASE)
        log = scratch / "log"
        out = scratch / "whole"
        begin = time.time()
        finish(launch("run", case, "--out", out, preload=kill_settings(out, 0) | {"SILT_FAULT_LOG": str(log)}), "whole")
        duration = time.time() - begin
        whole = Whole(out)
        changes = min(scratch.glob("log*")).read_text().splitlines()  # of rank 0
        first = last = 0
        if options.appends:
            begins, *_, ends = [i for i, change in enumerate(changes) if "/bodies_" in change and ".h5.part" in change]
            first, last = 2 * begins - ends, 2 * ends - begins  # an append before and one behind
        print(f"{len(changes)} changes, of them {last - first} of three appends", flush=True)
        of_rows = [i for i, change in enumerate(changes) if "/series.csv" in change or "/report.json" in change]
        chosen = [of_rows[i] for i in spread(0, len(of_rows), options.rows)]
        for at in [*spread(0, len(changes), options.writes), *spread(first, last, options.appends), *chosen]:
            kill_one(scratch, whole, case, at=1 + at)
        random.seed(options.seed)
        for _ in range(options.moments):
            kill_one(scratch, whole, case, after=random.uniform(0.1, 1) * duration)


main()
