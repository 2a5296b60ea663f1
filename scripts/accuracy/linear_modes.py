#!/usr/bin/python3
"""linear_modes [--magic NUMBER] [--layers N]

What linear analysis says of trt and its walls. Whether a disturbance of fluid at rest between two plane walls grows: the
spectral radius of a step, less 1, for wall schemes, relaxation times and wall distances, over waves along the walls. How the
decay of a shear wave far from walls depends on its direction (lbm/README.md, equation 21). And up to which cell Reynolds
number u / nu a uniform flow is stable.
"""
import argparse

import numpy as np

AXES = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
C = np.array([(0, 0, 0)] + [tuple(s * x for x in axis) for axis in AXES for s in (1, -1)]
             + [tuple(s * (a + t * b) for a, b in zip(p, q)) for p, q in ((AXES[0], AXES[1]), (AXES[0], AXES[2]), (AXES[1], AXES[2]))
                for t in (1, -1) for s in (1, -1)])
W = np.array([1 / 3] + [1 / 18] * 6 + [1 / 36] * 12)
OPPOSITE = np.array([0] + [i + 1 if i % 2 else i - 1 for i in range(1, 19)])
EXCESS = 0.0005             # least excess, lbm/README.md, equation 14
SHARE_SLOPE = 1.8           # equation 20
WAVES = (0, np.pi / 2, np.pi)
TIMES = (0.502, 0.51, 0.55, 0.6, 0.7, 0.8, 1, 2, 3)
NOTICED = 5e-5              # growth a step
FLOWS = tuple(tuple(u * np.array(n) / np.linalg.norm(n)) for n in ((1, 0, 0), (1, 1, 0), (1, 1, 1)) for u in (0.05, 0.1))
DISTANCES = ((0.02, 0.02), (0.3, 0.3), (0.5, 0.5), (0.7, 0.7), (1, 1), (0.02, 1))


def collision(tau, magic, flow=(0, 0, 0)):
    """Returns the matrix of a collision of fluid that moves with a velocity, linear about that flow, [19, 19]."""
    swap = np.eye(19)[OPPOSITE]
    even, odd = (np.eye(19) + swap) / 2, (np.eye(19) - swap) / 2
    odd_time = magic / (tau - 0.5) + 0.5
    quadratic = 9 * (C @ flow)[:, None] * (C @ C.T) - 3 * (C @ np.array(flow))
    return (np.eye(19) - (even - W[:, None] * (1 + quadratic)) / tau - (odd - 3 * W[:, None] * (C @ C.T)) / odd_time)


def central(q, excess, tau):
    """Returns a, b, c, d, g of the scheme with T = magic + excess (equation 13)."""
    g = excess / (tau - 0.5)
    s = 1 / (0.5 + q + g)
    return np.array([(q + 0.5 - g) * s, 1 - 2 * q * s, (q - 0.5 + g) * s, 0, 0])


def coefficients(scheme, q, tau, magic, share=None):
    """Returns a, b, c, d, g of a wall scheme; `share` of multireflection if not that of equation 20."""
    if scheme == "bounce-back":
        return np.array([1, 0, 0, 0, 0])
    least = EXCESS * (0.5 + q)
    if scheme == "cli":
        return central(q, least, tau)
    if scheme == "parabolic":
        return central(q, max(5 / 8 * q * q - magic, least), tau)
    assert scheme == "multireflection", scheme
    share = min(1, SHARE_SLOPE * (tau - 0.5)**2 / magic) if share is None else share
    m, odd = 1 / (1 + q)**2, 2 * magic / (tau - 0.5)
    first, second = 1 - 2 * q - 2 * q * q, q * q
    whole = np.array([1 / m, first + odd, odd - first, -second - odd, second - odd]) * m
    return share * whole + (1 - share) * central(q, least, tau)


def step(scheme, tau, magic, distances, wave, layers, **options):
    """Returns the matrix of a step of a channel across y for the wave (x, z) along it, [19 layers, 19 layers]."""
    streaming = np.zeros((19, layers, 19, layers), complex)
    for i, j in np.ndindex(19, layers):
        phase = np.exp(-1j * (wave[0] * C[i][0] + wave[1] * C[i][2]))
        source = j - C[i][1]
        if 0 <= source < layers:
            streaming[i, j, i, source] = phase
            continue
        out, behind, back = OPPOSITE[i], j + C[i][1], np.conj(phase)  # the link, the layer behind, a step back along it
        a, b, c, d, g = coefficients(scheme, distances[int(source > 0)], tau, magic, **options)
        for value, direction, layer, factor in ((a, out, j, 1), (b, out, behind, back), (c, i, j, 1), (d, i, behind, back),
                                                (g, out, behind + C[i][1], back**2)):
            if value:
                streaming[i, j, direction, layer] += value * factor
    return streaming.reshape(19 * layers, -1) @ np.kron(collision(tau, magic), np.eye(layers))


def growth(scheme, tau, magic, distances, layers=5, **options):
    """Returns the spectral radius less 1: the largest over waves along the walls."""
    return max(np.abs(np.linalg.eigvals(step(scheme, tau, magic, distances, (x, z), layers, **options))).max()
               for x in WAVES for z in WAVES if z <= x) - 1


def shear_wave(direction, velocity, magic, tau=1.0, number=0.05):
    """Returns epsilon: a steady shear wave feels a viscosity of nu (1 + epsilon number^2)."""
    n, u = np.array(direction, float), np.array(velocity, float)
    n, u = n / np.linalg.norm(n), u / np.linalg.norm(u)
    odd_time = magic / (tau - 0.5) + 0.5
    source = 3 * W * (C @ u) * (1 - 0.5 / odd_time) + 3 * W * (C @ u) * 0.5 / odd_time
    there = np.exp(-1j * number * (C @ n))
    f = np.linalg.solve(np.eye(19) - there[:, None] * collision(tau, magic), there * source)
    nu = (tau - 0.5) / 3
    return (1 / (nu * number**2 * (C.T @ f + u / 2) @ u).real - 1) / number**2


def uniform_growth(flow, reynolds, magic, waves=13):
    """Returns the largest growth a step, of waves in every direction, in a uniform flow (cells a step) at u / nu = reynolds."""
    half, whole = np.linspace(0, np.pi, waves), np.linspace(-np.pi, np.pi, 2 * waves - 1)
    numbers = np.array(np.meshgrid(half, whole, whole)).reshape(3, -1).T[::3]
    there = np.exp(-1j * (numbers @ C.T))
    step_of_each = there[:, :, None] * collision(0.5 + 3 * np.linalg.norm(flow) / reynolds, magic, flow)
    return np.abs(np.linalg.eigvals(step_of_each)).max() - 1


def critical_reynolds(flow, magic):
    """Returns the u / nu, between 2 and 1500, above which a uniform flow grows by more than NOTICED a step; to 5 %."""
    low, high = 2, 1500
    while high > 1.05 * low:
        middle = (low * high)**0.5
        low, high = (low, middle) if uniform_growth(flow, middle, magic) > NOTICED else (middle, high)
    return low


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--magic", type=float, default=2 / 15)
    parser.add_argument("--layers", type=int, default=5)
    options = parser.parse_args()
    print("spectral radius less 1, by wall distances", *DISTANCES)
    for scheme in ("bounce-back", "cli", "parabolic", "multireflection"):
        for tau in TIMES:
            print(f"{scheme:16} tau {tau:5}", *(f"{growth(scheme, tau, options.magic, q, options.layers):8.0e}" for q in DISTANCES),
                  flush=True)
    print("epsilon of shear waves: along x, (1,1,0), (1,1,1)")
    for magic in (1 / 16, 1 / 12, 2 / 15, 1 / 6, 3 / 16):
        print(f"magic {magic:.4f}", *(f"{shear_wave(n, u, magic):8.4f}" for n, u in
                                      (((1, 0, 0), (0, 1, 0)), ((1, 1, 0), (0, 0, 1)), ((1, 1, 1), (1, -1, 0)))))
    print("critical u / nu of uniform flow: along x at 0.05 and 0.1, (1,1,0), (1,1,1)")
    for magic in (1 / 16, 1 / 12, 1 / 8, 2 / 15, 1 / 6, 3 / 16):
        print(f"magic {magic:.4f}", *(f"{critical_reynolds(flow, magic):5.0f}" for flow in FLOWS), flush=True)


if __name__ == "__main__":
    main()
