#!/usr/bin/python3
"""Light bodies that do not come up: trapped.py PICTURE NAME=OUT_DIR...

Draws over time how many light bodies are further than LAYER below the lid, the mean over the runs of one NAME, and prints
of each run when the last one came up, and those that are still on their way at the end: how fast they are, and how far
from the nearest heavy body.
"""
import pathlib
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
from body_series import BodySeries  # noqa: E402

LAYER = 6e-3  # m: thicker than what lies at the lid in the end


def is_light(series):
    """Of each body, by the name of its kind."""
    light = np.array([name.startswith("light") for name in series.kinds])
    return light[series.array("kind")[0]]


def to_nearest(position, body, others, lengths):
    """Distance between centres; sideways the domain is periodic."""
    apart = position[others] - position[body]
    apart[:, :2] -= np.round(apart[:, :2] / lengths[:2]) * lengths[:2]
    return np.linalg.norm(apart, axis=1).min()


def below(series):
    """[time, body]: light, and not at the lid."""
    return (series.array("position")[:, :, 2] < series.domain[1][2] - LAYER) & is_light(series)


def said_of(series):
    count = below(series).sum(axis=1)
    lines = [f"{count[0]} light bodies below at the start, {count[-1]} after {series.time[-1]:.2g} s"]
    if count[-1] == 0:
        return lines + [f"the last one came up at {series.time[np.flatnonzero(count)[-1]]:.2g} s"]
    position, velocity = series.array("position")[-1], series.array("velocity")[-1]
    for body in np.flatnonzero(below(series)[-1]):
        distance = to_nearest(position, body, ~is_light(series), series.domain[1] - series.domain[0])
        lines.append(f"body {body} at {1e3 * position[body, 2]:.1f} mm: {1e3 * np.linalg.norm(velocity[body]):.2f} mm/s, "
                     f"a heavy one {1e3 * distance:.2f} mm away")
    return lines


def draw(picture, curves):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(6, 3.2))
    for name, runs in curves.items():
        axes.plot(runs[0].time, np.mean([below(s).sum(axis=1) for s in runs], axis=0), label=f"{name} ({len(runs)} runs)")
    axes.set_xlabel("time, s")
    axes.set_ylabel("light bodies not at the lid")
    axes.set_yscale("symlog", linthresh=1)
    axes.set_ylim(0)
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(picture, dpi=150, bbox_inches="tight")


def main(picture, *named):
    curves = {}
    for argument in named:  # a name may hold a "="
        name, folder = argument.rsplit("=", 1)
        series = BodySeries(pathlib.Path(folder) / "bodies.h5")
        print(f"{name} ({folder}): " + "; ".join(said_of(series)))
        curves.setdefault(name, []).append(series)
    draw(picture, curves)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
