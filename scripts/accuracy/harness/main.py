#!/usr/bin/python3
"""Runs the reference problems of scripts/accuracy and compares them with their goals: run time against error.

What was measured is kept in OUT/results.jsonl, by case text and program: nothing is run twice, an interrupted session
goes on. OUT gets summary.md, summary.json, runs.csv and plots. Exit code 1 if a run or a problem fails, and, with
--short, if a goal is missed; 2 for bad usage.
"""
import argparse
import concurrent.futures
import hashlib
import pathlib
import shutil
import subprocess
import sys
import time

ACCURACY = pathlib.Path(__file__).resolve().parent.parent
ROOT = ACCURACY.parent.parent
sys.path[:0] = [str(ACCURACY), str(ACCURACY.parent)]

from harness import pareto, problems, tables  # noqa: E402
from harness.execute import RunFailed, execute  # noqa: E402
from harness.judge import judge, measured_of  # noqa: E402
from harness.results import Results, fingerprint  # noqa: E402


def arguments_of(argv):
    parser = argparse.ArgumentParser(prog="scripts/bench accuracy", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("problems", nargs="*", metavar="PROBLEM", help="those to run (all; see --list)")
    parser.add_argument("--short", action="store_true", help="seconds instead of hours: what CI runs")
    parser.add_argument("--only", metavar="TEXT", help="of their runs, only those with TEXT in the key")
    parser.add_argument("--rerun", action="store_true", help="run again what is kept")
    parser.add_argument("--list", action="store_true", help="the problems, their runs, and what is kept; runs nothing")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE", help="also write the figures there")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "accuracy-out", metavar="DIR",
                        help="folder for what is kept, tables and plots (accuracy-out)")
    parser.add_argument("-j", "--jobs", type=int, default=1, metavar="N",
                        help="so many runs of one rank at a time (1: times undisturbed)")
    parser.add_argument("--silt", type=pathlib.Path, metavar="PROGRAM", help="use this one; build nothing")
    parser.add_argument("--folder", type=pathlib.Path, default=ACCURACY, help=argparse.SUPPRESS)  # of the problems
    return parser, parser.parse_args(argv)


class Session:
    def __init__(self, arguments):
        self.arguments = arguments
        self.level = "short" if arguments.short else "full"
        self.out = arguments.out.resolve()
        self.silt = arguments.silt.resolve() if arguments.silt else built_silt()
        self.program = hashlib.sha256(self.silt.read_bytes()).hexdigest()
        self.results = Results(self.out / "results.jsonl")
        self.faults = []

    def copy_program(self):
        """Returns what the whole session runs, even if the program is built again meanwhile."""
        copy = self.out / "scratch" / f"silt-{self.program[:20]}"
        copy.parent.mkdir(parents=True, exist_ok=True)
        self.silt = pathlib.Path(shutil.copy2(self.silt, copy))

    def fault(self, where, text):
        if where not in self.faults:
            self.faults.append(where)
            print(f"{where}: {text}", file=sys.stderr, flush=True)

    def kept(self, module, run):
        return self.results.get(fingerprint(module, run, self.program))

    def runs(self, module):
        try:
            only = self.arguments.only or ""
            return [run for run in problems.runs_of(module, self.level) if only in run.key]
        except Exception as error:
            self.fault(module.__name__, f"runs() failed: {error!r}")
            return []

    def run(self, module, run):
        """Runs it, keeps what came out, says so."""
        name = f"{module.__name__} {run.key}"
        try:
            kept = execute(self.silt, module, run, self.out / "scratch" / module.__name__ / run.key)
        except RunFailed as failure:
            return self.fault(name, failure)
        entry = {"fingerprint": fingerprint(module, run, self.program), "problem": module.__name__, "run": run.key,
                 "settings": run.settings, "ranks": run.ranks, "program": self.program[:20],
                 "date": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()), **kept}
        self.results.add(entry)
        shown = ", ".join(f"{key} {value:.5g}" for key, value in kept["measured"].items())
        print(f"{name}: {kept['core_seconds']:.3g} core-seconds; {shown}", flush=True)

    def run_all(self, wanted):
        """Runs those of several ranks one by one, the others `jobs` at a time."""
        for module, run in wanted:
            if run.ranks > 1:
                self.run(module, run)
        single = [(module, run) for module, run in wanted if run.ranks == 1]
        with concurrent.futures.ThreadPoolExecutor(max(1, self.arguments.jobs)) as pool:
            try:
                list(pool.map(lambda one: self.run(*one), single))
            except BaseException:
                pool.shutdown(cancel_futures=True)
                raise

    def conclude(self, modules):
        """Writes figures, tables and plots of what is there; returns the rows of the summary, and what they cost."""
        rows, runs = [], []
        for module in modules:
            its_runs = self.runs(module)
            entries = {run.key: entry for run in its_runs if (entry := self.kept(module, run))}
            judged = judge(module, entries, self.level)
            rows += judged.rows
            runs += [(module.__name__, run, entries[run.key]) for run in its_runs if run.key in entries]
            if judged.fault:
                self.fault(module.__name__, judged.fault)
                continue
            try:
                pareto.write_plots(self.out, module, pareto.curves_of(module, its_runs, entries, measured_of(entries)))
            except Exception as error:
                self.fault(module.__name__, f"no plot: {error!r}")
        self.write(rows, runs)
        return rows, sum(entry["core_seconds"] for _, _, entry in runs)

    def write(self, rows, runs):
        self.out.mkdir(parents=True, exist_ok=True)
        tables.write_csv(self.out / "runs.csv", runs)
        (self.out / "summary.md").write_text(tables.markdown(rows) + "\n")
        for path in filter(None, (self.out / "summary.json", self.arguments.json)):
            tables.write_json(path, ROOT, rows)


def built_silt():
    subprocess.run([ROOT / "scripts" / "build", "release", "silt"], check=True)
    return ROOT / "build" / "release" / "bin" / "silt"


def load_modules(arguments, parser):
    """Returns (modules, {name: what is wrong}). Ends the program for an unknown name."""
    known = problems.names(arguments.folder)
    sys.path.insert(0, str(arguments.folder))
    for name in arguments.problems:
        if name not in known:
            parser.error(f"no problem {name!r}; known: {', '.join(known)}")
    loaded = {name: problems.load(arguments.folder, name) for name in arguments.problems or known}
    return ([module for module, _ in loaded.values() if module], {name: text for name, (_, text) in loaded.items() if text})


def list_problems(session, modules):
    for module in modules:
        runs = session.runs(module)
        kept = [run for run in runs if session.kept(module, run)]
        print(f"{module.__name__}: {problems.summary(module)}\n    {len(runs)} runs, {len(kept)} kept: "
              f"{' '.join(run.key for run in runs)}")


def conclusion(session, rows, core_seconds):
    missed = [row for row in rows if row.met is False]
    print(f"\n{tables.markdown(rows)}\n\n{core_seconds:.0f} core-seconds of steps in all; "
          f"{sum(row.met is True for row in rows)} goals met, {len(missed)} missed"
          + (f"; failed: {', '.join(session.faults)}" if session.faults else "") + f"; see {session.out}")
    return 1 if session.faults or (session.arguments.short and missed) else 0


def main(argv):
    parser, arguments = arguments_of(argv)
    modules, broken = load_modules(arguments, parser)
    session = Session(arguments)
    for name, text in broken.items():
        session.fault(name, text)
    if arguments.list:
        list_problems(session, modules)
        return 1 if session.faults else 0
    session.copy_program()
    every = [(module, run) for module in modules for run in session.runs(module)]
    session.run_all([(m, r) for m, r in every if arguments.rerun or not session.kept(m, r)])
    rows, core_seconds = session.conclude(modules)
    if not session.faults:
        shutil.rmtree(session.out / "scratch")
    return conclusion(session, rows, core_seconds)


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        sys.exit("bench accuracy: interrupted; what was measured is kept, the same command goes on")
