#!/usr/bin/python3
"""hostile_names.py SILT: scripts take folders' names for names, whatever is in them; what scripts/submit
writes is a script that SLURM takes, with what was asked for, and what cannot be is refused with the
reason."""
import concurrent.futures
import os
import pathlib
import shlex
import shutil
import subprocess
import tempfile
import unittest

from silt_test import CASE, ROOT, SCRIPTS, SILT, SiltTest, module_of, script

# Each would leave a file X, lose a letter, or be another's option, pattern or format where it is not taken for a name.
NAMES = ["line\ntouch X\n#SBATCH --comment=X", "it's", 'say "x"', "$(touch X)", "`touch X`", "a;touch X;b", "-rf", "  two  words ", "*", "a&touch X&b",
         "Kügelchen, 雪", "%x-%s%n%(name)s{name}", "back\\slash\\n", "caf\udce9 of Latin-1"]
MORE = ["a|touch X", ">X", "~", "$HOME ${x^}", "!x", "#x", "[a-z]?"]

# Stand for what scripts hand their commands to: says where it is and what it was given.
STAND_IN = '#!/bin/bash\n{ printf "%s\\0" "$(basename "$0")" "$PWD" "$@"; } >>"$SAID"\n'


def said_by(words, **options):
    return subprocess.run(words, capture_output=True, text=True, errors="surrogateescape", **options)


def directives(script):
    """Returns what SLURM takes of a script: the comments before the first command."""
    lines = []
    for line in script.split("\n"):
        if line and not line.startswith("#"):
            break
        if line.startswith("#SBATCH"):
            lines.append(line.removeprefix("#SBATCH --").split("=", 1))
    return dict(lines)


class HostileNames(SiltTest):
    def setUp(self):
        super().setUp()
        self.folder = pathlib.Path(self.scratch.name)
        self.work = self.folder / "work"
        self.work.mkdir()
        stand_ins = self.folder / "bin"
        stand_ins.mkdir()
        for name in ("sbatch", "mpirun", "ffmpeg"):
            (stand_ins / name).write_text(STAND_IN)
            (stand_ins / name).chmod(0o755)
        self.with_stand_ins = {**os.environ, "PATH": f"{stand_ins}:{os.environ['PATH']}"}

    def handed_over(self, *words):
        """Runs a command with the stand-ins and returns the words that one of them was given."""
        with tempfile.NamedTemporaryFile() as said:
            done = said_by(words, cwd=self.work, env={**self.with_stand_ins, "SAID": said.name})
            self.assertEqual(done.returncode, 0, (words, done.stdout, done.stderr))
            return os.fsdecode(pathlib.Path(said.name).read_bytes()).split("\0")[:-1]

    def nothing_was_carried_out(self, top):
        """Looks for what must not be there: X, and anything beside the folders that were made."""
        self.assertEqual({path.name for path in self.work.iterdir()}, top)
        self.assertEqual([str(path) for path in self.folder.rglob("X*")], [])
        self.assertFalse((ROOT / "X").exists())

    def test_each_by_itself(self):
        """Scripts that use the name of a case's folder, not only its path."""
        program = (CASE.replace('title = "two balls"\n', "# two balls\n\ntitle = \"x\"\n")
                   .replace("radius = 2.5", "radius = 2.5\n[[shapes]]\nname = \"gear\"\ntype = \"mesh\"\nfile = \"gear.stl\""))
        self.write(program)
        script("make_mesh", "gear", self.case / "gear.stl")
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            list(pool.map(self.use_by_itself, NAMES))
        self.nothing_was_carried_out(set(NAMES))
        self.completes()

    def use_by_itself(self, name):
        made, at = self.work / name, {"cwd": self.work}
        script("new-case", f"./{name}", "--from", self.case, **at)
        self.assertIn(name.replace("-", " ").encode(errors="replace").decode().split("\n")[0], self.silt("check", made, errors="surrogateescape").stdout, name)
        script("make_mesh", "cube", f"./{name}/cube.ply", **at)
        self.assertEqual({path.name for path in made.iterdir()}, {"case.toml", "gear.stl", "cube.ply"})
        self.assertEqual(self.handed_over(SCRIPTS / "submit", f"./{name}", "-n", "2", "--out", f"./{name}/out", "--set", "run.steps=50"),
                         ["sbatch", str(made), str(made / "submit.sh")])
        asked = directives((made / "submit.sh").read_text(errors="surrogateescape"))
        self.assertEqual(list(asked), ["job-name", "ntasks", "time", "output"], name)
        self.assertRegex(asked["job-name"], r"\A[\w.-]+\Z")
        words = self.handed_over("bash", made / "submit.sh")
        self.assertEqual(words[:2], ["mpirun", str(made)])
        self.assertEqual(words[words.index("run") + 1], str(made))
        self.assertEqual(words[words.index("--out") + 1], str(made / "out"))
        (made / "out").mkdir()
        (made / "out" / "run.log").write_text("")
        script("clean", f"./{name}", "--yes", **at)
        self.assertFalse((made / "out").exists())

    def completes(self):
        """The completion offers what there is, and carries none of it out."""
        done = said_by(["bash", "-c", f"source {shlex.quote(str(SCRIPTS))}/completion.bash; for word in '' '$' ./ ./-; do COMP_WORDS=(silt run \"$word\"); "
                               "COMP_CWORD=2; _silt; printf '%s\\0' \"${COMPREPLY[@]}\"; done"], check=True, cwd=self.work)
        for name in ("it's", "$(touch X)", "./-rf", "*"):
            self.assertIn(name, done.stdout.split("\0"))
        tree = self.folder / "tree"  # one whose own cases have such names
        (tree / "scripts").mkdir(parents=True)
        shutil.copy(SCRIPTS / "completion.bash", tree / "scripts")
        for name in NAMES + MORE:
            (tree / "cases" / name).mkdir(parents=True)
        done = said_by(["bash", "-c", "source scripts/completion.bash; COMP_WORDS=(scripts/run ''); COMP_CWORD=1; _silt_script; "
                               "printf '%s\\0' \"${COMPREPLY[@]}\""], check=True, cwd=tree)
        self.assertIn("$(touch X)", done.stdout.split("\0"))
        self.nothing_was_carried_out(set(NAMES))

    def test_all_in_one_path(self):
        """Scripts that run a case or read its results, in a folder below all of those."""
        path = pathlib.Path(*NAMES, *MORE)
        (self.work / path).mkdir(parents=True)
        case, at = f"./{path}", {"cwd": self.work}
        (self.work / path / "case.toml").write_text(CASE.replace("[output]", "[output]\nreport = { every = 20 }"))
        (self.work / path / "reference.toml").write_text('[[quantity]]\nname = "height"\nvalue = 8.5\ntolerance = 1\nkind = "theory"\nsource = "s"\n')
        # stopped by a signal, it says how to go on; that is a command that can be pasted
        stopped = said_by([SCRIPTS / "run", case, "--silt", SILT, "--time-limit", "1e-9"], **at)
        self.assertEqual(stopped.returncode, 4, stopped.stderr)
        advice = stopped.stderr[stopped.stderr.rindex(" with: ") + len(" with: "):]
        self.assertEqual(said_by(["bash", "-c", f"printf '%s\\0' {advice}"], check=True, **at).stdout.split("\0")[:2],
                         [str(SCRIPTS / "run"), case])
        script("run", case, "--silt", SILT, "--resume", **at)
        found = {entry.name for entry in (self.work / path / "out").iterdir()}
        self.assertLessEqual({"report.json", "report.html", "bodies.h5", "velocity.png", "slice.png"}, found)
        calls = [("compare", case, case, "--page", f"{case}/runs.html"), ("watch", case), ("sweep", case, "--vary", "run.steps=1,2", "--collect"), ("surfaces", case), ("regress", case, "--silt", SILT)]
        if shutil.which("povray"):
            calls.append(("render", case, "--size", 40))
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            list(pool.map(lambda call: script(*call, **at), calls))
        if shutil.which("povray"):
            words = self.handed_over(SCRIPTS / "render", case, "--size", "40", "--film", "--frames", "2", "--to=-%d:film.mp4")
            self.assertEqual((words[0], words[-1]), ("ffmpeg", f"file:{self.work}/-%d:film.mp4"))
        self.nothing_was_carried_out({NAMES[0]})


class Submit(unittest.TestCase):
    def setUp(self):
        self.module = module_of("submit")
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.case = self.folder / "case"
        self.case.mkdir()
        (self.case / "case.toml").write_text(CASE)

    def test_forms_of_a_time(self):
        for text, seconds in {"10": 600, "1:30": 90, "01:00:00": 3600, "2-3": 2 * 86400 + 3 * 3600, "1-0:30": 86400 + 1800,
                              "1-01:02:03": 86400 + 3723, "x": None, "1:2:3:4": None, "": None, "10\n": None, "１０": None}.items():
            self.assertEqual(self.module.seconds(text), seconds, text)

    def test_what_was_asked_for(self):
        script("submit", self.case, "-n", 8, "--nodes", 2, "--time", "02:00:00", "--partition", "short", "--account", "fluids", "--memory", "64G",
                "--module", "gcc/12.2", "--module", "openmpi/4.1", "--no-submit",
                "--set", "run.steps=50", "--out", self.folder / "results", "--resume")
        text = (self.case / "submit.sh").read_text()
        self.assertEqual(directives(text), {"job-name": "silt-case", "ntasks": "8", "nodes": "2", "time": "02:00:00", "partition": "short",
                                              "account": "fluids", "mem": "64G", "output": "%x-%j.log", "distribution": "block:cyclic"})
        self.assertTrue(text.startswith("#!/bin/bash -l\n"))
        self.assertIn("module load gcc/12.2 || exit 1\nmodule load openmpi/4.1 || exit 1\nset -euo pipefail\n", text)
        words = shlex.split(text.splitlines()[-1])
        self.assertEqual(words[:4], ["exec", "mpirun", "-n", "8"])
        self.assertIn("--bind-to", words)
        for option, value in {"--time-limit": "6900", "--set": "run.steps=50", "resume": str(self.case), "--out": str(self.folder / "results")}.items():
            self.assertEqual(words[words.index(option) + 1], value)  # 6900: 300 s before the end
        self.assertEqual(subprocess.run(["bash", "-n", self.case / "submit.sh"]).returncode, 0)
        script("submit", self.case, "-n", 16, "--nodes", 2, "--gpus", 4, "--no-submit")
        text = (self.case / "submit.sh").read_text()
        self.assertEqual(directives(text)["gpus-per-node"], "4")
        self.assertIn("srun --ntasks-per-node=1 nvidia-cuda-mps-control -d", text)
        words = shlex.split(text.splitlines()[-1])
        self.assertEqual(words[words.index("--device") + 1], "gpu")
        self.assertEqual(subprocess.run(["bash", "-n", self.case / "submit.sh"]).returncode, 0)
        if shutil.which("sbatch") and subprocess.run(["sinfo"], capture_output=True).returncode == 0:
            script("submit", self.case, "--time", 10, "--no-submit")
            judged = subprocess.run(["sbatch", "--test-only", self.case / "submit.sh"], capture_output=True, text=True)
            self.assertEqual(judged.returncode, 0, judged.stderr)

    def test_what_cannot_be_is_refused(self):
        for words, said in {("--time", "5"): "leaves nothing before the margin of 300 s",
                            ("--time", "soon"): "give MINUTES, MM:SS, HH:MM:SS or D-HH:MM:SS",
                            ("-n", "2", "--nodes", "3"): "2 ranks on 3 nodes",
                            ("--gpus", "0"): "--gpus 0: there must be at least one a node",
                            ("--account", "a\n#SBATCH --wrap=x"): "it must be one word of ASCII characters",
                            ("--module", "a; rm x"): "it must be one word of ASCII characters",
                            ("--partition", "a b"): "it must be one word of ASCII characters",
                            ("--no-submit", "--set", "fluid.viscosty=1"): "viscosty"}.items():
            self.assertIn(said, script("submit", self.case, *words, code=2))
        self.assertIn("a directory with a case.toml", script("submit", self.case / "nowhere", code=2))


if __name__ == "__main__":
    unittest.main()
