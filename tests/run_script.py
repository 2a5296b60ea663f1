"""Runs a script of Python in a fork of the test, which has loaded matplotlib once for all of them: half a
second less for each."""
import os
import pathlib
import runpy
import subprocess
import sys
import tempfile
import traceback

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot  # noqa: E402, F401


def ended(script, arguments):
    """Runs the script as `python3 SCRIPT ARGUMENTS` does, and returns its exit code."""
    sys.argv = [str(script), *map(str, arguments)]
    sys.path[0] = str(pathlib.Path(script).resolve().parent)
    try:
        runpy.run_path(str(script), run_name="__main__")
    except SystemExit as end:
        if end.code is None or isinstance(end.code, int):
            return end.code or 0
        print(end.code, file=sys.stderr)
        return 1
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


def run_script(script, *arguments, env={}):
    """Returns a subprocess.CompletedProcess with what the script said, as text."""
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        sys.stdout.flush()
        child = os.fork()
        if child == 0:
            os.dup2(out.fileno(), 1)
            os.dup2(err.fileno(), 2)
            os.environ.update(env)
            code = ended(script, arguments)
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        out.seek(0)
        err.seek(0)
        return subprocess.CompletedProcess([str(script), *map(str, arguments)], code, out.read(), err.read())
