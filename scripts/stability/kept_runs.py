"""Runs of cases whose verdicts are kept in OUT/results.jsonl by case text and program: nothing is run twice."""
import concurrent.futures
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "accuracy"))

from harness.results import Results, digest  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
GUARD = 3  # exit code of silt where a guard ends a run


def add_options(parser):
    parser.add_argument("--quick", action="store_true", help="a few points")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE", help="also write the figures there")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "stability-out", metavar="DIR")
    parser.add_argument("-j", "--jobs", type=int, default=1, metavar="N")
    parser.add_argument("--silt", type=pathlib.Path, metavar="PROGRAM", help="use this one; build nothing")


class KeptRuns:
    """judge(report, folder of results, point) gives the verdict of a run that ended by itself; one that a guard ended is "stopped"."""

    def __init__(self, options, judge):
        self.silt = options.silt.resolve() if options.silt else ROOT / "build/release/bin/silt"
        if not options.silt:
            subprocess.run([ROOT / "scripts/build", "release", "silt"], check=True)
        options.out.mkdir(parents=True, exist_ok=True)
        self.program = hashlib.sha256(self.silt.read_bytes()).hexdigest()
        self.results = Results(options.out / "results.jsonl")
        self.jobs, self.judge = options.jobs, judge

    def verdict(self, point, text):
        key = digest(text, self.program)
        if not (kept := self.results.get(key)):
            kept = {"fingerprint": key, "verdict": self.run(point, text)}
            self.results.add(kept)
        return kept["verdict"]

    def run(self, point, text):
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            (folder / "case.toml").write_text(text)
            done = subprocess.run([self.silt, "run", folder, "--out", folder / "out"], stdin=subprocess.DEVNULL, capture_output=True, text=True)
            if done.returncode == GUARD:
                return "stopped"
            if done.returncode != 0:
                raise RuntimeError(f"silt ended with code {done.returncode}:\n{done.stderr}\n{text}")
            return self.judge(json.loads((folder / "out" / "report.json").read_text()), folder / "out", point)

    def verdicts(self, points, text_of, said_of):
        """Returns {point: verdict}; prints what does not last, and how far it is."""
        found = {}
        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            words = pool.map(self.verdict, points, map(text_of, points))
            for i, (point, word) in enumerate(zip(points, words), 1):
                found[point] = word
                if word != "stable" or i % 20 == 0:
                    print(f"{i} of {len(points)}: {said_of(point)}: {word}", flush=True)
        return found
