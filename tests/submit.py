#!/usr/bin/python3
"""submit.py ROOT: what scripts/submit writes is a script that SLURM takes, with what was asked for; what cannot be is refused
with the reason. Where SLURM runs, sbatch --test-only judges it too."""
import importlib.machinery
import importlib.util
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

root = pathlib.Path(sys.argv[1]).resolve()
program = root / "scripts/submit"
loader = importlib.machinery.SourceFileLoader("submit", str(program))
submit = importlib.util.module_from_spec(importlib.util.spec_from_loader("submit", loader))
sys.dont_write_bytecode = True
loader.exec_module(submit)

# SLURM's forms of a time (sbatch, --time)
for text, seconds in {"10": 600, "1:30": 90, "01:00:00": 3600, "2-3": 2 * 86400 + 3 * 3600, "1-0:30": 86400 + 1800,
                      "1-01:02:03": 86400 + 3723, "x": None, "1:2:3:4": None, "": None}.items():
    assert submit.seconds(text) == seconds, (text, submit.seconds(text))


def run(*words):
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True)


def directives(script):
    return dict(line.removeprefix("#SBATCH --").split("=", 1) for line in script.splitlines() if line.startswith("#SBATCH"))


with tempfile.TemporaryDirectory() as scratch:
    case = pathlib.Path(scratch) / "a case"
    shutil.copytree(root / "cases/segregation", case, ignore=shutil.ignore_patterns("out*"))
    done = run(case, "-n", 8, "--nodes", 2, "--time", "02:00:00", "--partition", "short", "--account", "fluids", "--no-submit",
               "--set", "run.steps=50", "--out", pathlib.Path(scratch) / "results", "--resume")
    assert done.returncode == 0, done.stderr
    script = (case / "submit.sh").read_text()
    asked = directives(script)
    assert asked["ntasks"] == "8" and asked["nodes"] == "2" and asked["time"] == "02:00:00", asked
    assert asked["partition"] == "short" and asked["account"] == "fluids", asked
    words = shlex.split(script.splitlines()[-1])
    assert words[:4] == ["exec", "mpirun", "-n", "8"] and "--bind-to" in words, words
    assert words[words.index("--time-limit") + 1] == "6900", words  # 300 s before the end
    assert words[words.index("--set") + 1] == "run.steps=50" and words[words.index("resume") + 1] == str(case), words
    assert words[words.index("--out") + 1] == str(pathlib.Path(scratch) / "results"), words
    assert subprocess.run(["bash", "-n", case / "submit.sh"]).returncode == 0
    if shutil.which("sbatch") and subprocess.run(["sinfo"], capture_output=True).returncode == 0:
        run(case, "--time", 10, "--no-submit")
        judged = subprocess.run(["sbatch", "--test-only", case / "submit.sh"], capture_output=True, text=True)
        assert judged.returncode == 0, judged.stderr

    for words, said in {(case, "--time", "5"): "leaves nothing before the margin of 300 s",
                        (case, "--time", "soon"): "give MINUTES, MM:SS, HH:MM:SS or D-HH:MM:SS",
                        (case, "-n", "2", "--nodes", "3"): "2 ranks on 3 nodes",
                        (case / "nowhere",): "a directory with a case.toml",
                        (case, "--no-submit", "--set", "fluid.viscosty=1"): "viscosty"}.items():
        refused = run(*words)
        assert refused.returncode == 2 and said in refused.stderr, (words, refused.returncode, refused.stderr)
print("what scripts/submit writes is what was asked for")
