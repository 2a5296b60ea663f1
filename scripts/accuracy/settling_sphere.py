"""A sphere that settles through a large fluid at Galileo numbers 144 to 250: its velocities down and sideways.

Reference: M. Uhlmann, J. Dusek, Int. J. Multiphase Flow 59 (2014) 221-243, spectral elements: 1.2855 sqrt((rho - 1) g d),
Reynolds number 185, density ratio 1.5 (reference/03_single_sphere_drag.toml). The frame moves with the expected velocity:
fluid comes in below and leaves above, sideways the box is periodic, and the sphere is free. The box is short and narrow;
`width` tells what a narrower one does. With wider cells away from the sphere, on three lattices, trt does not last; the
figures of these runs are against cells of one width under the same collision.
WIDE is a box so large that a larger one changes 0.1 to 0.2 points.

REGIMES: at 144 the sphere falls straight, at 178.46 obliquely, at 190 it swings about an oblique path, at 250 it is chaotic. The same
source has the velocities in its large domain; horizontal ones are means of the magnitude. The boxes are 14 diameters wide, 6 below and
10 above the sphere, on three lattices, finest to 1.5 diameters from it: with 0.6 the wake reaches wider cells, and the path is too
oblique (at 178.46 with 15 cells 1.304 and 0.155; a box 16 diameters above the sphere, or 8 wide, changes that by less than 6 %). At
250 with 15 cells the path stays oblique and steady for 300 diameters (1.366 and 0.256), also with cells of one width (1.363 and 0.265). A
sphere that is to leave the vertical begins with a tenth of the velocity sideways; means are over the last third. The authors' own
immersed boundary method has 1.206 (15 cells) and 1.227 (36) at 144, 1.243 (15) and 1.307 (48) at 178.46, 1.323 (48) at 190, 1.395 (36)
at 250.
"""
import collections
import numpy as np
from case_text import case_text, sphere
from problem import Claim, Found, Goal, Run

DIAMETER = 20                                # cells; with 8 the relaxation time would be 0.51: unstable
RATIO, GALILEO, REFERENCE = 1.5, 144.0, 1.2855
WIDTH, NARROW = 7, 5                         # diameters
VELOCITY = 0.08                              # cells a step
TIMES = 30                                   # diameters the sphere settles
REGIMES = {144.0: (1.285, 0, 50), 178.46: (1.356, 0.1245, 100), 190.0: (1.376, 0.136, 100),
           250.0: (1.4604, None, 100)}       # velocity down, sideways over sqrt((rho - 1) g d); diameters it settles
REGIME_LIMITS = {15: 4, 24: 1, 36: 1}        # percent, by cells across
SIDEWAYS_LIMIT = 10
SHORT_TIMES = 15
DISTANCES = (0.5, 0.6, 0.7, 1)               # diameters from the sphere up to which cells are finest
# In diameters: the width, from the sphere to inlet and outlet, and the distance up to which cells are finest. A fall lasts `times` diameters.
Box = collections.namedtuple("Box", "width below above distance", defaults=(3, 7, None))
Fall = collections.namedtuple("Fall", "galileo reference times sideways", defaults=(GALILEO, REFERENCE, TIMES, 0))
WAKE = 1.5                                   # the same, where the wake leaves the vertical


def case_of(diameter, box, fall, collision):
    width, below, above, distance = box
    galileo, reference, times, sideways = fall
    scale = VELOCITY / reference  # sqrt((rho - 1) g d)
    every = int(0.5 * diameter / VELOCITY / 4) * 4
    inflow = [0, 0, VELOCITY]
    across, along = (4 * round(n * diameter / 4) if distance else n * diameter for n in (width, below + above))  # multiples of widest cells
    middle = across / 2 + 0.27
    return case_text(
        f"a sphere settling at Galileo number {galileo}, {diameter} cells across, box {across} cells wide",
        domain=dict(size=[across, across, along],
                    boundary=dict(x="periodic", y="periodic",
                                  z=[dict(type="velocity-inlet", velocity=inflow), "pressure-outlet"])),
        coarsening=dict(levels=2, distance=float(distance * diameter)) if distance else {},
        fluid=dict(kinematic_viscosity=scale * diameter / galileo, collision=collision, initial=dict(type="uniform", velocity=inflow)),
        gravity=dict(acceleration=[0, 0, -scale**2 / ((RATIO - 1) * diameter)]), shapes=[sphere(diameter)],
        bodies=[dict(shape="sphere", density=RATIO, position=[middle, middle, below * diameter],
                     **(dict(velocity=[sideways * VELOCITY, 0, 0]) if sideways else {}))],
        run=dict(steps=2 * times * every), output=dict(bodies=dict(every=every)))


def run_of(diameter, box, collision="trt", times=TIMES):
    levels = f".levels2.distance{box.distance:g}" if box.distance else ""
    return Run(f"d{diameter}.w{box.width}" + (f".{collision}" if collision != "trt" else "") + levels,
               case_of(diameter, box, Fall(times=times), collision), dict(D=diameter, width=box.width))


def regime_run(diameter, galileo):
    vertical, horizontal, times = REGIMES[galileo]
    fall = Fall(galileo, vertical, times, 0 if horizontal == 0 else 0.1)
    text = case_of(diameter, Box(2 * WIDTH, 6, 10, WAKE), fall, "regularised")
    return Run(f"ga{galileo:g}.d{diameter}", text, dict(D=diameter, galileo=galileo))


ONE_WIDTH = run_of(DIAMETER, Box(WIDTH), "regularised").key
LEVELLED = [run_of(DIAMETER, Box(WIDTH, distance=distance), "regularised") for distance in DISTANCES]
LEVELS = [run.key for run in LEVELLED]
WIDE = run_of(DIAMETER, Box(2 * WIDTH, 6, 10, DISTANCES[1]), "regularised", 50)
GOALS = [Goal("accuracy.settling_sphere.error", 3.0), Goal(f"accuracy.settling_sphere.{WIDE.key}.error", 1.0),
         Goal(f"accuracy.settling_sphere.{LEVELS[1]}.difference", 0.3),
         Goal(f"accuracy.settling_sphere.{LEVELS[1]}.speedup", 1e9, low=8)]
GOALS += [Goal(f"accuracy.settling_sphere.ga{galileo:g}.d{D}.vertical", limit) for galileo in REGIMES for D, limit in REGIME_LIMITS.items()]
GOALS += [Goal(f"accuracy.settling_sphere.ga{galileo:g}.d{D}.horizontal", SIDEWAYS_LIMIT) for galileo, (_, horizontal, _) in REGIMES.items()
          if horizontal for D in (24, 36)]
SHORT = run_of(15, Box(WIDTH, distance=DISTANCES[1]), "regularised", SHORT_TIMES)
SHORT_GOALS = [Goal(f"accuracy.settling_sphere.{SHORT.key}.error", 8)]
DUSEK = dict(source="Uhlmann, Dušek, Int. J. Multiphase Flow 59 (2014) 221, spectral elements", doi="10.1016/j.ijmultiphaseflow.2013.10.010",
             kind="computation")
GA144 = "sphere that settles at Galileo number 144, in a box {} wide"
CLAIMS = {
    "accuracy.settling_sphere.ga{galileo}.d{D}.vertical": Claim(
        "velocity over sqrt((ρ − 1) g d)", "sphere that settles at Galileo number {galileo}, in a box 14 diameters wide", "D = {D}, three lattices",
        **DUSEK, expected=lambda galileo, D: REGIMES[float(galileo)][0],
        note="the relaxation time is 0.51, the boundary layer a cell thick with D = 15; at 250 the path of the sphere stays oblique where it should be chaotic"),
    "accuracy.settling_sphere.ga{galileo}.d{D}.horizontal": Claim(
        "velocity sideways over sqrt((ρ − 1) g d)", "sphere that settles at Galileo number {galileo}, in a box 14 diameters wide",
        "D = {D}, three lattices", **DUSEK, expected=lambda galileo, D: REGIMES[float(galileo)][1],
        note="how oblique the path is depends on the walls and on the cells of the wake: 0.106 with D = 15, 0.155 with D = 24 at 178.46, 0.170 and 0.175 at 190"),
    "accuracy.settling_sphere.error": Claim("velocity over sqrt((ρ − 1) g d)", GA144.format("7 diameters"), f"D = {DIAMETER}", **DUSEK,
                                            expected=REFERENCE),
    "accuracy.settling_sphere.d{D}.w{w}.{collision}.{levels}.distance{distance}.error": Claim(
        "velocity over sqrt((ρ − 1) g d)", GA144.format("{w} diameters"), "D = {D}, three lattices", **DUSEK, expected=REFERENCE),
    "accuracy.settling_sphere.d{D}.w{w}.{collision}.{levels}.distance{distance}.difference": Claim(
        "velocity", GA144.format("{w} diameters"), "D = {D}, three lattices", "own run with cells of one width", kind="convergence"),
    "accuracy.settling_sphere.d{D}.w{w}.{collision}.{levels}.distance{distance}.speedup": Claim(
        "times as fast with wider cells", GA144.format("{w} diameters"), "D = {D}, three lattices", "own run with cells of one width",
        kind="convergence", unit="")}


def runs(level):
    if level == "short":
        return [SHORT]
    regimes = [regime_run(D, galileo) for D in REGIME_LIMITS for galileo in REGIMES]
    return [*regimes, run_of(DIAMETER, Box(WIDTH)), run_of(DIAMETER, Box(NARROW)), run_of(DIAMETER, Box(WIDTH), "regularised"), *LEVELLED, WIDE]


def measure(run, outcome):
    """Returns the mean over the last quarter; `change` from the quarter before it. Of a regime the means over the last third."""
    bodies = outcome.bodies
    if galileo := run.settings.get("galileo"):
        velocity = bodies.array("velocity")[:, 0] * (REGIMES[galileo][0] / VELOCITY)
        last = velocity[-(len(velocity) // 3):]
        return dict(vertical=REGIMES[galileo][0] - last[:, 2].mean(), horizontal=np.hypot(last[:, 0], last[:, 1]).mean(),
                    swing=last[:, 2].std(), height=bodies.array("position")[-1, 0, 2] / run.settings["D"])
    settling = VELOCITY - bodies.array("velocity")[:, 0, 2]
    quarter = len(settling) // 4
    last, before = settling[-quarter:].mean(), settling[-2 * quarter:-quarter].mean()
    return dict(error=100 * (last / VELOCITY - 1), change=100 * (last - before) / VELOCITY)


def figures(measured):
    found = {f"accuracy.settling_sphere.{key}.error": Found(m["error"], (key,)) for key, m in measured.items()
             if not key.startswith("ga")}
    for galileo, (vertical, horizontal, _) in REGIMES.items():
        for D in REGIME_LIMITS:
            if m := measured.get(key := f"ga{galileo:g}.d{D}"):
                found[f"accuracy.settling_sphere.{key}.vertical"] = Found(100 * (m["vertical"] / vertical - 1), (key,))
                name, value = ("horizontal", 100 * (m["horizontal"] / horizontal - 1)) if horizontal else ("sideways", m["horizontal"])
                found[f"accuracy.settling_sphere.{key}.{name}"] = Found(value, (key,))
    wide, narrow = (f"d{DIAMETER}.w{w}" for w in (WIDTH, NARROW))
    if wide in measured:
        found["accuracy.settling_sphere.error"] = Found(measured[wide]["error"], (wide,))
    if wide in measured and narrow in measured:
        found["accuracy.settling_sphere.narrower"] = Found(measured[narrow]["error"] - measured[wide]["error"], (wide, narrow))
    for key in LEVELS:
        if key in measured and ONE_WIDTH in measured:
            ratio = (100 + measured[key]["error"]) / (100 + measured[ONE_WIDTH]["error"])
            found[f"accuracy.settling_sphere.{key}.difference"] = Found(100 * (ratio - 1), (key, ONE_WIDTH))
            found[f"accuracy.settling_sphere.{key}.speedup"] = Found(measured[ONE_WIDTH]["core_seconds"] / measured[key]["core_seconds"], (key, ONE_WIDTH))
    return found
