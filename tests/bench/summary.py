#!/usr/bin/python3
"""summary.py FOLDER

FOLDER/NAME.json of each benchmark (scripts/bench all) as one Markdown page, FOLDER/README.md, and pictures of
the tables: million cells a second (FOLDER/NAME.png), and where a step spends its time, stage by stage
(FOLDER/NAME-stages.png)."""
import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

folder = pathlib.Path(sys.argv[1])
STAGES = ["stream collide", "LBM communication", "object mapping", "force evaluation", "integrate", "collision detection",
          "contact response", "body synchronisation"]
COLOURS = ["#0072B2", "#56B4E9", "#E69F00", "#D55E00", "#999999", "#009E73", "#CC79A7", "#444444"]  # Okabe, Ito


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


def save(figure, name):
    figure.savefig(folder / name, dpi=110)
    plt.close(figure)
    return name


def label(row):
    """Returns in words what a row is about."""
    words = {"cells_an_edge": "{}³", "ranks": "{} ranks", "spheres": "{} spheres"}
    return ", ".join(words.get(key, "{}").format(value) for key, value in row.items() if isinstance(value, str) or key in words)


def plot_rates(name, rows):
    rows = [row for row in rows if "mlups" in row]
    if not rows:
        return None
    figure, axes = plt.subplots(figsize=(9, 1 + 0.22 * len(rows)), layout="constrained")
    middle = [row["mlups"] for row in rows]
    spread = [[row["mlups"] - row.get("mlups_lowest", row["mlups"]) for row in rows],
              [row.get("mlups_highest", row["mlups"]) - row["mlups"] for row in rows]]
    axes.barh(range(len(rows)), middle, xerr=spread, color="#0072B2", error_kw={"elinewidth": 1})
    axes.set_yticks(range(len(rows)), [label(row) for row in rows], fontsize=7)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlabel("million cells a second")
    return save(figure, f"{name}.png")


def plot_stages(name, rows):
    """Draws the paper's Figure 7: a bar a scene, its parts the stages of a step, here in steps of the fluid alone."""
    rows = [row for row in rows if STAGES[0] in row]
    if not rows:
        return None
    figure, axes = plt.subplots(figsize=(10, 1.6 + 0.22 * len(rows)), layout="constrained")
    done = [0.0] * len(rows)
    for stage, colour in zip(STAGES, COLOURS):
        axes.barh(range(len(rows)), [row[stage] for row in rows], left=done, color=colour, label=stage)
        done = [d + row[stage] for d, row in zip(done, rows)]
    axes.axvline(1, color="black", linewidth=0.8, linestyle=":")
    axes.set_yticks(range(len(rows)), [row["scene"].removeprefix(name + ".") for row in rows], fontsize=7)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlabel("time of a step / time of a step of the fluid alone")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncols=4, fontsize=8)
    return save(figure, f"{name}-stages.png")


page = ["# Benchmarks", ""]
for file in sorted(folder.glob("*.json")):
    result = json.loads(file.read_text())
    page += [f"## {file.stem}", "", f"{result['machine']}, commit {result['commit']}", ""]
    page += ["| figure | value |", "|---|---|"]
    page += [f"| `{key}` | {cell(float(value))} |" for key, value in result["figures"].items()] + [""]
    for rows in runs_of(result["table"]):
        page += markdown(rows) + [""]
    for plot in plot_rates, plot_stages:
        if picture := plot(file.stem, result["table"]):
            page += [f"![{picture}]({picture})", ""]
(folder / "README.md").write_text("\n".join(page))
print(f"wrote {folder / 'README.md'}")
