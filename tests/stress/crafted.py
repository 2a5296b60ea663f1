#!/usr/bin/python3
"""crafted SILT [--count N] [--seed S]: checkpoints that no run wrote, with every checksum right. Every
dataset and every number of three runs' checkpoints (a fluid with contacts, a dry heap, bodies that come and
go) is replaced by what it cannot be: not a number, infinite, negative, the largest of its type, of another
shape or type, missing, a link to another place, to a pipe, or with its values in one.
Each is resumed on one or two ranks. None may end by a signal or take more than ten seconds; what names
nothing a run can have left is refused by its name, and what was in the folder stays as it was. N of them, at
random; without --count all.
"""
import argparse
import collections
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from silt_runs import ENVIRONMENT, WALLS_ACROSS_Z, body_of, command, domain_of, fill_of, shape_of  # noqa: E402

LIMIT = 10  # seconds

BALL = shape_of("ball", "sphere", "radius = 2.5")
RUN = "[run]\nsteps = 30\n[output]\ncheckpoint = { every = 10, keep = 9 }\nbodies = { every = 10 }\n"
WET = (domain_of([24, 16, 16], WALLS_ACROSS_Z) + "[fluid]\nrelaxation_time = 0.8\n[gravity]\nacceleration = [0, 0, -1e-4]\n" + BALL +
       body_of("ball", 1.5, "velocity = [0.02, 0, 0]", "positions = [[6, 8, 2.5], [11, 8, 2.5]]") +
       '[[quantities]]\nname = "height"\ntype = "mean-height"\n' + RUN)
DRY = (domain_of([24, 24, 24], '{ x = "periodic", y = "no-slip", z = "no-slip" }') + "[gravity]\nacceleration = [0, 0, -1e-3]\n" +
       "[contacts]\nfriction = 0.5\n" + shape_of("box", "box", "edges = [6, 5, 4]") +
       body_of("box", 2, "positions = [[6, 12, 2], [6, 12, 6], [6.5, 12, 10], [16, 12, 2]]") + RUN)
FEED = (domain_of([24, 24, 40], WALLS_ACROSS_Z) + "[gravity]\nacceleration = [0, 0, -2e-2]\n" + BALL +
        fill_of("ball", 2, 2, "every = 5", "velocity = [0, 0, -0.3]", "box = [[0, 0, 30], [24, 24, 40]]") +
        "[[outflow]]\nbox = [[0, 0, 0], [24, 24, 8]]\n" + RUN)
CASES = {"wet": WET, "dry": DRY, "feed": FEED}


def checksum(values):
    """Returns the checksum of adapters/hdf5/checkpoint_verify.cpp."""
    data = np.ascontiguousarray(values).reshape(-1)
    bits = data.view(f"u{data.dtype.itemsize}").astype(np.uint64)
    with np.errstate(over="ignore"):
        x = bits + np.uint64(0x9E3779B97F4A7C15) * np.arange(1, len(bits) + 1, dtype=np.uint64)
        x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        x ^= x >> np.uint64(31)
        return np.uint64(np.where(bits != 0, x, np.uint64(0)).sum(dtype=np.uint64))


def put(f, name, values):
    attributes = dict(f[name].attrs)
    del f[name]
    f.create_dataset(name, data=values)
    f[name].attrs.update(attributes, checksum=checksum(values))


def pipe_beside(f):
    target = pathlib.Path(f.filename).with_name("pipe")
    if not target.exists():
        os.mkfifo(target)
    return str(target)


def one_value(what):
    """Changes one value, by chance which."""
    def damage(f, name, chance):
        values = f[name][:]
        if not values.size or (values.dtype.kind != "f" and what in ("nan", "inf")):
            return False
        kind = values.dtype
        limits = np.finfo(kind) if kind.kind == "f" else np.iinfo(kind)
        value = {"nan": np.nan, "inf": -np.inf, "minus one": -1 if kind.kind != "u" else limits.max, "zero": 0,
                 "largest": limits.max, "smallest": limits.min, "out of range": 10**6 if limits.max > 10**6 else 100}[what]
        values.reshape(-1)[chance.randrange(values.size)] = value
        put(f, name, values)
        return True
    return damage


def other_shape(f, name, chance):
    values = f[name][:]
    put(f, name, chance.choice([np.concatenate([values, values[:1]]), values[:-1] if len(values) > 1 else values[:0],
                                values.reshape(-1), values[..., None]]) if values.size else np.zeros((3, 2), values.dtype))
    return True


def other_type(f, name, chance):
    values = f[name][:]
    kinds = [k for k in ("f4", "f8", "i4", "u8", "i1", "u1") if np.dtype(k) != values.dtype]
    put(f, name, np.zeros(values.shape, chance.choice(kinds)))
    return values.size > 0


def missing(f, name, _):
    del f[name]
    return True


def linked(f, name, chance):
    del f[name]
    f[name] = chance.choice([h5py.ExternalLink(pipe_beside(f), "/x"), h5py.SoftLink("/bodies/id"), h5py.SoftLink("/nowhere")])
    return True


def piped(f, name, _):
    shape, kind = f[name].shape, f[name].dtype
    if not f[name].size:
        return False
    del f[name]
    f.create_dataset(name, shape, kind, external=[(pipe_beside(f), 0, h5py.h5f.UNLIMITED)]).attrs["checksum"] = np.uint64(0)
    return True


def without_checksum(f, name, _):
    del f[name].attrs["checksum"]
    return True


OF_DATASETS = {w: one_value(w) for w in ("nan", "inf", "minus one", "zero", "largest", "smallest", "out of range")}
OF_DATASETS |= {"other shape": other_shape, "other type": other_type, "missing": missing, "linked": linked, "piped": piped,
                "without checksum": without_checksum}
REFUSED = {"nan", "inf", "other shape", "other type", "missing", "linked", "piped", "without checksum"}  # in any dataset
ATTRIBUTES = {"nan": np.nan, "inf": np.inf, "minus one": -1, "largest": np.iinfo(np.int64).max, "text": "x", "pair": np.array([1, 2])}
UNREAD = {"time"}


def damages(f):
    """[(name, what)] of a checkpoint."""
    found = []
    for group in ("bodies", "impulses", "cells"):
        found += [(f"/{group}/{name}", what) for name in f[group] for what in OF_DATASETS]
        found += [(f"/{group}", "missing"), (f"/{group}", "linked")]
    for name, value in f["state"].attrs.items():
        if name in UNREAD:
            continue
        kinds = ["missing", "pair"] if isinstance(value, bytes | str) else ["missing", *ATTRIBUTES]
        found += [(f"/state {name}", what) for what in kinds]
    return found + [("/state", "linked"), ("/provenance", "linked"), ("/provenance/case_text", "linked"), ("/state", "missing")]


def craft(f, name, what, chance):
    """Returns whether there was something to change."""
    group, _, attribute = name.partition(" ")
    if not attribute:
        return OF_DATASETS[what](f, name, chance)
    values = f[group].attrs
    if what == "missing":
        del values[attribute]
    elif what in ("nan", "inf", "minus one", "largest") and isinstance(values[attribute], np.floating):
        values[attribute] = np.float64({"largest": np.inf, "minus one": -np.inf}.get(what, ATTRIBUTES[what]))
    elif what in ("nan", "inf"):
        return False
    else:
        values[attribute] = np.int64(ATTRIBUTES[what]) if isinstance(ATTRIBUTES[what], int) else ATTRIBUTES[what]
    return True


def contents(folder):
    return {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()}


class Bench:
    def __init__(self, silt, folder):
        self.silt, self.folder, self.good = silt, folder, {}
        for name, text in CASES.items():
            case = folder / name
            case.mkdir()
            (case / "case.toml").write_text(text)
            done = self.run("run", case, "--steps", "20")
            if done.returncode:
                raise SystemExit(f"{name} ended with {done.returncode}:\n{done.stderr}")
            shutil.copytree(case / "out", folder / (name + ".good"))

    def run(self, *arguments, ranks=1):
        process = subprocess.Popen(command(self.silt, *arguments, ranks=ranks), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, env=ENVIRONMENT, stdin=subprocess.DEVNULL, start_new_session=True)
        try:
            out, errors = process.communicate(timeout=LIMIT)
        except subprocess.TimeoutExpired:
            process.terminate()  # mpirun ends its ranks
            try:
                process.communicate(timeout=LIMIT)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
            raise
        return subprocess.CompletedProcess(process.args, process.returncode, out, errors)

    def newest(self, case):
        return sorted((self.folder / (case + ".good")).glob("checkpoint_*.h5"))[-1].name

    def try_one(self, case, name, what, chance, ranks):
        """Returns what is wrong, or how it went."""
        out = self.folder / case / "out"
        shutil.rmtree(out, ignore_errors=True)
        shutil.copytree(self.folder / (case + ".good"), out)
        path = out / self.newest(case)
        for before in out.glob("checkpoint_*.h5") if ranks > 1 else []:
            if before != path:
                before.unlink()  # or the run goes on from the one before
        with h5py.File(path, "r+") as f:
            if not craft(f, name, what, chance):
                return "nothing to change"
        before = contents(out)
        try:
            done = self.run("resume", self.folder / case, "--steps", 21, ranks=ranks)
        except subprocess.TimeoutExpired:
            return f"WRONG: more than {LIMIT} s"
        if done.returncode not in (0, 2, 3) or "signal" in done.stderr.lower():
            return f"WRONG: code {done.returncode}: {done.stderr.strip()[-300:]}"
        refused = done.returncode == 2
        # a checkpoint that cannot be read is passed over for the one before it; the page says which
        passed_over = done.returncode == 0 and "passed over" in done.stdout + done.stderr
        if name.startswith("/state start."):  # read by a run that begins from it ([initial] from), not by one that goes on
            return "harmless" if done.returncode == 0 else f"WRONG: code {done.returncode}"
        if name.startswith("/state ") and what in ("nan", "inf", "text", "pair", "missing") or what in REFUSED:
            if name.startswith("/state quantity.") and what in ("missing", "inf", "minus one", "largest"):
                return "harmless"
            if not refused and not passed_over:
                return f"WRONG: accepted (code {done.returncode})"
            if name.rsplit(" ")[-1].rsplit("/")[-1] not in done.stderr + done.stdout:
                return f"WRONG: not named: {done.stderr.strip()[-300:]}"
        if refused and contents(out) != before:
            changed = [n for n, b in contents(out).items() if before.get(n) != b]
            return f"WRONG: changed {changed}"
        return "refused" if refused else "passed over" if passed_over else "stopped" if done.returncode == 3 else "harmless"


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("silt")
    arguments.add_argument("--count", type=int)
    arguments.add_argument("--seed", type=int, default=1)
    options = arguments.parse_args()
    chance = random.Random(options.seed)
    with tempfile.TemporaryDirectory(prefix="silt-crafted-") as folder:
        bench = Bench(options.silt, pathlib.Path(folder))
        todo = []
        for case in CASES:
            with h5py.File(bench.folder / (case + ".good") / bench.newest(case)) as f:
                todo += [(case, *d) for d in damages(f)]
        if options.count:
            todo = chance.sample(todo, options.count)
        ended, wrong, slowest = collections.Counter(), 0, 0
        for i, (case, name, what) in enumerate(todo):
            start = time.monotonic()
            how = bench.try_one(case, name, what, chance, 1 + (i % 4 == 3))
            slowest = max(slowest, time.monotonic() - start)
            ended[how.partition(":")[0]] += 1
            if how.startswith("WRONG"):
                wrong += 1
                print(f"{case} {name}, {what}: {how}", flush=True)
        print(f"{len(todo)} crafted checkpoints: " + ", ".join(f"{n} {how}" for how, n in ended.most_common()) +
              f"; the slowest took {slowest:.1f} s")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
