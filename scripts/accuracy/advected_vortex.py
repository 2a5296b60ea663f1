"""A vortex carried by a stream: how much a collision model depends on the frame (its Galilean error).

Taylor's vortex, an exact solution (G. I. Taylor, Aeronaut. Res. Comm. R&M 598 (1918)), in a periodic square of N x N cells:
    u_theta = s (r/R) (R/R')^4 e^((1 - r^2/R'^2)/2),   R'^2 = R^2 + 2 nu t,
less the factor e^(1/2) at the start; s = 0.01 cells a step, R = N/16, Re = s R / nu = 100. A stream at 0.05 or 0.1 cells a step in each
direction carries it once through the box. The figure is the difference from the solution over it, both root mean squares; with the
stream 0 it stays where it is as long as under 0.1.
"""
import numpy as np

from case_text import case_text
from problem import Claim, Curve, Found, Goal, Run

SWIRL, REYNOLDS = 0.01, 100
SIZES, STREAMS = (64, 128), (0, 0.05, 0.1)
MODELS = ("trt", "bgk", "regularised")

GOALS = [Goal(f"accuracy.advected_vortex.regularised.n128.u{u}.error", limit) for u, limit in ((0, 0.5), (0.05, 4), (0.1, 4))]
SHORT_GOALS = [Goal("accuracy.advected_vortex.regularised.n64.u0.1.error", 15)]  # trt: 57
CLAIMS = {"accuracy.advected_vortex.{model}.n{N}.u{u}.error": Claim(
    "velocity, root mean square of the error over that of the vortex", "Taylor's vortex, Re = 100, in a stream of {u} cells a step",
    "R = N/16, N = {N}", "exact solution: Taylor, Aeronaut. Res. Comm. R&M 598 (1918)")}


def run_of(model, N, stream):
    steps = round(N / (stream or max(STREAMS)))
    radius = N / 16
    text = case_text(
        f"Taylor's vortex in a stream of {stream} cells a step", domain=dict(size=[N, N, 2], boundary="periodic"),
        fluid=dict(kinematic_viscosity=SWIRL * radius / REYNOLDS, collision=model, precision="double",
                   initial=dict(type="vortex", velocity=[stream, stream, 0], swirl=SWIRL, radius=radius)),
        run=dict(steps=steps), output=dict(fields=dict(every=steps, quantities=["velocity"])))
    return Run(f"{model}.n{N}.u{stream}", text, dict(model=model, N=N, stream=stream, steps=steps))


def runs(level):
    if level == "short":
        return [run_of("regularised", 64, 0.1)]
    return [run_of(model, N, u) for model in MODELS for N in SIZES for u in STREAMS]


def solution(N, steps):
    """Returns the two components of the velocity without the stream, [y][x][2]."""
    radius = N / 16
    square = radius**2 + 2 * SWIRL * radius / REYNOLDS * steps
    x, y = np.meshgrid(*[np.arange(N) + 0.5 - N / 2] * 2)
    turn = SWIRL / radius * (radius**2 / square)**2 * np.exp(0.5 - (x**2 + y**2) / (2 * square))
    return np.stack([-y * turn, x * turn], axis=-1)


def measure(run, outcome):
    N, stream = run.settings["N"], run.settings["stream"]
    exact = solution(N, run.settings["steps"])
    found = np.asarray(outcome.last_field("velocity"), float)[0, :, :, :2] - stream
    return {"error": 100 * np.linalg.norm(found - exact) / np.linalg.norm(exact)}


def figures(measured):
    return {f"accuracy.advected_vortex.{key}.error": Found(m["error"], (key,)) for key, m in measured.items()}


def curves(measured):
    return [Curve(f"{model}, {u}", [(m["core_seconds"], m["error"], f"{N}") for N in SIZES if (m := measured.get(f"{model}.n{N}.u{u}"))])
            for model in MODELS for u in STREAMS]
