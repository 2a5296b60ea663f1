"""The parts that the pages of scripts share: form, tables, and curves of what runs have written over time."""
import html
import io
import os
import re
import urllib.parse

import numpy as np

MECHANICS = {"energy": ("J", "cell masses cells2/step2"), "velocity": ("m/s", "cells/step"), "length": ("m", "cells"), "time": ("s", "steps")}
MOST_POINTS = 1000  # of a curve
STYLE = """
:root { --ink: #1d2733; --pale: #667; --line: #d8dde3; --good: #14746f; --bad: #b3261e; }
* { box-sizing: border-box } body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); margin: 0 auto; max-width: 64rem; padding: 1rem }
h1 { font-size: 1.5rem; line-height: 1.25; margin: .5rem 0 } h2 { font-size: 1.1rem; margin: 2rem 0 .5rem; border-bottom: 1px solid var(--line) }
p.lead { margin: 0; color: var(--pale) } .good { color: var(--good) } .bad { color: var(--bad) } .wide { overflow-x: auto }
table { border-collapse: collapse; font-size: .9rem } td, th { text-align: left; padding: .15rem 1.2rem .15rem 0; vertical-align: top }
th { font-weight: 600; border-bottom: 1px solid var(--line) } td.number { text-align: right; font-variant-numeric: tabular-nums }
pre { font-size: .8rem; line-height: 1.35; margin: 0 } img, svg { max-width: 100%; height: auto } figure { margin: 0 }
figcaption { font-size: .85rem; color: var(--pale) } .pictures { display: grid; gap: 1.5rem; grid-template-columns: repeat(auto-fit, minmax(min(100%, 22rem), 1fr)) }
video { max-width: 100% } ul.files { columns: 16rem; padding-left: 1.2rem; font-size: .9rem }
.bar { background: #0072b2; height: .8rem; display: inline-block; vertical-align: middle } .warning { border-left: 4px solid #e69f00; padding-left: .6rem; margin: .3rem 0 }
"""


def said(text):
    return html.escape(str(text).encode(errors="replace").decode())  # a name need not be UTF-8


def link(path):
    return urllib.parse.quote(os.fsencode(path))


def drawable(text):
    return "".join(c if c.isprintable() else " " for c in str(text))


def number(x):
    return "–" if x is None else f"{x:,}".replace(",", "\u2009") if isinstance(x, int) else f"{x:.4g}"


def count(n, what):
    return f"{number(n)} {what if n == 1 else {'body': 'bodies'}.get(what, what + 's')}"


def table(head, rows, numbers=()):
    cells = "".join(f"<th>{said(h)}</th>" for h in head)
    body = "".join("<tr>" + "".join(f"<td{' class=number' if i in numbers else ''}>{c}</td>" for i, c in enumerate(row)) + "</tr>" for row in rows)
    return f"<div class=wide><table><tr>{cells}</tr>{body}</table></div>"


def section(title, content):
    return f"<h2>{said(title)}</h2>\n{content}\n" if content else ""


def document(title, body, refresh=None):
    """Returns a page; with `refresh` it loads itself again each so many seconds."""
    return ("<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width, initial-scale=1'>"
            + (f"<meta http-equiv=refresh content={max(1, round(refresh))}>" if refresh else "")
            + f"<title>{said(title)}</title><style>{STYLE}</style><body><h1>{said(title)}</h1>{body}</body></html>\n")


def replace(path, text):
    """Writes a page so that nobody reads half of it."""
    part = path.with_name(path.name + ".part")
    part.write_text(text)
    part.rename(path)


def unit_of(report, what):
    """Returns the unit of a member of MECHANICS in the units of the case."""
    return MECHANICS[what][report["units"] != "si"]


def thinned(times, values):
    """Returns a curve of many points with fewer: of each stretch in time the least and the largest value."""
    stretch = -(-len(values) // (MOST_POINTS // 2))
    if stretch <= 2 or not np.isfinite(values).all():
        return times, values
    whole = len(values) // stretch * stretch
    rows, first = values[:whole].reshape(-1, stretch), stretch * np.arange(whole // stretch)
    kept = np.unique(np.concatenate([first + rows.argmin(axis=1), first + rows.argmax(axis=1), np.arange(whole, len(values))]))
    return times[kept], values[kept]


def drawn(title, unit, lines, along, marker=None):
    """Returns a figure of lines (label, x, y), as SVG; its letters can be read on a screen 390 pixels wide."""
    import matplotlib
    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    plt.rcParams["text.parse_math"] = False  # a name with dollars is no formula
    plt.rcParams["svg.fonttype"] = "none"  # letters, not outlines
    figure, axes = plt.subplots(figsize=(4.4, 2.8))
    if len(lines) > 10:  # as many as there are colours in turn
        axes.set_prop_cycle(color=plt.get_cmap("viridis")(np.linspace(0, 0.95, len(lines))))
    for label, x, y in lines:
        axes.plot(*thinned(x, y), label=drawable(label), marker=marker)
    axes.set_title(drawable(title), fontsize=11)
    axes.set_xlabel(along, fontsize=10)
    axes.set_ylabel(f"[{unit}]" if unit else "", fontsize=10)
    axes.tick_params(labelsize=10)
    axes.locator_params(axis="x", nbins=5)
    axes.grid(alpha=0.3)
    if len(lines) > 1:
        axes.legend(fontsize=10, loc="upper center", bbox_to_anchor=(0.5, -0.25), ncols=1 + all(len(str(line[0])) < 25 for line in lines), frameon=False)
    stream = io.StringIO()
    figure.savefig(stream, format="svg", bbox_inches="tight")
    plt.close(figure)
    return "<figure>" + stream.getvalue()[stream.getvalue().index("<svg"):] + "</figure>"


def side_by_side(figures):
    return f"<div class=pictures>{''.join(figures)}</div>" if figures else ""


def tables_of(run):
    """Returns the tables series_NAME.csv of a run by their names."""
    names = [path.stem.removeprefix("series_") for path in sorted(run.folder.glob("series_*.csv"))]
    return {name: run.table(name) for name in names if not re.search(r"\.\d+$", name)}  # without those that were set aside


def finer_in_tables(run, rows):
    """Returns the quantities that a series_NAME.csv has at so many times or more: their curves are drawn from there."""
    return {column for table in tables_of(run).values() if len(table) >= rows for column in table.names[2:]}


def of_series(run):
    """Yields (title, unit, lines (label, times, values)) of series.csv; of what a series_NAME.csv has no coarser only the mean."""
    try:
        series = run.series
    except FileNotFoundError:
        return
    if len(series) < 3:
        return
    report, types = run.report, run.report.get("quantity_types", {})
    wanted = [("Kinetic energy", unit_of(report, "energy"), ["energy.bodies", "energy.fluid"]),
              ("Largest velocity", unit_of(report, "velocity"), ["max_velocity"]), ("Contacts", "number", ["contacts_now"]),
              ("Drift of the fluid's mass", "share of it", ["mass_drift"])]
    finer = finer_in_tables(run, len(series))
    for name in (n.removeprefix("quantities.") for n in series.names if n.startswith("quantities.")):
        wanted.append((name, types.get(name, {}).get("unit") or "1", [f"quantities.{name}"] * (name not in finer) + [f"means.{name}"]))
    for title, unit, names in wanted:
        names = [n for n in names if n in series.columns and not np.isnan(series[n]).all()]
        labels = {"quantities": "in the step", "means": "mean so far", "energy": None}
        if names:
            yield title, unit, [(labels.get(n.partition(".")[0]) or n.rpartition(".")[2], series["time"], series[n]) for n in names]


def of_tables(run):
    """Yields the same of the columns of each series_NAME.csv that series.csv does not have at more times."""
    types = run.report.get("quantity_types", {})
    try:
        drawn_there = {name.removeprefix("quantities."): len(run.series) for name in run.series.names if name.startswith("quantities.")}
    except FileNotFoundError:
        drawn_there = {}
    for name, table in tables_of(run).items():
        for column in table.names[2:]:
            if 1 < len(table) >= drawn_there.get(column, 0) and not np.isnan(table[column]).all():
                yield f"{column} ({name})", types.get(column, {}).get("unit") or "1", [(column, table["time"], table[column])]


def of_kinds(run):
    """Yields the same of the mean speed of each kind of bodies."""
    try:
        bodies = run.bodies
    except (FileNotFoundError, OSError):
        return
    if len(bodies) < 3:
        return
    speed, when = np.linalg.norm(bodies.columns["velocity"], axis=1), np.repeat(np.arange(len(bodies)), bodies.count)
    lines = []
    for kind in np.unique(bodies.columns["kind"]):
        own = bodies.columns["kind"] == kind
        count, total = (np.bincount(when[own], weights, len(bodies)) for weights in (None, speed[own]))
        there = count > 0
        lines.append((bodies.kinds[kind], bodies.time[there], total[there] / count[there]))
    yield ("Mean speed of the bodies of each kind" if len(lines) > 1 else f"Mean speed of {lines[0][0]}"), unit_of(run.report, "velocity"), lines


def curves(runs):
    """Draws what runs, by their labels, have written over time; of several each curve has a figure with all of them in it."""
    figures = {}
    for label, run in runs.items():
        for of in (of_kinds, of_series, of_tables):
            for title, unit, lines in of(run):
                for name, times, values in lines:
                    whole = title if len(runs) == 1 or len(lines) == 1 else f"{title}: {name}"
                    figures.setdefault((whole, unit, unit_of(run.report, "time")), []).append((name if len(runs) == 1 else label, times, values))
    return side_by_side([drawn(title, unit, lines, f"time [{of_time}]") for (title, unit, of_time), lines in figures.items()])
