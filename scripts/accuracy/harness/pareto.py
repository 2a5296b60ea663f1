"""Plots of error against core-seconds, a picture a problem and `plot` of its curves."""
import math

from problem import Curve

COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#444444", "#8B4513"]
MARKERS = "osD^vP*X"


def curves_of(module, runs, entries, measured):
    if hasattr(module, "curves"):
        return module.curves(measured)
    return default_curves([run for run in runs if run.key in entries], entries)


def default_curves(runs, entries):
    """Returns |error| of the runs that measured one: a curve for all settings but D, points in the order of D."""
    found = {}
    for run in runs:
        entry = entries[run.key]
        if "error" in entry["measured"]:
            label = ", ".join(str(value) for name, value in run.settings.items() if name != "D")
            note = f"D = {run.settings['D']:g}" if "D" in run.settings else ""
            found.setdefault(label, []).append((run.settings.get("D", 0), (entry["core_seconds"], entry["measured"]["error"], note)))
    return [Curve(label, [point for _, point in sorted(points)]) for label, points in found.items()]


def slope(points):
    """Returns d log|error| / d log cost by least squares; None for less than two costs."""
    logs = [(math.log(cost), math.log(abs(error))) for cost, error, _ in points]
    n = len(logs)
    mx, my = (sum(column) / max(n, 1) for column in zip(*logs)) if n else (0, 0)
    spread = sum((x - mx) ** 2 for x, _ in logs)
    return sum((x - mx) * (y - my) for x, y in logs) / spread if n > 1 and spread > 0 else None


def drawable(curve):
    return [p for p in curve.points if p[0] > 0 and p[1] != 0 and math.isfinite(p[0]) and math.isfinite(p[1])]


def plot(path, title, curves):
    from matplotlib.figure import Figure  # half a second, which a run without a picture need not take

    figure = Figure(figsize=(7.5, 5))
    axes = figure.subplots()
    for n, curve in enumerate(curves):
        points = drawable(curve)
        steepness = slope(points)
        label = curve.label + (f" (slope {steepness:.2f})" if steepness is not None else "")
        colour = COLOURS[n % len(COLOURS)]
        axes.plot([p[0] for p in points], [abs(p[1]) for p in points], marker=MARKERS[n // len(COLOURS) % len(MARKERS)],
                  color=colour, lw=1.3, ms=5, label=label)
        for cost, error, note in points:
            axes.annotate(note, (cost, abs(error)), xytext=(4, 4), textcoords="offset points", fontsize=7, color=colour)
    axes.set(xscale="log", yscale="log", xlabel="core-seconds", ylabel="|error| [%]", title=title)
    axes.grid(True, which="both", alpha=0.2)
    axes.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1), frameon=False)
    figure.savefig(path, dpi=150, bbox_inches="tight")


def write_plots(folder, module, curves):
    """Returns the files written; none without points."""
    files = []
    for name in dict.fromkeys(curve.plot for curve in curves):
        shown = [curve for curve in curves if curve.plot == name and drawable(curve)]
        if shown:
            path = folder / f"{'.'.join(filter(None, (module.__name__, name)))}.png"
            plot(path, " ".join(filter(None, (module.__name__, name))), shown)
            files.append(path)
    return files
