"""Runs of the program silt, for the scripts among the tests. It puts scripts/ and scripts/accuracy on their path."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
SCRIPTS = ROOT / "scripts"
MPIRUN = ["mpirun", "--oversubscribe", "--allow-run-as-root", "--quiet"]
ENVIRONMENT = dict(os.environ, OMPI_MCA_rmaps_base_oversubscribe="1", SILT_PLAIN="1")
sys.path[:0] = [str(SCRIPTS / "accuracy"), str(SCRIPTS)]
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell has its jobs in the background ignore it, and theirs


def command(silt, *words, ranks=1):
    """Returns the words of a command of silt on so many ranks."""
    return [*([*MPIRUN, "-np", str(ranks)] if ranks > 1 else []), str(silt), *map(str, words)]


def run(silt, *words, ranks=1, code=0, **options):
    """Runs a command of silt. Ends with what it says if its exit code is another one (None: any is right)."""
    options = dict(env=ENVIRONMENT, stdin=subprocess.DEVNULL, capture_output=True, text=True) | options
    done = subprocess.run(command(silt, *words, ranks=ranks), **options)
    if code is not None and done.returncode != code:
        raise SystemExit(f"{words} ended with code {done.returncode}:\n{done.stdout}{done.stderr}")
    return done


def report_of(out):
    return json.loads((pathlib.Path(out) / "report.json").read_text())


def run_text(silt, text, *options, read=report_of, command="run", **others):
    """Runs or checks a case that is given as text, in a folder of its own. Returns what it says, and read(results) of a
    run that came to its end."""
    with tempfile.TemporaryDirectory(prefix="silt-test-") as folder:
        (pathlib.Path(folder) / "case.toml").write_text(text)
        out = pathlib.Path(folder) / "out"
        done = run(silt, command, folder, *(["--out", out] if command == "run" else []), *options, **others)
        return done, read(out) if command == "run" and done.returncode == 0 else None


WALLS_ACROSS_Z = '{ x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] }'


def domain_of(size, boundary='"periodic"'):
    """The text of [units] and [domain] of a case in lattice units; `boundary` in TOML."""
    return f'[units]\nsystem = "lattice"\n[domain]\nsize = {size}\nboundary = {boundary}\n'


def entry_of(section, lines, *more):
    """The text of an entry of [[SECTION]] with these lines."""
    return "\n".join([f"[[{section}]]", *lines, *more]) + "\n"


def shape_of(name, kind, *sizes):
    return entry_of("shapes", [f'name = "{name}"', f'type = "{kind}"'], *sizes)


def body_of(shape, density, *lines):
    return entry_of("bodies", [f'shape = "{shape}"', f"density = {density}"], *lines)


def fill_of(shape, density, count, *lines):
    return entry_of("fill", [f'shape = "{shape}"', f"density = {density}", f"count = {count}"], *lines)
