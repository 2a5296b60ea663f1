#!/usr/bin/python3
"""stops.py SILT [--moments N] [--ranks N...] [--limit SECONDS] [--load] [--seed N]: runs that are told to
stop by SIGTERM at random moments, from their start on, have begun a checkpoint within --limit seconds (2), or
ended at once where no step had been begun. Beds of spheres whose steps become a thousand times as long when
the first land, without a fluid and with one. --load: beside a program on each core."""
import argparse
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from silt_runs import ENVIRONMENT, WALLS_ACROSS_Z, command, domain_of, fill_of, shape_of  # noqa: E402

DRY = (domain_of([100, 100, 400], WALLS_ACROSS_Z) + "[gravity]\nacceleration = [0, 0, -1e-5]\n" +
       "[contacts]\nfriction = 0.5\nsweeps = 64\nmargin = 0.5\n" +
       shape_of("ball", "sphere", "radius = 3") +
       fill_of("ball", 2, 2000, "gap = 0.7", "box = [[0, 0, 100], [100, 100, 400]]") +
       "[run]\nsteps = 1000000\n")
WET = DRY.replace("size = [100, 100, 400]", "size = [60, 60, 80]").replace("2000", "200").replace("-1e-5", "-1e-6").replace(
    "box = [[0, 0, 100], [100, 100, 400]]\n", "").replace("[contacts]", "[fluid]\nrelaxation_time = 0.8\n[contacts]")
SCENES = {"dry": DRY, "wet": WET}


def ranks_of(process, ranks):
    """Returns the processes of a run."""
    if ranks == 1:
        return [process.pid]
    children = subprocess.run(["pgrep", "-P", str(process.pid)], capture_output=True, text=True).stdout.split()
    return [int(child) for child in children]


def wait_until(condition, process, seconds):
    """Returns how long it took until condition(), or the end of the process."""
    begin = time.monotonic()
    while not condition() and process.poll() is None:
        if time.monotonic() - begin > seconds:
            process.kill()
            process.communicate()
            raise SystemExit(f"nothing within {seconds} s")
        time.sleep(0.005)
    return time.monotonic() - begin


def stop(silt, scene, ranks, moment):
    """Tells a run to stop so many seconds after it has begun; returns how long it took and what it did."""
    with tempfile.TemporaryDirectory(prefix="silt-stop-") as folder:
        case = pathlib.Path(folder) / "case.toml"
        case.write_text(SCENES[scene])
        out = case.parent / "out"
        process = subprocess.Popen(command(silt, "run", case, ranks=ranks), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                   text=True, env=ENVIRONMENT)
        wait_until((out / "run.log").exists, process, 60)
        time.sleep(moment)
        for pid in ranks_of(process, ranks):
            os.kill(pid, signal.SIGTERM)
        waited = wait_until(lambda: any(out.glob("checkpoint_*")), process, 120)
        errors = process.communicate(timeout=120)[1]
        if process.returncode != 4:
            raise SystemExit(f"{scene}, {ranks} ranks, after {moment:.2f} s: exit {process.returncode}\n{errors}")
        return waited, errors[errors.index("told to"):].split(";")[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("silt", type=pathlib.Path)
    parser.add_argument("--moments", type=int, default=20)
    parser.add_argument("--longest", type=float, default=20, metavar="SECONDS", help="moments are spread over so long")
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--limit", type=float, default=2)
    parser.add_argument("--load", action="store_true")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    load = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count() if options.load else 0)]
    chance = random.Random(options.seed)
    late = []
    try:
        for number in range(options.moments):
            scene, ranks = list(SCENES)[number % 2], options.ranks[number // 2 % len(options.ranks)]
            moment = options.longest * chance.random()
            waited, said = stop(options.silt.resolve(), scene, ranks, moment)
            print(f"{scene}, {ranks} ranks, after {moment:5.2f} s: {waited:.2f} s, {said}", flush=True)
            if waited > options.limit:
                late.append((scene, ranks, moment, waited))
    finally:
        for process in load:
            process.kill()
    sys.exit(f"later than {options.limit} s: {late}" if late else 0)


if __name__ == "__main__":
    main()
