"""A sphere that settles straight through a large fluid at Galileo number 144: its terminal velocity.

Reference: M. Uhlmann, J. Dusek, Int. J. Multiphase Flow 59 (2014) 221-243, spectral elements: 1.2855 sqrt((rho - 1) g d),
Reynolds number 185, density ratio 1.5 (reference/03_single_sphere_drag.toml). The frame moves with the expected velocity:
fluid comes in below and leaves above, sideways the box is periodic, and the sphere is free. The box is short and narrow;
`width` tells what a narrower one does. With wider cells away from the sphere, on three lattices, trt does not last; the
figures of these runs are against cells of one width under the same collision.
WIDE is a box so large that a larger one changes 0.1 to 0.2 points.
"""
from case_text import case_text, sphere
from problem import Claim, Found, Goal, Run

DIAMETER = 20                                # cells; with 8 the relaxation time would be 0.51: unstable
RATIO, GALILEO, REFERENCE = 1.5, 144.0, 1.2855
WIDTH, NARROW = 7, 5                         # diameters
BELOW, ABOVE = 3, 7                          # diameters from the sphere to inlet and outlet
VELOCITY = 0.08                              # cells a step
TIMES = 30                                   # diameters the sphere settles
DISTANCES = (0.5, 0.6, 0.7, 1)               # diameters from the sphere up to which cells are finest


def run_of(diameter, width, collision="trt", distance=None, below=BELOW, above=ABOVE, times=TIMES):
    scale = VELOCITY / REFERENCE  # sqrt((rho - 1) g d)
    every = int(0.5 * diameter / VELOCITY / 4) * 4
    levels = f".levels2.distance{distance:g}" if distance else ""
    inflow, middle = [0, 0, VELOCITY], width * diameter / 2 + 0.27
    text = case_text(
        f"a sphere settling at Galileo number {GALILEO}, {diameter} cells across, box {width * diameter} cells wide",
        domain=dict(size=[width * diameter, width * diameter, (below + above) * diameter],
                    boundary=dict(x="periodic", y="periodic",
                                  z=[dict(type="velocity-inlet", velocity=inflow), "pressure-outlet"])),
        coarsening=dict(levels=2, distance=float(distance * diameter)) if distance else {},
        fluid=dict(kinematic_viscosity=scale * diameter / GALILEO, collision=collision, initial=dict(type="uniform", velocity=inflow)),
        gravity=dict(acceleration=[0, 0, -scale**2 / ((RATIO - 1) * diameter)]), shapes=[sphere(diameter)],
        bodies=[dict(shape="sphere", density=RATIO, position=[middle, middle, below * diameter])],
        run=dict(steps=2 * times * every), output=dict(bodies=dict(every=every)))
    return Run(f"d{diameter}.w{width}" + (f".{collision}" if collision != "trt" else "") + levels, text, dict(D=diameter, width=width))


ONE_WIDTH = run_of(DIAMETER, WIDTH, "regularised").key
LEVELS = [run_of(DIAMETER, WIDTH, "regularised", distance).key for distance in DISTANCES]
WIDE = run_of(DIAMETER, 2 * WIDTH, "regularised", DISTANCES[1], below=6, above=10, times=50)
GOALS = [Goal("accuracy.settling_sphere.error", 3.0), Goal(f"accuracy.settling_sphere.{WIDE.key}.error", 1.0),
         Goal(f"accuracy.settling_sphere.{LEVELS[1]}.difference", 0.3),
         Goal(f"accuracy.settling_sphere.{LEVELS[1]}.speedup", 1e9, low=8)]
DUSEK = dict(source="Uhlmann, Dušek, Int. J. Multiphase Flow 59 (2014) 221, spectral elements", doi="10.1016/j.ijmultiphaseflow.2013.10.010",
             kind="computation")
GA144 = "sphere that settles at Galileo number 144, in a box {} wide"
CLAIMS = {
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
        return []
    return [run_of(DIAMETER, WIDTH), run_of(DIAMETER, NARROW), run_of(DIAMETER, WIDTH, "regularised"),
            *(run_of(DIAMETER, WIDTH, "regularised", distance) for distance in DISTANCES), WIDE]


def measure(run, outcome):
    """Returns the mean over the last quarter; `change` from the quarter before it."""
    bodies = outcome.bodies
    settling = VELOCITY - bodies.array("velocity")[:, 0, 2]
    quarter = len(settling) // 4
    last, before = settling[-quarter:].mean(), settling[-2 * quarter:-quarter].mean()
    return dict(error=100 * (last / VELOCITY - 1), change=100 * (last - before) / VELOCITY)


def figures(measured):
    found = {f"accuracy.settling_sphere.{key}.error": Found(m["error"], (key,)) for key, m in measured.items()}
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
