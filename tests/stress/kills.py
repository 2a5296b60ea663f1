#!/usr/bin/python3
"""Runs that are killed while they write, and gone on with: kills.py --silt SILT --preload LIBRARY
[--writes N] [--appends N] [--moments N] [--ranks N] [--seed N]. Each is killed in the middle of one of its changes of
the result folder (N of them, evenly spread over the run or over the append to bodies.h5 that splits the nodes of its
trees; kill_at_write.cpp) or at a random moment, without warning. Then the series of the
bodies must be readable and hold frames as they were written, and the run that goes on must come to the same bits and
files as one that nobody killed."""
import argparse
import json
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from silt_results import COLUMNS, BodySeries  # noqa: E402

CASE = """
[units]
system = "lattice"
[domain]
size = [160, 160, 160]
boundary = "periodic"
[gravity]
acceleration = [0, 0, -1e-3]
[[shapes]]
name = "ball"
type = "sphere"
radius = 2
[[fill]]
shape = "ball"
density = 2
count = 3000
gap = 0.5
[run]
steps = 40
[output]
bodies = { every = 1 }
checkpoint = { every = 9, keep = 2 }
report = { every = 15 }
"""

NODES_ARE_FULL = 21  # the append that brings the 65th chunk of 1024 rows to a node of a column's tree, which takes 64

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--silt", required=True)
parser.add_argument("--preload", required=True)
parser.add_argument("--writes", type=int, default=0)
parser.add_argument("--appends", type=int, default=0)
parser.add_argument("--moments", type=int, default=0)
parser.add_argument("--ranks", type=int, default=1)
parser.add_argument("--seed", type=int, default=1)
options = parser.parse_args()

ENVIRONMENT = dict(os.environ, OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_rmaps_base_oversubscribe="1", SILT_PLAIN="1")
LAUNCHER = ["mpirun", "--oversubscribe", "--allow-run-as-root", "--quiet", "-np", str(options.ranks)]


def start(*arguments, preload=None):
    command = [options.silt, *map(str, arguments)]
    if options.ranks > 1:
        command = [*LAUNCHER, "env", *(f"{k}={v}" for k, v in (preload or {}).items()), *command]
    return subprocess.Popen(command, env=ENVIRONMENT | (preload or {}), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            text=True, start_new_session=True)


def kill_settings(out, at):
    return {"LD_PRELOAD": options.preload, "SILT_KILL_FOLDER": str(out), "SILT_KILL_AT": str(at)}


def finish(process, what):
    text, _ = process.communicate(timeout=300)
    if process.returncode != 0:
        sys.exit(f"{what}: exit {process.returncode}\n{text}")


def state(out):
    report = json.loads((out / "report.json").read_text())
    return report["state_hash"], report["steps"]


def check_series(path, whole, complete, what):
    """The frames there are those of the whole run; all of them, if the run has come to its end."""
    series = BodySeries(path)
    n = len(series)
    assert (series.step == whole.step[:n]).all() and (n == len(whole) or not complete), f"{what}: frames {series.step}"
    for name in COLUMNS:
        rows = series.columns[name]
        assert np.array_equal(rows, whole.columns[name][: len(rows)]), f"{what}: other {name}"
    return n


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
    process = start("run", case, "--out", out, preload=kill_settings(out, at) if at else None)
    if after:
        time.sleep(after)
        kill_all(process)
    process.communicate(timeout=300)
    frames = 0
    if (out / "bodies.h5").exists():
        frames = check_series(out / "bodies.h5", whole[1], False, what)
    again = "resume" if list(out.glob("checkpoint_*.h5")) else "run"
    finish(start(again, case, "--out", out), f"{what}, {frames} frames, {again}")
    assert state(out) == whole[0], f"{what}: another state"
    check_series(out / "bodies.h5", whole[1], True, what)
    left = [path.name for path in out.iterdir() if path.suffix in (".part", ".journal")]
    assert not left, f"{what}: left {left}"
    print(f"{what}: {frames} frames, {again}", flush=True)
    shutil.rmtree(out)


def main():
    with tempfile.TemporaryDirectory(prefix="silt-kills-") as folder:
        scratch = pathlib.Path(folder)
        case = scratch / "case.toml"
        case.write_text(CASE)
        log = scratch / "log"
        out = scratch / "whole"
        begin = time.time()
        finish(start("run", case, "--out", out, preload=kill_settings(out, 0) | {"SILT_KILL_LOG": str(log)}), "whole")
        duration = time.time() - begin
        whole = state(out), BodySeries(out / "bodies.h5")
        changes = log.read_text().splitlines()
        appends = [i for i, change in enumerate(changes) if "fallocate" in change and change.endswith("/bodies.h5")]
        first, last = appends[NODES_ARE_FULL], appends[NODES_ARE_FULL + 1]
        print(f"{len(changes)} changes, of them {last - first} of one append", flush=True)
        for at in [*spread(0, len(changes), options.writes), *spread(first, last, options.appends)]:
            kill_one(scratch, whole, case, at=1 + at)
        random.seed(options.seed)
        for _ in range(options.moments):
            kill_one(scratch, whole, case, after=random.uniform(0.1, 1) * duration)


main()
