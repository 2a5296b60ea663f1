"""Stokes drag of simple cubic arrays of spheres, against theory: mean and spread over random positions on the lattice.

Every position of eight counts alike; the spread is the largest error less the smallest, in points. `paper` is the
method of SC10: bgk, bounce-back, double precision, at the relaxation time at which its walls are half way (0.933). The drag of
trt does not depend on the relaxation time: 3 is where a run is shortest. That of regularised does where it lowers Lambda.
"""
import itertools
import math

import periodic_array as array
from problem import Claim, Curve, Found, Goal, Run

FRACTIONS = (0.008, 0.064, 0.125, 0.216, 0.343, 0.45)
SIZES = (6, 8, 12)              # cells across, nearly: the cube is a whole number of cells
FINER = (16, 24)                # for the order of convergence, at ORDER_FRACTION
ORDER_FRACTION = 0.064
POSITIONS = array.offsets(8)
WALLS, COLLISIONS, PRECISIONS = ("bounce-back", "cli", "parabolic", "multireflection"), ("bgk", "trt"), ("single", "double")
DEFAULT, DOUBLE = ("multireflection", "trt", "single"), ("multireflection", "trt", "double")
CLI, PARABOLIC = ("cli", "trt", "single"), ("parabolic", "trt", "single")
THIN = ("multireflection", "regularised", "single")
PAPER = ("bounce-back", "bgk", "double")
RELAXATION_TIME = {"trt": 3.0, "bgk": 0.933, "regularised": 0.55}

GOALS = [
    *(Goal(f"accuracy.array.{f:g}.d{D}.mean_error", limit) for f in FRACTIONS if f <= 0.216
      for D, limit in ((6, 1.5), (8, 0.7), (12, 0.4))),
    *(Goal(f"accuracy.array.{f:g}.d12.mean_error", 1.5) for f in FRACTIONS if f > 0.216),
    *(Goal(f"accuracy.array.{f:g}.d8.spread", 1.5) for f in FRACTIONS),
    Goal("accuracy.array.0.216.d8.multireflection.regularised.single.mean_error", 4.5),  # with walls under cli 13
    Goal("accuracy.array.0.064.order", 9, low=1.9),
    Goal("accuracy.array.single_share", 10),  # of the discretisation error
]
SHORT_GOALS = [goal for goal in GOALS if goal.figure in ("accuracy.array.0.064.d6.mean_error", "accuracy.array.0.064.d8.mean_error",
                                                         "accuracy.array.0.216.d8.multireflection.regularised.single.mean_error")]
THEORY = dict(source="Zick, Homsy, J. Fluid Mech. 115 (1982) 13; series of Sangani, Acrivos (1982)", doi="10.1017/S0022112082000627",
              uncertainty="2e-4")
CLAIMS = {
    "accuracy.array.{phi}.d{D}.mean_error": Claim(
        "drag K, mean of eight places", "simple cubic array, Stokes flow, φ = {phi}", "D = {D}", **THEORY,
        expected=lambda phi, D: array.exact_drag(float(phi)),
        note="6 cells are few at φ = 0.216, whose gaps are 2 cells wide then; at φ of 0.343 and 0.45 gaps are a cell and less"),
    "accuracy.array.{phi}.d{D}.spread": Claim(
        "drag K, largest less smallest error of eight places", "simple cubic array, Stokes flow, φ = {phi}", "D = {D}", **THEORY,
        note="gaps of a cell and less at φ of 0.343 and 0.45: the error depends on the place"),
    "accuracy.array.{phi}.d{D}.{walls}.{collision}.{precision}.mean_error": Claim(
        "drag K under {collision}, mean of eight places", "simple cubic array, Stokes flow, φ = {phi}, τ = 0.55", "D = {D}", **THEORY,
        expected=lambda phi, **_: array.exact_drag(float(phi))),
    "accuracy.array.{phi}.order": Claim(
        "order of convergence of the drag", "simple cubic array, Stokes flow, φ = {phi}", "D = 8 to 24", "second order: analysis of the scheme",
        unit="", note="the surface of walls that keep mass seems a hundredth of a cell further out: an error of first order"),
    "accuracy.array.single_share": Claim(
        "difference of single from double precision, over the error", "simple cubic arrays, Stokes flow", "all", "own runs in double precision",
        kind="convergence")}


def methods(fraction, D):
    """Returns (walls, collision, precision) that are measured there."""
    if D in FINER:
        return (DEFAULT, DOUBLE) if fraction == ORDER_FRACTION else ()
    return (tuple(itertools.product(WALLS, COLLISIONS, PRECISIONS)) if fraction == ORDER_FRACTION
            else (DEFAULT, DOUBLE, CLI, PARABOLIC, PAPER, THIN))


def key_of(fraction, D, method, position):
    return ".".join((f"{fraction:g}", f"d{D}", *method, str(position)))


def run_of(fraction, D, method, position):
    walls, collision, precision = method
    text = array.fixed_case(fraction, D, POSITIONS[position], RELAXATION_TIME[collision], change=2e-5,
                            fluid=dict(collision=collision, precision=precision), coupling=dict(wall_scheme=walls))
    settings = dict(fraction=fraction, D=D, walls=walls, collision=collision, precision=precision, position=position)
    return Run(key_of(fraction, D, method, position), text, settings)


def runs(level):
    if level == "short":
        return [run_of(*point, p) for point in ((0.064, 6, DEFAULT), (0.064, 8, DEFAULT), (0.216, 8, THIN)) for p in range(len(POSITIONS))]
    return [run_of(f, D, method, p) for f in FRACTIONS for D in SIZES + FINER for method in methods(f, D)
            for p in range(len(POSITIONS))]


def measure(run, outcome):
    return {"error": array.drag_error(run.settings["fraction"], outcome)}


def of_all_positions(measured, fraction, D, method, name="error"):
    """Returns the values of every position; [] unless all have been run: fewer might be lucky ones."""
    keys = keys_of(fraction, D, method)
    return [measured[key][name] for key in keys] if all(key in measured for key in keys) else []


def keys_of(fraction, D, method):
    return tuple(key_of(fraction, D, method, p) for p in range(len(POSITIONS)))


def figures(measured):
    found = {}
    for fraction in FRACTIONS:
        for D in SIZES + FINER:
            for method in methods(fraction, D):
                errors, keys = of_all_positions(measured, fraction, D, method), keys_of(fraction, D, method)
                if errors:
                    name = name_of(fraction, D, method)
                    found[f"{name}.mean_error"] = Found(array.mean(errors), keys)
                    found[f"{name}.spread"] = Found(max(errors) - min(errors), keys)
    found.update(order_of_convergence(measured))
    found.update(share_of_single(measured))
    return found


def name_of(fraction, D, method):
    suffix = {DEFAULT: "", PAPER: ".paper"}.get(method, "." + ".".join(method))
    return f"accuracy.array.{fraction:g}.d{D}{suffix}"


def order_of_convergence(measured):
    """Returns the order of the root mean square over the positions, from 8 cells across on, by least squares."""
    sizes = [D for D in SIZES + FINER if D >= 8]
    errors = {D: of_all_positions(measured, ORDER_FRACTION, D, DEFAULT) for D in sizes}
    if not all(errors.values()):
        return {}
    x, y = ([math.log(D) for D in sizes], [math.log(array.root_mean_square(errors[D])) for D in sizes])
    mx, my = array.mean(x), array.mean(y)
    slope = sum((a - mx) * (b - my) for a, b in zip(x, y)) / sum((a - mx) ** 2 for a in x)
    return {f"accuracy.array.{ORDER_FRACTION:g}.order": -slope}


def share_of_single(measured):
    """Returns the largest difference between single and double, in percent of the error of the discretisation there."""
    shares = []
    for fraction, D in itertools.product(FRACTIONS, SIZES + FINER):
        single, double = (of_all_positions(measured, fraction, D, method) for method in (DEFAULT, DOUBLE))
        if single and double:
            difference = max(abs(s - d) for s, d in zip(single, double))
            shares.append(100 * difference / array.root_mean_square(double))
    return {"accuracy.array.single_share": max(shares)} if shares else {}


def curve_of(measured, label, fraction, method, plot):
    points = []
    for D in SIZES + FINER:
        errors = of_all_positions(measured, fraction, D, method)
        if errors:
            cost = array.mean(of_all_positions(measured, fraction, D, method, "core_seconds"))
            points.append((cost, array.root_mean_square(errors), f"{D}"))
    return Curve(label, points, plot)


def curves(measured):
    """Returns the root mean square over the positions against the time of one run; the notes are cells across."""
    of_methods = [curve_of(measured, ", ".join(method), ORDER_FRACTION, method, "methods")
                  for method in itertools.product(WALLS, COLLISIONS, PRECISIONS)]
    return of_methods + [curve_of(measured, f"{name}, solid fraction {f:g}", f, method, "fractions")
                         for name, method in (("default", DEFAULT), ("SC10", PAPER)) for f in FRACTIONS]
