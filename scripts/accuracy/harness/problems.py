"""Finds the reference problems of a folder."""
import importlib.util
import re
import sys
import traceback

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


def summary(module):
    """Returns the first line of its docstring."""
    return (module.__doc__ or "").strip().split("\n")[0]
