"""Finds the reference problems of a folder."""
import dataclasses
import importlib.util
import re
import sys
import traceback

FIELD = r"(?P<\1>\\d+(?:\\.\\d+)?|[^.\\d][^.]*)"  # a number, or a word without a point
HAS_GOALS = re.compile(r"^GOALS\b", re.MULTILINE)


def names(folder):
    """Returns the modules that are problems: those that say GOALS."""
    return sorted(path.stem for path in folder.glob("*.py") if HAS_GOALS.search(path.read_text()))


def load(folder, name):
    """Returns (module, None), or (None, what is wrong with it)."""
    try:
        spec = importlib.util.spec_from_file_location(name, folder / f"{name}.py")
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
    except Exception:  # whatever its author did: the others go on
        return None, traceback.format_exc(limit=-2)
    lacking = [f for f in ("runs", "measure", "figures") if not callable(getattr(module, f, None))]
    return (None, f"{name}.py has no function {lacking[0]}") if lacking else (module, None)


def runs_of(module, level):
    """Returns its runs; raises ValueError where two have one key."""
    runs = module.runs(level)
    keys = [run.key for run in runs]
    for key in keys:
        if keys.count(key) > 1:
            raise ValueError(f"{module.__name__}: two runs have the key {key!r}")
    return runs


def goals_of(module, level):
    return getattr(module, "SHORT_GOALS", module.GOALS) if level == "short" else module.GOALS


def claim_of(module, figure):
    """Returns the first of the module's claims whose form a figure's name has, its texts with the fields filled in; None without one."""
    for form, claim in getattr(module, "CLAIMS", {}).items():
        if found := re.fullmatch(re.sub(r"\\\{(\w+)\\\}", FIELD, re.escape(form)), figure):
            fields = found.groupdict()
            filled = {name: text.format(**fields) for name, text in vars(claim).items() if isinstance(text, str)}
            if callable(claim.expected):
                filled["expected"] = claim.expected(**fields)
            return dataclasses.replace(claim, **filled)
    return None


def summary(module):
    """Returns the first line of its docstring."""
    return (module.__doc__ or "").strip().split("\n")[0]
