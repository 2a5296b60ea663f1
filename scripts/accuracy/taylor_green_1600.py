"""The Taylor-Green vortex at Re = 1600 with fewer cells than its smallest eddies need: the dissipation of energy over time.

As taylor_green, up to t = 20. Direct simulations (van Rees, Leonard, Pullin, Koumoutsakos, J. Comput. Phys. 230 (2011) 2794; 512^3)
have the largest -dE/dt, 0.0129 within 1 %, at t = 9.0. Figures: the largest found, in percent of it, its time less 9, and, as
whether a run lasts is what is asked first, the energy at t = 20 over that at the start.
"""
import math

from case_text import case_text, cube
from problem import Claim, Curve, Found, Goal, Run

REYNOLDS, SPEED, LAST = 1600, 0.05, 20
PEAK, PEAK_TIME = 0.0129, 9.0
SIZES, SPACING = (64, 96, 128), 0.5  # of the times the energy is looked at

GOALS = [Goal("accuracy.taylor_green_1600.n64.peak", 15)]
CLAIMS = {"accuracy.taylor_green_1600.n{N}.peak": Claim(
    "largest dissipation", "Taylor-Green vortex, Re = 1600, not resolved", "N = {N}",
    "van Rees, Leonard, Pullin, Koumoutsakos, J. Comput. Phys. 230 (2011) 2794", doi="10.1016/j.jcp.2010.11.031", kind="computation",
    uncertainty="1 %", expected=PEAK, note="64 cells are an eighth of what the smallest eddies need")}


def step_of(N, t):
    return round(t * N / (2 * math.pi) / SPEED)


def run_of(N):
    text = case_text(
        f"Taylor-Green vortex, Re = {REYNOLDS}, {N} cells a side", domain=cube(N),
        fluid=dict(kinematic_viscosity=SPEED * N / (2 * math.pi) / REYNOLDS, collision="regularised",
                   initial=dict(type="taylor-green-3d", velocity=[SPEED, 0, 0])),
        run=dict(steps=step_of(N, LAST)),
        quantities=[dict(name=f"energy_{i}", type="kinetic-energy", time=step_of(N, SPACING * i)) for i in range(round(LAST / SPACING) + 1)])
    return Run(f"n{N}", text, dict(N=N))


def runs(level):
    return [] if level == "short" else [run_of(N) for N in SIZES]


def measure(run, outcome):
    N = run.settings["N"]
    energy = [outcome.quantity(f"energy_{i}") / SPEED**2 for i in range(round(LAST / SPACING) + 1)]
    loss = [(a - b) / SPACING for a, b in zip(energy, energy[1:])]
    k = max(range(1, len(loss) - 1), key=lambda i: loss[i])
    before, here, after = loss[k - 1:k + 2]  # a parabola through the three largest
    bend, slope = before - 2 * here + after, (after - before) / 2
    return {"peak": 100 * ((here - slope**2 / (2 * bend)) / PEAK - 1), "late": SPACING * (k + 0.5 - slope / bend) - PEAK_TIME,
            "left": energy[-1] / energy[0]}


def figures(measured):
    return {f"accuracy.taylor_green_1600.{key}.{name}": Found(m[name], (key,)) for key, m in measured.items()
            for name in ("peak", "late", "left")}


def curves(measured):
    return [Curve("peak", [(m["core_seconds"], m["peak"], key[1:]) for key, m in sorted(measured.items(), key=lambda x: int(x[0][1:]))])]
