"""The tables that a session leaves for programs and for people: JSON, CSV, Markdown."""
import csv
import json
import math
import os
import pathlib
import subprocess


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return "unknown"


def commit(root):
    described = subprocess.run(["git", "-C", root, "describe", "--always", "--dirty"], capture_output=True, text=True)
    return os.environ.get("SILT_COMMIT") or described.stdout.strip() or "unknown"


def write_json(path, root, rows):
    """Returns figures by key; null where one was asked for and not measured."""
    number = lambda x: x if x is not None and math.isfinite(x) else None  # noqa: E731
    table = [{"figure": row.figure, "found": number(row.found), "goal": str(row.goal) if row.goal else None, "met": row.met,
              "core_seconds": number(row.core_seconds)} for row in rows]
    figures = {row.figure: number(row.found) for row in rows}
    path.write_text(json.dumps({"machine": processor(), "commit": commit(root), "figures": figures, "table": table}, indent=1) + "\n")


def write_csv(path, runs):
    """Writes runs, (problem, Run, entry), with settings and measured numbers in columns of their own."""
    rows = [{"problem": problem, "run": run.key, **run.settings, **entry["measured"],
             **{name: entry[name] for name in ("steps", "core_seconds", "wall_seconds", "mlups")}}
            for problem, run, entry in runs]
    names = list(dict.fromkeys(name for row in rows for name in row))
    with open(path, "w", newline="") as stream:
        writer = csv.DictWriter(stream, names, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def markdown(rows):
    """Returns a table, aligned so that it reads well on a terminal too."""
    head = ["figure", "found", "goal", "met", "core-seconds"]
    cells = [head] + [[f"`{row.figure}`", shown(row.found), str(row.goal) if row.goal else "", verdict(row),
                       "" if row.core_seconds is None else f"{row.core_seconds:.3g}"] for row in rows]
    widths = [max(len(line[i]) for line in cells) for i in range(len(head))]
    lines = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(line, widths)) + " |" for line in cells]
    return "\n".join([lines[0], "|" + "|".join("-" * (width + 2) for width in widths) + "|", *lines[1:]])


def shown(found):
    return "not measured" if math.isnan(found) else f"{found:.4g}"


def verdict(row):
    return {None: "", True: "yes", False: "NO"}[row.met]
