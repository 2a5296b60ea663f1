#!/usr/bin/python3
"""spectral_layer STEEPNESS [--points N] [--out FILE]

Rolls up the double shear layer of Minion and Brown (J. Comput. Phys. 138 (1997) 734) by a Fourier method of its own: vorticity
and stream function in the unit square, periodic, Re = 30 000, N points an edge, two thirds of the waves kept, Runge-Kutta of fourth
order. Writes the vorticity at time 1 at the middles of 64 x 64 cells, a row of the file for each y.
"""
import argparse

import numpy as np

REYNOLDS, PERTURBATION, CELLS = 30000, 0.05, 64


def start(n, steepness):
    """Returns the vorticity dv/dx - du/dy at the points (i/n, j/n), [j, i]."""
    x, y = np.meshgrid(np.arange(n) / n, np.arange(n) / n)
    u_y = -np.sign(y - 0.5) * steepness * (1 - np.tanh(steepness * (0.25 - abs(y - 0.5)))**2)
    return 2 * np.pi * PERTURBATION * np.cos(2 * np.pi * (x + 0.25)) - u_y


def roll_up(steepness, n, until=1.0):
    kx, ky = 2 * np.pi * np.fft.rfftfreq(n, 1 / n)[None, :], 2 * np.pi * np.fft.fftfreq(n, 1 / n)[:, None]
    square = kx**2 + ky**2
    kept = (abs(kx) < 2 * np.pi * n / 3) & (abs(ky) < 2 * np.pi * n / 3)
    inverse = np.divide(1, square, out=np.zeros_like(square), where=square > 0)
    w = np.fft.rfft2(start(n, steepness)) * kept

    def slope(w):
        psi = w * inverse
        u, v, w_x, w_y = (np.fft.irfft2(1j * k * f, (n, n)) for k, f in ((ky, psi), (-kx, psi), (kx, w), (ky, w)))
        return -np.fft.rfft2(u * w_x + v * w_y) * kept - square / REYNOLDS * w

    steps = int(np.ceil(until * n / 0.4))
    dt = until / steps
    for _ in range(steps):
        a = slope(w)
        b = slope(w + dt / 2 * a)
        c = slope(w + dt / 2 * b)
        w = w + dt / 6 * (a + 2 * b + 2 * c + slope(w + dt * c))
    middle = np.exp(1j * (kx + ky) / (2 * CELLS))  # sampled there
    return np.fft.irfft2(w * middle, (n, n))[::n // CELLS, ::n // CELLS]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("steepness", type=float)
    parser.add_argument("--points", type=int, default=512)
    parser.add_argument("--out")
    options = parser.parse_args()
    vorticity = roll_up(options.steepness, options.points)
    header = (f"vorticity of the double shear layer at time 1: Re = {REYNOLDS}, steepness {options.steepness:g}, {options.points} points,\n"
              "by spectral_layer.py; rows y, columns x, at (i + 1/2)/64")
    np.savetxt(options.out or f"10_shear_layer_{options.steepness:g}.csv", vorticity, "%.4f", ",", header=header)


if __name__ == "__main__":
    main()
