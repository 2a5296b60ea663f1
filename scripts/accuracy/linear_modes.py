#!/usr/bin/python3
"""linear_modes [--magic NUMBER] [--layers N]

What linear analysis says of the collision models and their walls. A model is a number, the magic of trt, or "regularised". Whether a disturbance of fluid at rest between two plane walls grows: the
spectral radius of a step, less 1, for wall schemes, relaxation times and wall distances, over waves along the walls. How the
decay of a shear wave far from walls depends on its direction (docs/method.md, equation 21). Up to which cell Reynolds
number u / nu a uniform flow is stable. And whether it stays so where it leaves through an outlet of given pressure.
"""
import argparse

import numpy as np

AXES = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
C = np.array([(0, 0, 0)] + [tuple(s * x for x in axis) for axis in AXES for s in (1, -1)]
             + [tuple(s * (a + t * b) for a, b in zip(p, q)) for p, q in ((AXES[0], AXES[1]), (AXES[0], AXES[2]), (AXES[1], AXES[2]))
                for t in (1, -1) for s in (1, -1)])
W = np.array([1 / 3] + [1 / 18] * 6 + [1 / 36] * 12)
OPPOSITE = np.array([0] + [i + 1 if i % 2 else i - 1 for i in range(1, 19)])
EXCESS = 0.0005             # least excess, docs/method.md, equation 14
SHARE_SLOPE = 1.8           # equation 20
CURVED = 0.01               # equation 20a
PARABOLIC = (0.02, 0.025)   # equation 20b
ALONG_AXES = np.abs(C).sum(axis=1) == 1
REGULARISED = "regularised"
WAVES = (0, np.pi / 2, np.pi)
TIMES = (0.502, 0.51, 0.55, 0.6, 0.7, 0.8, 1, 2, 3)
NOTICED = 5e-5              # growth a step
FLOWS = tuple(tuple(u * np.array(n) / np.linalg.norm(n)) for n in ((1, 0, 0), (1, 1, 0), (1, 1, 1)) for u in (0.05, 0.1))
DISTANCES = ((0.02, 0.02), (0.3, 0.3), (0.5, 0.5), (0.7, 0.7), (1, 1), (0.02, 1))


def ghosts_as_trt(tau):
    """Returns how much regularised relaxes third and fourth moments as trt does (equation 26)."""
    return min(1, max(0, (tau - 0.55) / 0.05))


def odd_time(tau, model):
    """Returns the relaxation time of the odd halves (equation 26); the magic of regularised is 1/6 where it can be."""
    if model != REGULARISED:
        return 0.5 + model / (tau - 0.5)
    wanted = 1 / 6 / (tau - 0.5)
    return 0.5 + wanted - (1 - ghosts_as_trt(tau)) * max(0, wanted - 0.5)


def magic_of(model, tau):
    """Returns (tau - 1/2)(tau_odd - 1/2)."""
    return (tau - 0.5) * (odd_time(tau, model) - 0.5)


def collision(tau, model, flow=(0, 0, 0)):
    """Returns the matrix of a collision of fluid that moves with a velocity, linear about that flow, [19, 19]."""
    return regularised(tau, np.array(flow)) if model == REGULARISED else two_relaxation_times(tau, model, flow)


def two_relaxation_times(tau, magic, flow):
    swap = np.eye(19)[OPPOSITE]
    even, odd = (np.eye(19) + swap) / 2, (np.eye(19) - swap) / 2
    quadratic = 9 * (C @ flow)[:, None] * (C @ C.T) - 3 * (C @ np.array(flow))
    return (np.eye(19) - (even - W[:, None] * (1 + quadratic)) / tau - (odd - 3 * W[:, None] * (C @ C.T)) / odd_time(tau, magic))


def regularised(tau, flow):
    """Returns the matrix of the model regularised (docs/method.md, equations 24 to 27), by a derivative along the imaginary axis."""
    tiny, steady = 1e-30, W * (3 * C @ flow)
    for _ in range(60):
        steady = collided(steady, 1)  # on the way to the equilibrium of third order
    return np.array([collided(steady + 1j * tiny * unit, tau).imag / tiny for unit in np.eye(19)]).T


def collided(g, tau):
    """Returns what populations become under regularised."""
    rho, u, even = g.sum(), C.T @ g, (g + g[OPPOSITE]) / 2
    keep, keep_third = 1 - 1 / tau, 1 - 1 / odd_time(tau, REGULARISED)
    keep_fourth = keep * ghosts_as_trt(tau)

    def second_order(moments):
        return W * (4.5 * np.einsum("ia,ab,ib->i", C, moments, C) - 1.5 * np.trace(moments))

    second = np.einsum("i,ia,ib->ab", g, C, C) - np.eye(3) * rho / 3
    off = second - np.outer(u, u)
    stress = off - np.eye(3) * np.trace(off) / 3  # its trace is relaxed at once
    sums = W * (rho + 3 * C @ u) + second_order(np.outer(u, u) + keep * stress)
    sums = sums + keep_fourth * (even - W * rho - second_order(second))
    for a, b in ((a, b) for a in range(3) for b in range(3) if a != b):  # third moments, as the lattice carries them
        third = ((1 - keep_third) * u[a] * u[b]**2 + keep * (u[a] * stress[b, b] + 2 * u[b] * stress[a, b])
                 + keep_third * (g @ (C[:, a] * C[:, b]**2 - C[:, a] / 3) - u[a] * off[b, b] - 2 * u[b] * off[a, b]))
        sums = sums + third * C[:, a] * np.where(ALONG_AXES, -1 / 2, C[:, b]**2 / 4)
    return sums


def central(q, excess, tau):
    """Returns a, b, c, d, g of the scheme with T = magic + excess (equation 13)."""
    g = excess / (tau - 0.5)
    s = 1 / (0.5 + q + g)
    return np.array([(q + 0.5 - g) * s, 1 - 2 * q * s, (q - 0.5 + g) * s, 0, 0])


def stable_share(tau, model):
    """Returns the part of multireflection that does not amplify (equation 20)."""
    return min(1, ((tau - 0.5) / CURVED)**2) * min(1, SHARE_SLOPE * (tau - 0.5)**2 / magic_of(model, tau))


def parabolic_share(tau, model):
    """Returns how much of the rest of multireflection is parabolic (equation 20b)."""
    none, whole = PARABOLIC
    return (1 - ghosts_as_trt(tau)) * min(1, max(0, (tau - 0.5 - none) / (whole - none))) if model == REGULARISED else 0


def coefficients(scheme, q, tau, model, share=None):
    """Returns a, b, c, d, g of a wall scheme; `share` of multireflection if not that which does not amplify."""
    magic = magic_of(model, tau)
    if scheme == "bounce-back":
        return np.array([1, 0, 0, 0, 0])
    least = EXCESS * (0.5 + q)
    if scheme == "cli":
        return central(q, least, tau)
    curved = min(1, ((tau - 0.5) / CURVED)**2) if scheme == "parabolic" else parabolic_share(tau, model)
    rest = central(q, max(curved * (5 / 8 * q * q - magic), least), tau)
    if scheme == "parabolic":
        return rest
    assert scheme == "multireflection", scheme
    share = stable_share(tau, model) if share is None else share
    m, odd = 1 / (1 + q)**2, 2 * magic / (tau - 0.5)
    first, second = 1 - 2 * q - 2 * q * q, q * q
    whole = np.array([1 / m, first + odd, odd - first, -second - odd, second - odd]) * m
    return share * whole + (1 - share) * rest


def without_excess(tau):
    """Returns how the populations of a cell change where it gives up an excess of 1, [19], and the matrix that takes, at low
    viscosity, what the trace of the second moments is off its equilibrium, [19, 19] (docs/method-walls.md, equation 9b)."""
    trace, share = (C**2).sum(axis=1) - 1, min(1, max(0, (0.53 - tau) / 0.01))
    return -(W + 3 * (np.arange(19) == 0)) / 4, np.eye(19) - share * np.outer(1.5 * W * trace, trace)


def step(scheme, tau, model, distances, wave, layers, keeps_mass=True, **options):
    """Returns the matrix of a step of a channel across y for the wave (x, z) along it, [19 layers, 19 layers]."""
    streaming = np.zeros((19, layers, 19, layers), complex)
    excess = np.zeros((layers, 19, layers), complex)
    for i, j in np.ndindex(19, layers):
        phase = np.exp(-1j * (wave[0] * C[i][0] + wave[1] * C[i][2]))
        source = j - C[i][1]
        if 0 <= source < layers:
            streaming[i, j, i, source] = phase
            continue
        out, behind, back = OPPOSITE[i], j + C[i][1], np.conj(phase)  # the link, the layer behind, a step back along it
        a, b, c, d, g = coefficients(scheme, distances[int(source > 0)], tau, model, **options)
        for value, direction, layer, factor in ((a, out, j, 1), (b, out, behind, back), (c, i, j, 1), (d, i, behind, back),
                                                (g, out, behind + C[i][1], back**2)):
            if value:
                streaming[i, j, direction, layer] += value * factor
        excess[j] += streaming[i, j]
        excess[j, out, j] -= 1
    if keeps_mass:
        given_up, projected = without_excess(tau)
        for j in (0, layers - 1):
            streaming[:, j] = np.tensordot(projected, streaming[:, j] + np.multiply.outer(given_up, excess[j]), 1)
    return streaming.reshape(19 * layers, -1) @ np.kron(collision(tau, model), np.eye(layers))


def growth(scheme, tau, model, distances, layers=5, **options):
    """Returns the spectral radius less 1: the largest over waves along the walls."""
    return max(np.abs(np.linalg.eigvals(step(scheme, tau, model, distances, (x, z), layers, **options))).max()
               for x in WAVES for z in WAVES if z <= x) - 1


def shear_wave(direction, velocity, model, tau=1.0, number=0.05):
    """Returns epsilon: a steady shear wave feels a viscosity of nu (1 + epsilon number^2)."""
    n, u = np.array(direction, float), np.array(velocity, float)
    n, u = n / np.linalg.norm(n), u / np.linalg.norm(u)
    source = 3 * W * (C @ u)
    there = np.exp(-1j * number * (C @ n))
    f = np.linalg.solve(np.eye(19) - there[:, None] * collision(tau, model), there * source)
    nu = (tau - 0.5) / 3
    return (1 / (nu * number**2 * (C.T @ f + u / 2) @ u).real - 1) / number**2


def uniform_growth(flow, reynolds, model, waves=13):
    """Returns the largest growth a step, of waves in every direction, in a uniform flow (cells a step) at u / nu = reynolds."""
    half, whole = np.linspace(0, np.pi, waves), np.linspace(-np.pi, np.pi, 2 * waves - 1)
    numbers = np.array(np.meshgrid(half, whole, whole)).reshape(3, -1).T[::3]
    there = np.exp(-1j * (numbers @ C.T))
    step_of_each = there[:, :, None] * collision(0.5 + 3 * np.linalg.norm(flow) / reynolds, model, flow)
    return np.abs(np.linalg.eigvals(step_of_each)).max() - 1


def critical_reynolds(flow, model):
    """Returns the u / nu, between 2 and 30000, above which a uniform flow grows by more than NOTICED a step; to 5 %."""
    low, high = 2, 30000
    while high > 1.05 * low:
        middle = (low * high)**0.5
        low, high = (low, middle) if uniform_growth(flow, middle, model) > NOTICED else (middle, high)
    return low


def reversed_at_outlets(tau):
    """Returns the part of the even half that outlets reverse (equation 28a)."""
    return 0.5 + 0.5 * min(1, max(0, (tau - 0.53) / 0.02))


def outlet_growth(flow, reynolds, part=None, layers=8):
    """Returns the largest growth a step, of waves along an outlet across x and the inlet before it, in a uniform flow (cells a step) of
    regularised at u / nu = reynolds. part: of the even half that the outlet reverses, if not that of its relaxation time."""
    tau = 0.5 + 3 * np.linalg.norm(flow) / reynolds
    part, collide = reversed_at_outlets(tau) if part is None else part, collision(tau, REGULARISED, flow)
    largest = 0
    for wave in ((y, z) for y in (-np.pi / 2, *np.linspace(0, np.pi, 5)) for z in WAVES):
        step = np.zeros((19, layers, 19, layers), complex)
        for i, j in np.ndindex(19, layers):
            source, out = j - C[i][0], OPPOSITE[i]
            if 0 <= source < layers:
                step[i, j, i, source] = np.exp(-1j * (wave[0] * C[i][1] + wave[1] * C[i][2]))
            elif source < 0:
                step[i, j, out, j] = 1
            else:
                step[i, j, :, j] = part * 2 * W[i] * (9 * (C[i] @ flow) * (C @ C[i]) - 3 * C @ flow)
                step[i, j, out, j] -= part
                step[i, j, i, j] += 1 - part
        largest = max(largest, np.abs(np.linalg.eigvals(step.reshape(19 * layers, -1) @ np.kron(collide, np.eye(layers)))).max())
    return largest - 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--magic", type=float, default=2 / 15)
    parser.add_argument("--layers", type=int, default=5)
    options = parser.parse_args()
    print("spectral radius less 1, by wall distances", *DISTANCES)
    for model in (options.magic, REGULARISED):
        for scheme in ("bounce-back", "cli", "parabolic", "multireflection"):
            for tau in TIMES:
                print(f"{model:.6}, {scheme:16} tau {tau:5}",
                      *(f"{growth(scheme, tau, model, q, options.layers):8.0e}" for q in DISTANCES), flush=True)
    print("epsilon of shear waves: along x, (1,1,0), (1,1,1)")
    for model in (1 / 16, 1 / 12, 2 / 15, 1 / 6, 3 / 16, REGULARISED):
        print(f"{model:.6}", *(f"{shear_wave(n, u, model):8.4f}" for n, u in
                                      (((1, 0, 0), (0, 1, 0)), ((1, 1, 0), (0, 0, 1)), ((1, 1, 1), (1, -1, 0)))))
    print("critical u / nu of uniform flow: along x at 0.05 and 0.1, (1,1,0), (1,1,1)")
    for model in (1 / 16, 1 / 12, 1 / 8, 2 / 15, 1 / 6, 3 / 16, REGULARISED):
        print(f"{model:.6}", *(f"{critical_reynolds(flow, model):5.0f}" for flow in FLOWS), flush=True)
    print("growth of regularised before an outlet, at u / nu of 15, 20, 50, 200, 2000: by anti-bounce-back, and by equation 28a")
    for flow in FLOWS:
        print(np.round(flow, 3), *(f"{outlet_growth(flow, re, part):8.0e}" for part in (1, None) for re in (15, 20, 50, 200, 2000)), flush=True)


if __name__ == "__main__":
    main()
