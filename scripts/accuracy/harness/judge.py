"""Figures against goals."""
import dataclasses
import math
import traceback

from problem import Found
from harness import problems


@dataclasses.dataclass
class Row:
    """A Row is a figure: what was found (nan: not measured), and what it is held to."""
    problem: str
    figure: str
    found: float
    goal: object          # Goal; None: for information
    core_seconds: float   # of its runs; None: it does not say which

    @property
    def met(self):
        return None if self.goal is None else bool(self.goal.met(self.found))


@dataclasses.dataclass
class Judged:
    rows: list
    fault: str = None     # what figures() did wrong


def judge(module, entries, level):
    """Judges the figures by entries, {run.key: what is kept of it}, of the runs that are there."""
    goals = {goal.figure: goal for goal in problems.goals_of(module, level)}
    try:
        found = {name: as_found(value) for name, value in module.figures(measured_of(entries)).items()} if entries else {}
    except Exception:
        return Judged([], f"figures() failed:\n{traceback.format_exc(limit=-3)}")
    rows = [Row(module.__name__, name, f.value, goals.get(name), cost(f, entries)) for name, f in found.items()]
    if level == "full" or hasattr(module, "SHORT_GOALS"):
        rows += [Row(module.__name__, name, math.nan, goal, None) for name, goal in goals.items() if name not in found]
    return Judged(rows)


def measured_of(entries):
    extra = ("core_seconds", "steps", "mlups")
    return {key: {**entry["measured"], **{name: entry[name] for name in extra}} for key, entry in entries.items()}


def as_found(value):
    return value if isinstance(value, Found) else Found(float(value), ())


def cost(found, entries):
    used = [entries[key]["core_seconds"] for key in found.runs if key in entries]
    return sum(used) if used else None
