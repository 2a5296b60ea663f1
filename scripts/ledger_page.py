"""The page of scripts/ledger: counts, misses, plots and a table for each problem; nothing outside of it is loaded."""
import math

from page import document, number, said, section, table

KINDS = {"theory": "#0072b2", "experiment": "#d55e00", "computation": "#009e73", "convergence": "#cc79a7"}
STYLE = """<style>
h3 { font-size: 1rem; margin: 1.2rem 0 .2rem } .words { min-width: 10rem } svg { display: block; width: 100%; max-width: 44rem }
svg text { font: 10px system-ui, sans-serif; fill: #1d2733 } .missed { color: var(--bad); font-weight: 600 } .open { color: var(--pale) } p.warning, p.names { overflow-wrap: anywhere; font-size: .9rem }
@media (max-width: 30rem) { td, th { padding-right: .4rem } }
</style>"""
WIDTH, LEFT, LINE = 360, 140, 13  # of a plot, as wide as a narrow screen; of its labels; of a row of them


def page(rows, form):
    """Returns the page of a table's rows."""
    by_problem = {}
    for row in rows:
        by_problem.setdefault(row.problem, []).append(row)
    missed, open_ones = ([row for row in rows if row.verdict == verdict] for verdict in ("missed", "not measured"))
    return document("Ledger of claims", STYLE + lead(rows, form)
                    + section("Missed", "".join(map(miss, missed)))
                    + section("Error over tolerance", strip(by_problem)) + section("Error against cost", scatter(rows))
                    + section("Not measured yet", f"<p class=names>{said(', '.join(row.claim for row in open_ones))}.</p>" if open_ones else "")
                    + section("All claims", "".join(of_problem(name, listed) for name, listed in by_problem.items())))


def lead(rows, form):
    """Returns the counts, of each kind of source."""
    cells = []
    for kind in (*KINDS, None):
        measured = [row for row in rows if kind in (row.kind, None) and row.verdict != "not measured"]
        within = sum(row.verdict == "within" for row in measured)
        share = f"{100 * within / len(measured):.0f} %" if measured else "–"
        cells.append([kind or "all", number(sum(kind in (row.kind, None) for row in rows)), number(len(measured)), number(within), share])
    return (f"<p>What the reference problems and the cases of Silt claim ({said(form)}), against what it is known from. A claim is within its "
            "tolerance or missed; a miss stays here with its explanation. Tolerances are goals of the project, errors those of single runs or "
            "means over places on the lattice, as the quantity says; core-seconds are of the steps, on a busy machine. Computation: by others, or by "
            "another method; convergence: our own finest run.</p>"
            + table(["kind", "claims", "measured", "within", "share"], cells, numbers=(1, 2, 3, 4)))


def miss(row):
    expected, measured, error, tolerance = told(row)
    return (f"<p class=warning><b>{said(row.claim)}</b>: {said(row.quantity)}; {said(row.regime)}, {said(row.resolution)}. Expected {expected}, "
            f"measured {measured}; error {error}{tolerance and f', tolerance {tolerance}'}. {said(row.note[:1].upper() + row.note[1:])}</p>")


def told(row):
    expected = said(row.expected) + (f" ± {said(row.uncertainty)}" if row.uncertainty and row.expected != "0" else "")
    return [expected, said(row.measured), said(row.error), said(row.tolerance)]


def text(words):
    return f"<div class=words>{said(words)}</div>"


def source(row):
    link = f" <a href='https://doi.org/{said(row.doi)}'>doi:{said(row.doi)}</a>" if row.doi else ""
    return f"<div class=words>{said(row.source)}{link}</div>"


def of_problem(name, rows):
    """Returns the table of a problem or case."""
    verdicts = {"within": "<span class=good>within</span>", "missed": "<span class=missed>missed</span>",
                "not measured": "<span class=open>not measured</span>"}
    head = ["quantity", "", "expected", "measured", "error", "tolerance", "regime", "resolution", "core-s", "program", "source"]
    return f"<h3 id='{said(name)}'>{said(name)}</h3>" + table(head, [
        [text(row.quantity), verdicts[row.verdict], *told(row), text(row.regime), said(row.resolution),
         number(row.core_seconds) if row.core_seconds is not None else "", said(row.commit), source(row)] for row in rows])


def mark(x, y, row):
    return f"<circle cx='{x:.1f}' cy='{y:.1f}' r='3' fill='{KINDS[row.kind]}' fill-opacity='.65'><title>{said(row.claim)}: {said(row.error)}</title></circle>"


def legend(y):
    places = {kind: 6 + 90 * i for i, kind in enumerate(KINDS)}
    return "".join(f"<circle cx='{x}' cy='{y - 3}' r='3' fill='{KINDS[kind]}'/><text x='{x + 7}' y='{y}'>{kind}</text>" for kind, x in places.items())


def svg(height, parts, what):
    return f"<svg viewBox='0 0 {WIDTH} {height}' role='img' aria-label='{said(what)}'>{''.join(parts)}</svg>"


def strip(by_problem):
    """Draws error over tolerance of all that was measured, a line a problem; what is beyond twice the tolerance is at the end."""
    lines = {name: found for name, rows in by_problem.items() if (found := [row for row in rows if row.margin is not None])}
    if not lines:
        return ""
    scale, bottom = (WIDTH - LEFT - 12) / 2, 34 + LINE * len(lines)
    parts = [legend(10)]
    for tick in (0, 0.5, 1, 1.5, 2):
        x = LEFT + scale * tick
        parts += [f"<line x1='{x}' x2='{x}' y1='32' y2='{bottom}' stroke='{'#b3261e' if tick == 1 else '#d8dde3'}'/>",
                  f"<text x='{x}' y='27' text-anchor='middle'>{tick:g}{'+' if tick == 2 else ''}</text>"]
    for i, (name, rows) in enumerate(lines.items()):
        y = 40 + LINE * i
        parts.append(f"<text x='{LEFT - 8}' y='{y + 3}' text-anchor='end'>{said(name.removeprefix('cases/')[:26])}</text>")
        parts += [mark(LEFT + scale * min(row.margin, 2), y, row) for row in rows]
    return svg(bottom + 6, parts, "error over tolerance by problem")


def scatter(rows):
    """Draws the errors that are in percent against the core-seconds of their runs, both in powers of ten."""
    found = [(row.core_seconds, abs(float(row.error.rstrip(" %"))), row) for row in rows if row.core_seconds and row.error.endswith("%")]
    found = [(math.log10(cost), math.log10(max(error, 1e-3)), row) for cost, error, row in found]
    if not found:
        return ""
    left, top, right, bottom, low, high = 48, 20, WIDTH - 18, 240, -3, 2
    first, last = (end(f(cost for cost, _, _ in found)) for end, f in ((math.floor, min), (math.ceil, max)))
    last = max(last, first + 1)

    def place(cost, error):
        return left + (right - left) * (cost - first) / (last - first), bottom - (bottom - top) * (min(error, high) - low) / (high - low)
    parts = [legend(10)]
    for power in range(low, high + 1):
        y = place(first, power)[1]
        parts += [f"<line x1='{left}' x2='{right}' y1='{y}' y2='{y}' stroke='#d8dde3'/>", f"<text x='{left - 4}' y='{y + 3}' text-anchor='end'>{10.0**power:g} %</text>"]
    for power in range(first, last + 1):
        x = place(power, low)[0]
        parts += [f"<line x1='{x:.1f}' x2='{x:.1f}' y1='{top}' y2='{bottom}' stroke='#d8dde3'/>", f"<text x='{x:.1f}' y='{bottom + 13}' text-anchor='middle'>{10.0**power:g}</text>"]
    parts.append(f"<text x='{(left + right) / 2}' y='{bottom + 27}' text-anchor='middle'>core-seconds of all runs of a figure</text>")
    return svg(bottom + 32, parts + [mark(*place(cost, error), row) for cost, error, row in found], "error in percent against core-seconds")
