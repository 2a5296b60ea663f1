#!/usr/bin/python3
"""summary.py FOLDER

FOLDER/NAME.json of each benchmark (scripts/bench all) as one Markdown page, FOLDER/README.md, and bar charts of the tables'
rates, FOLDER/NAME.png."""
import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

folder = pathlib.Path(sys.argv[1])


def cell(value):
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def markdown(rows):
    columns = list(dict.fromkeys(key for row in rows for key in row))
    lines = ["| " + " | ".join(c.replace("_", " ") for c in columns) + " |", "|" + "---|" * len(columns)]
    return lines + ["| " + " | ".join(cell(row.get(c, "")) for c in columns) + " |" for row in rows]


def runs_of(rows):
    """Rows of the same columns, one after the other."""
    runs = []
    for row in rows:
        if not runs or list(runs[-1][0]) != list(row):
            runs.append([])
        runs[-1].append(row)
    return runs


def plot(name, rows):
    rows = [row for row in rows if "mlups" in row]
    if not rows:
        return None
    label = lambda row: ", ".join(str(v) for v in row.values() if not isinstance(v, float))
    figure, axes = plt.subplots(figsize=(9, 1 + 0.22 * len(rows)), layout="constrained")
    middle = [row["mlups"] for row in rows]
    spread = [[row["mlups"] - row.get("mlups_lowest", row["mlups"]) for row in rows],
              [row.get("mlups_highest", row["mlups"]) - row["mlups"] for row in rows]]
    axes.barh(range(len(rows)), middle, xerr=spread, color="#0072B2", error_kw={"elinewidth": 1})
    axes.set_yticks(range(len(rows)), [label(row) for row in rows], fontsize=7)
    axes.invert_yaxis()
    axes.set_xlabel("million cells a second")
    picture = folder / f"{name}.png"
    figure.savefig(picture, dpi=110)
    plt.close(figure)
    return picture.name


page = ["# Benchmarks", ""]
for file in sorted(folder.glob("*.json")):
    result = json.loads(file.read_text())
    page += [f"## {file.stem}", "", f"{result['machine']}, commit {result['commit']}", ""]
    page += ["| figure | value |", "|---|---|"]
    page += [f"| `{key}` | {cell(float(value))} |" for key, value in result["figures"].items()] + [""]
    for rows in runs_of(result["table"]):
        page += markdown(rows) + [""]
    if picture := plot(file.stem, result["table"]):
        page += [f"![{file.stem}]({picture})", ""]
(folder / "README.md").write_text("\n".join(page))
print(f"wrote {folder / 'README.md'}")
