"""Quantities that only compare a run with an exact solution: functions of a silt_results.Run, which `computed` names in a case's
reference.toml. They are of runs in lattice units, or of bodies alone."""
import tomllib

import numpy as np


def _fluid_of(run):
    """Returns the case as it was run, its last field, and the centres, velocities and viscosity of its fluid."""
    field = run.fields[-1]
    case = tomllib.loads(field.case_text)
    fluid = field["solid"] == 0 if "solid" in field.names else np.ones(field.size, bool)
    centres = np.stack(np.meshgrid(field.x, field.y, field.z, indexing="ij"), axis=-1)
    return case, field, centres[fluid], field["velocity"][fluid], (case["fluid"]["relaxation_time"] - 0.5) / 3


def _deviation(velocity, exact, largest):
    """Returns the largest deviation anywhere, over the largest speed."""
    return float(np.linalg.norm(velocity - exact, axis=-1).max() / largest)


def channel_error(run):
    """Returns that of Poiseuille flow along x between walls across y: g y (H - y) / (2 nu)."""
    case, _, x, velocity, viscosity = _fluid_of(run)
    g, height = case["fluid"]["body_force"][0], case["domain"]["size"][1]
    exact = np.zeros_like(velocity)
    exact[:, 0] = g * x[:, 1] * (height - x[:, 1]) / (2 * viscosity)
    return _deviation(velocity, exact, g * height**2 / (8 * viscosity))


def duct_error(run):
    """Returns that of the flow along x through a duct: White, Viscous Fluid Flow, eq. 3-48, for -a <= y <= a, -b <= z <= b."""
    case, _, x, velocity, viscosity = _fluid_of(run)
    a, b = 0.5 * np.array(case["domain"]["size"][1:])

    def speed(y, z):
        i = 2 * np.arange(400)[:, None] + 1  # the last term is below (1/800)^3 of the first
        s = i * np.pi / (2 * a)
        ratio = np.exp(-s * (b - abs(z))) * (1 + np.exp(-2 * s * abs(z))) / (1 + np.exp(-2 * s * b))  # of the two cosh
        series = ((-1) ** (i // 2) * (1 - ratio) * np.cos(s * y) / i**3).sum(axis=0)
        return 16 * a**2 * case["fluid"]["body_force"][0] / (viscosity * np.pi**3) * series

    exact = np.zeros_like(velocity)
    exact[:, 0] = speed(x[:, 1] - a, x[:, 2] - b)
    return _deviation(velocity, exact, speed(np.zeros(1), np.zeros(1))[0])


def pipe_error(run):
    """Returns that of the flow along a tube about x that turns: g (R^2 - r^2) / (4 nu) along it, omega x r across it."""
    case, _, x, velocity, viscosity = _fluid_of(run)
    tube, g = case["walls"][0], case["fluid"]["body_force"][0]
    arm, turn = x[:, 1:] - tube["point"][1:], tube["angular_velocity"]
    along = g * (tube["radius"]**2 - (arm**2).sum(axis=1)) / (4 * viscosity)
    exact = np.stack([along, -turn * arm[:, 1], turn * arm[:, 0]], axis=1)
    return _deviation(velocity, exact, g * tube["radius"]**2 / (4 * viscosity) + turn * tube["radius"])


def _vortex(run):
    """Returns the velocities of a Taylor-Green vortex in the x-y plane, what they were at the start, its decay rate, and the step."""
    case, field, x, velocity, viscosity = _fluid_of(run)
    kx, ky = 2 * np.pi / np.array(case["domain"]["size"][:2])
    start = np.zeros_like(velocity)
    start[:, 0] = -np.cos(kx * x[:, 0]) * np.sin(ky * x[:, 1])
    start[:, 1] = kx / ky * np.sin(kx * x[:, 0]) * np.cos(ky * x[:, 1])
    return velocity, start * np.linalg.norm(case["fluid"]["initial"]["velocity"]), viscosity * (kx**2 + ky**2), field.step


def vortex_velocity_error(run):
    """Returns the relative L2 error of the velocity."""
    velocity, start, rate, step = _vortex(run)
    exact = start * np.exp(-rate * step)
    return float(np.linalg.norm(velocity - exact) / np.linalg.norm(exact))


def vortex_decay_error(run):
    """Returns the relative error of the rate at which the velocity falls."""
    velocity, start, rate, step = _vortex(run)
    return float(-np.log((velocity * start).sum() / (start * start).sum()) / step / rate - 1)


def last_reversal(run):
    """Returns the latest time at which the spin of a brick about its axis y, that of the middle moment of inertia, changed its sign. Euler's
    equations give the rates of change at the two times around it, and a cubic between them the zero."""
    series = run.bodies
    edges = np.array(tomllib.loads(series.case_text)["shapes"][0]["edges"])
    inertia = (edges**2).sum() - edges**2  # but for a factor
    quaternion, spin = series.array("orientation")[:, 0], series.array("angular_velocity")[:, 0]
    w, v = quaternion[:, :1], -quaternion[:, 1:]  # to the body's frame
    cross = np.cross(v, spin)
    spin = spin + 2 * (w * cross + np.cross(v, cross))
    rate = (inertia[2] - inertia[0]) / inertia[1] * spin[:, 2] * spin[:, 0]
    last = np.flatnonzero(spin[1:, 1] * spin[:-1, 1] < 0)[-1]
    (f0, f1), h = spin[last:last + 2, 1], series.time[last + 1] - series.time[last]
    d0, d1 = h * rate[last:last + 2]
    roots = np.roots([2 * f0 - 2 * f1 + d0 + d1, 3 * f1 - 3 * f0 - 2 * d0 - d1, d0, f0])
    return float(series.time[last] + h * next(root.real for root in roots if abs(root.imag) < 1e-9 and 0 <= root.real <= 1))
