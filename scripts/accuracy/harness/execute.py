"""One run: its case written into a folder, the program started on it, the results measured."""
import json
import os
import shutil
import subprocess
import traceback

from problem import Outcome

LOG_LINES = 12  # of the end of a failed run's output
ENVIRONMENT = {"SILT_PLAIN": "1"}


class RunFailed(Exception):
    """RunFailed says what happened, with the end of the log."""


def launcher(ranks):
    if ranks == 1:
        return []
    as_root = ["--allow-run-as-root"] if os.getuid() == 0 else []
    return ["mpirun", "-n", str(ranks), "--oversubscribe", "--quiet", *as_root]


def write_case(run, folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "case.toml").write_text(run.case)
    for name, text in run.files.items():
        (folder / name).write_text(text)


def execute(silt, module, run, folder):
    """Returns what is kept of the run. The folder is gone afterwards, unless the run failed. Raises RunFailed."""
    write_case(run, folder)
    command = launcher(run.ranks) + [silt, "run", folder, "--out", folder / "out"]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", env={**os.environ, **ENVIRONMENT})
    if done.returncode != 0:
        end = "\n".join("    " + line for line in done.stdout.splitlines()[-LOG_LINES:])
        raise RunFailed(f"silt ended with code {done.returncode} (see {folder}); its last lines:\n{end}")
    try:
        outcome = Outcome(folder / "out")
        kept = {"measured": numbers(module.measure(run, outcome)), **costs(outcome.report, run.ranks)}
        json.dumps(kept)  # what cannot be kept is the run's fault, too
    except Exception:
        raise RunFailed(f"the run is done, but could not be measured (see {folder}):\n{traceback.format_exc(limit=-3)}") from None
    shutil.rmtree(folder)
    return kept


def numbers(measured):
    return {name: float(value) for name, value in measured.items()}


def costs(report, ranks):
    """Returns the core-seconds of the steps alone, without start-up and output."""
    return {"core_seconds": report["step_seconds"] * ranks, "wall_seconds": report["wall_seconds"],
            "steps": report["steps"], "mlups": report["mlups"], "stage_seconds": report["stage_seconds"],
            "commit": report["commit"]}
