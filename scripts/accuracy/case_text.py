"""The text of a case from its tables, as the problems of this folder write them (keys: cases/README.md)."""
import json
import math

LATTICE = dict(system="lattice")


def si(cell_size, time_step):
    """The table [units] of a case in SI units."""
    return dict(system="si", cell_size=cell_size, time_step=time_step)


def cube(edge):
    """The table [domain] of a periodic cube."""
    return dict(size=[edge] * 3, boundary="periodic")


def sphere(diameter, name="sphere"):
    """An entry of [[shapes]]."""
    return dict(name=name, type="sphere", diameter=diameter)


def value(x):
    """A value in TOML: number, string, boolean, list or table."""
    if isinstance(x, dict):
        return "{ " + ", ".join(f"{key} = {value(y)}" for key, y in x.items()) + " }"
    if isinstance(x, (bool, str)):
        return json.dumps(x, ensure_ascii=False)
    if isinstance(x, int):
        return str(x)
    if hasattr(x, "__iter__"):
        return "[" + ", ".join(value(y) for y in x) + "]"
    if not math.isfinite(x):
        raise ValueError(f"{x} in a case")
    return repr(float(x))


def case_text(title, units=LATTICE, **tables):
    """case.toml. tables: a dict makes a table [name], a list of dicts entries [[name]]; empty ones are left out."""
    parts = [f"title = {value(title)}"]
    for name, table in dict(units=units, **tables).items():
        head, entries = (f"[[{name}]]", table) if isinstance(table, list) else (f"[{name}]", [table] if table else [])
        for entry in entries:
            parts += [head, *(f"{key} = {value(x)}" for key, x in entry.items())]
    return "\n".join(parts) + "\n"
