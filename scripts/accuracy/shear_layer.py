"""Double shear layers that roll up at Re = 30 000, far below what the lattice resolves: vorticity against a Fourier method.

Minion, Brown, J. Comput. Phys. 138 (1997) 734; the unit square, periodic, layers a 30th and an 80th of it thick, u = 0.05 cells a
step. `error` is the difference of the vorticity at time 1 over the reference, both root mean squares over 64 x 64 points; `peak` that of the largest
vorticity. reference/10_shear_layer_*.csv are by spectral_layer.py (512^2). Of the error 8 points stay with 256 cells and half of that goes at half the
speed: the start has no pressure, and the fluid is compressible. trt and bgk blow up later on; at time 1 their errors are 30 and 14 with 128 cells.
"""
import pathlib

import numpy as np

from case_text import case_text
from problem import Claim, Curve, Found, Goal, Run

REFERENCE = pathlib.Path(__file__).parent / "reference"
REYNOLDS, SPEED, POINTS = 30000, 0.05, 64
STEEPNESS, SIZES = (30, 80), (128, 192, 256)

GOALS = [Goal(f"accuracy.shear_layer.k30.n128.{name}", 5) for name in ("peak", "error")]
SHORT_GOALS = [Goal("accuracy.shear_layer.k30.n128.peak", 5), Goal("accuracy.shear_layer.k30.n128.error", 20)]
MINION = dict(source="Minion, Brown, J. Comput. Phys. 138 (1997) 734, computed anew by a Fourier method", kind="computation")
CLAIMS = {
    "accuracy.shear_layer.k{k}.n{N}.error": Claim(
        "vorticity, root mean square of the error", "shear layers a {k}th thick roll up, Re = 30 000", "N = {N}", **MINION,
        note="8 points stay with 256 cells, half of them of compressibility: the start has no pressure"),
    "accuracy.shear_layer.k{k}.n{N}.peak": Claim("largest vorticity", "shear layers a {k}th thick roll up, Re = 30 000", "N = {N}", **MINION)}


def run_of(steepness, N):
    steps = round(N / SPEED)
    text = case_text(
        f"Double shear layer, Re = {REYNOLDS}, {N} cells an edge", domain=dict(size=[N, N, 2], boundary="periodic"),
        fluid=dict(kinematic_viscosity=SPEED * N / REYNOLDS, collision="regularised",
                   initial=dict(type="shear-layer", velocity=[SPEED, 0, 0], steepness=steepness)),
        run=dict(steps=steps), output=dict(fields=dict(every=steps, quantities=["velocity"])))
    return Run(f"k{steepness}.n{N}", text, dict(steepness=steepness, N=N))


def runs(level):
    if level == "short":
        return [run_of(30, 128)]
    return [run_of(k, N) for k in STEEPNESS for N in SIZES]


def vorticity(velocity):
    """Returns dv/dx - du/dy of a field [y][x][component], over (speed / edge), at the POINTS^2 places of the reference."""
    N = len(velocity)
    waves = 2 * np.pi * np.fft.fftfreq(N, 1 / N)
    u, v = (np.fft.fft2(velocity[:, :, d] / SPEED) for d in (0, 1))
    shift = 0.5 / POINTS - 0.5 / N  # from the middle of the first cell to the first place
    place = np.exp(1j * shift * (waves[None, :] + waves[:, None]))
    w = np.fft.ifft2((1j * waves[None, :] * v - 1j * waves[:, None] * u) * place).real
    return w[::N // POINTS, ::N // POINTS]


def measure(run, outcome):
    N, k = run.settings["N"], run.settings["steepness"]
    reference = np.loadtxt(REFERENCE / f"10_shear_layer_{k}.csv", delimiter=",")
    found = vorticity(np.asarray(outcome.last_field("velocity"), float)[0])
    return {"error": 100 * np.linalg.norm(found - reference) / np.linalg.norm(reference),
            "peak": 100 * (abs(found).max() / abs(reference).max() - 1)}


def figures(measured):
    return {f"accuracy.shear_layer.{key}.{name}": Found(m[name], (key,)) for key, m in measured.items() for name in ("peak", "error")}


def curves(measured):
    return [Curve(f"thickness 1/{k}", [(m["core_seconds"], m["error"], f"{N}") for N in SIZES if (m := measured.get(f"k{k}.n{N}"))])
            for k in STEEPNESS]
