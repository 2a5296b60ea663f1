#!/usr/bin/python3
"""Errors of one rank while a run writes: errors.py --silt SILT --preload LIBRARY [--changes N] [--memory N]
[--ranks N]. N times one change of a file by one rank fails (and, every other time, all that follow), or so
does one of its allocations of memory (fault_at_write.cpp). The run must end within ten seconds of it, without
a signal, and name the reason, the file and the rank; or it had no need of what failed. What goes on from
there must come to the results of a run without errors."""
import argparse
import errno
import functools
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time

from whole_run import Whole, finish, start
from silt_runs import domain_of, fill_of, shape_of  # on the path by whole_run

CASE = (domain_of([40, 24, 24]) + "blocks = [10, 12, 24]\n[fluid]\nrelaxation_time = 0.8\n" +
        "[gravity]\nacceleration = [0, 0, -1e-4]\n" + shape_of("ball", "sphere", "radius = 3") +
        fill_of("ball", 2, 12, "gap = 0.5") + "[run]\nsteps = 20\n" +
        "[output]\nfields = { every = 10 }\nbodies = { every = 5 }\n" +
        "checkpoint = { every = 10, keep = 2 }\nreport = { every = 5 }\n" +
        '[[output.slices]]\nname = "middle"\nbox = [[0, 8, 0], [40, 14, 24]]\nevery = 5\n' +
        '[[quantities]]\nname = "height"\ntype = "mean-height"\n')

ERRORS = [errno.ENOSPC, errno.EIO, errno.EDQUOT, errno.EFBIG, errno.EROFS]
SMALLEST = 4096  # bytes of an allocation that fails; smaller ones are those of anything
BEFORE_MAIN = 10  # such allocations, of libraries; nobody can catch their errors
LONGEST = 10  # seconds from an error to the end of a run

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--silt", required=True)
parser.add_argument("--preload", required=True)
parser.add_argument("--changes", type=int, default=0)
parser.add_argument("--memory", type=int, default=0)
parser.add_argument("--ranks", type=int, default=2)
options = parser.parse_args()
launch = functools.partial(start, options.silt, options.ranks)


def settings(out, **others):
    return {"LD_PRELOAD": options.preload, "SILT_FAULT_FOLDER": str(out)} | {f"SILT_FAULT_{k}": str(v) for k, v in others.items()}


def counted(case, out, scratch):
    """Runs without an error. Returns how many changes and how many allocations each rank counts, and the time
    it takes."""
    begin = time.time()
    finish(launch("run", case, "--out", out, preload=settings(out, LOG=scratch / "log", AT=0, ERROR=1, MEMORY=SMALLEST)), "whole")
    of_ranks = [path.read_text().splitlines() for path in sorted(scratch.glob("log*"))]
    allocations = [sum(line.startswith("allocates") for line in lines) for lines in of_ranks]
    return [len(lines) - n for lines, n in zip(of_ranks, allocations)], allocations, time.time() - begin


def fail_once(scratch, whole, case, duration, what, **others):
    out = scratch / "out"
    begin = time.time()
    process = launch("run", case, "--out", out, preload=settings(out, **others))
    try:
        text, _ = process.communicate(timeout=2 * duration + LONGEST)
    except subprocess.TimeoutExpired:
        process.terminate()
        raise AssertionError(f"{what}: it hangs\n{process.communicate(timeout=60)[0]}") from None
    seconds = time.time() - begin
    assert process.returncode in (0, 1, 2), f"{what}: exit {process.returncode}\n{text}"
    reason = "no memory" if "MEMORY" in others else os.strerror(others["ERROR"])
    if process.returncode:
        rank = rf"rank {others['RANK']}: .*" if options.ranks > 1 and process.returncode == 1 and "/run.lock: " not in text else ""
        file = r"[\w/]+\.(h5|hdf|csv|json|lock|log|part|series)\b.*" if "MEMORY" not in others else ""
        assert re.search(rank + file + reason, text), f"{what}: does not say rank, file and reason\n{text}"
    again = "resume" if list(out.glob("checkpoint_*.h5")) else "run"
    finish(launch(again, case, "--out", out, *["--overwrite"] * (again == "run")), f"{what}, {again}")
    whole.check(out, what)
    said = next((line for line in text.splitlines() if reason in line), "")
    print(f"{what}: exit {process.returncode}, {seconds:.1f} s, {again}; {said or 'not needed'}", flush=True)
    shutil.rmtree(out)


def main():
    with tempfile.TemporaryDirectory(prefix="silt-errors-") as folder:
        scratch = pathlib.Path(folder)
        case, out = scratch / "case.toml", scratch / "whole"
        case.write_text(CASE)
        changes, allocations, duration = counted(case, out, scratch)
        whole = Whole(out)
        print(f"changes of the ranks: {changes}, allocations: {allocations}", flush=True)
        for rank, count in enumerate(changes if options.changes else []):
            share = max(1, round(options.changes * count / sum(changes)))
            for i in range(share):
                at, error = 1 + (2 * i + 1) * count // (2 * share), ERRORS[i % len(ERRORS)]
                fail_once(scratch, whole, case, duration, f"change {at} of rank {rank}, {errno.errorcode[error]}", AT=at, RANK=rank,
                          ERROR=error, **({"LASTING": 1} if i % 2 else {}))
        for i in range(options.memory):
            rank = (i + 1) % len(allocations)
            at = BEFORE_MAIN + int((allocations[rank] - BEFORE_MAIN) * (0.618 * i % 1))
            fail_once(scratch, whole, case, duration, f"allocation {at} of rank {rank}", AT=at, RANK=rank, MEMORY=SMALLEST)


main()
