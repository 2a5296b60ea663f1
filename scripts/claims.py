"""Claims of the reference problems (scripts/accuracy) and of the cases (reference.toml) as rows of one table: scripts/ledger."""
import csv
import dataclasses
import io
import math
import pathlib
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent
ACCURACY = ROOT / "scripts/accuracy"
sys.path[:0] = [str(ACCURACY), str(ACCURACY.parent)]

from harness import problems  # noqa: E402
from harness.judge import judge  # noqa: E402
from harness.results import fingerprint  # noqa: E402
from problem import Claim  # noqa: E402
from reference import compared, references, target  # noqa: E402


@dataclasses.dataclass
class Row:
    """A Row is a claim and what was measured of it. Texts, but for the figure and the core-seconds, None where not measured."""
    claim: str          # a name of its own: the figure's, or case.quantity
    problem: str
    form: str           # short or full
    regime: str
    quantity: str
    kind: str
    source: str
    doi: str
    expected: str
    uncertainty: str
    measured: str = ""
    error: str = ""
    tolerance: str = ""
    verdict: str = "not measured"
    resolution: str = ""
    core_seconds: float = None
    commit: str = ""
    note: str = ""
    figure: float = None  # of the problem, or the quantity of the case: what the other columns are made of
    margin: float = None  # error over tolerance: 1 is just within

    def judge(self, measured, error, good, margin):
        self.measured, self.error, self.verdict, self.margin = measured, error, "within" if good else "missed", margin


COLUMNS = [field.name for field in dataclasses.fields(Row) if field.name != "margin"]


@dataclasses.dataclass
class Measured:
    figure: float
    expected: float = None  # of a case whose reference is a quantity of the same run
    core_seconds: float = None
    commit: str = ""


def problem_row(module, goal, form, measured):
    """Returns the row of a goal."""
    claim = problems.claim_of(module, goal.figure) or Claim(goal.figure, "", "", problems.summary(module))
    row = Row(goal.figure, module.__name__, form, claim.regime, claim.quantity, claim.kind, claim.source, claim.doi, "0", claim.uncertainty,
              resolution=claim.resolution, note=claim.note)
    unit = f" {claim.unit}".rstrip()
    if goal.low is None:
        row.tolerance = f"{goal.limit:g}{unit}"
    if claim.expected is not None:
        row.expected = f"{claim.expected:.5g}"
    elif goal.low is not None:
        row.expected = between(goal.low, goal.limit)
    if measured is None:
        return row
    row.figure, row.core_seconds, row.commit = measured.figure, measured.core_seconds, measured.commit
    x, good = measured.figure, goal.met(measured.figure)
    if goal.low is not None:
        row.judge(f"{x:.4g}{unit}", "inside" if good else "outside", good, margin_between(x, goal.low, goal.limit))
    else:
        value = f"{x:.3g}{unit}" if claim.expected is None else f"{claim.expected * (1 + x / 100):.5g}"
        row.judge(value, f"{x:+.3g}{unit}", good, abs(x) / goal.limit)
    return row


def no_limit(low, high):
    return 0 < 4 * low < high


def between(low, high):
    return f"at least {low:g}" if no_limit(low, high) else f"{low:.4g} to {high:.4g}" if low < high else f"{low:g}"


def margin_between(x, low, high):
    if no_limit(low, high):
        return low / x if x > 0 else math.inf
    return abs(x - (low + high) / 2) / ((high - low) / 2) if low < high else float(x != low)


def case_row(case, quantity, form, measured):
    """Returns the row of a quantity of a case."""
    name, short = quantity["name"], ".short" * (form == "short")
    regime, resolution = described(case)
    found = {name: measured.figure} if measured else {}
    if isinstance(quantity.get("value"), str) and measured:
        found[quantity["value"]] = measured.expected
    (seen, expected, tolerance, deviation), good = compared(quantity, found)
    row = Row(f"{case.name}{short}.{name}", f"cases/{case.name}", form, regime, name, quantity["kind"], quantity["source"], quantity.get("doi", ""),
              expected.removesuffix(" is missing"), quantity.get("uncertainty", ""), tolerance=tolerance.replace("-", "", tolerance == "-"),
              resolution=resolution, note=quantity.get("note", ""))
    if measured is None:
        return row
    row.figure, row.core_seconds, row.commit = measured.figure, measured.core_seconds, measured.commit
    if "between" in quantity:
        low, high = quantity["between"]
        margin = margin_between(measured.figure, low, high) if low else measured.figure / high  # from 0: an error
    else:
        value, allowed = target(quantity, found)
        off = abs(measured.figure - value)
        margin = off / allowed if allowed else math.inf if off else 0.0
    row.judge(seen, deviation, good, margin)
    return row


def described(case):
    """Returns what a case says it is, and how finely it is run: from its case.toml."""
    text = tomllib.loads((case / "case.toml").read_text())
    cell = text["units"].get("cell_size", 1) if text["units"]["system"] == "si" else 1
    if "fluid" not in text:
        return text["title"], f"step {text['units'].get('time_step', 1):g} s"
    for shape in text.get("shapes", []):
        if across := shape.get("diameter", 2 * shape.get("radius", 0)):
            return text["title"], f"D = {across / cell:.3g}"
    return text["title"], " x ".join(f"{round(edge / cell)}" for edge in text["domain"]["size"]) + " cells"


def all_cases():
    return sorted(case.parent for case in (ROOT / "cases").glob("*/case.toml"))


def claims(modules, cases, level, measured):
    """Returns the rows of a level, "short" or "full"; the full one has those of the short form that are not in it too. measured: by claim."""
    rows = []
    for module in modules:
        short = getattr(module, "SHORT_GOALS", [] if level == "full" else [goal for goal in module.GOALS if goal.figure in measured])
        listed = {goal.figure: (goal, form) for goals, form in ((short, "short"), (module.GOALS if level == "full" else [], "full")) for goal in goals}
        rows += [problem_row(module, goal, form, measured.get(goal.figure)) for goal, form in listed.values()]
    for case in cases:
        full, (short, settings) = references(case)[0], references(case, short=True)
        form = "short" if settings else "full"
        listed = [(quantity, form) for quantity in short] if level == "short" else [(quantity, "full") for quantity in full] + [
            (quantity, "short") for quantity in short if settings]
        for quantity, form in listed:
            if quantity["kind"] != "pinned":  # an earlier result of this program is no claim
                name = f"{case.name}{'.short' * (form == 'short')}.{quantity['name']}"
                rows.append(case_row(case, quantity, form, measured.get(name)))
    return rows


def of_problem(module, level, results, program):
    """Returns what was measured, by claim, of the runs of a level that are kept; and how many are not."""
    runs = problems.runs_of(module, level)
    entries = {run.key: entry for run in runs if (entry := results.get(fingerprint(module, run, program)))}
    commit = next((entry["commit"] for entry in entries.values()), "")
    rows = judge(module, entries, level).rows
    return {row.figure: Measured(row.found, None, row.core_seconds, commit) for row in rows
            if row.goal and math.isfinite(row.found)}, len(runs) - len(entries)


def of_case(case, level, listed):
    """Returns what was measured, by claim, from the rows of scripts/regress --json."""
    quantities, settings = references(case, level == "short")
    short = ".short" * bool(settings)
    found = {}
    for quantity, row in zip(quantities, listed):
        if row.get("number") is not None and quantity["kind"] != "pinned":
            reference = float(row["reference"]) if isinstance(quantity.get("value"), str) else None
            found[f"{case.name}{short}.{quantity['name']}"] = Measured(row["number"], reference, row["core_seconds"], row["commit"])
    return found


def read(path):
    """Returns what a table says was measured, by claim."""
    if not path.exists():
        return {}
    with open(path, newline="") as stream:
        return {row["claim"]: Measured(float(row["figure"]), number(row["expected"]), number(row["core_seconds"]), row["commit"])
                for row in csv.DictReader(stream) if row["figure"]}


def number(text):
    try:
        return float(text)
    except ValueError:
        return None


def text_of(rows):
    """Returns the table as CSV."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows([shown(row, name) for name in COLUMNS] for row in rows)
    return stream.getvalue()


def shown(row, name):
    value = getattr(row, name)
    if value is None:
        return ""
    return f"{value:.3g}" if name == "core_seconds" else f"{value:.12g}" if name == "figure" else value
