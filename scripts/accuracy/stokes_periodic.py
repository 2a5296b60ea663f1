"""Stokes flow around rigid bodies in a periodic box or between two plates, solved without a lattice.

Point forces are put on a surface inside each body, and their strengths chosen so that the velocity on the bodies'
surfaces is the wanted one, in the sense of least squares (method of fundamental solutions). The flow of a point force
already fulfils what the box asks for:

    PeriodicBox    period in x, y, z: Ewald's sum of Hasimoto's (J. Fluid Mech. 5 (1959) 317) flow, split as in Lindbo and
                   Tornberg, J. Comput. Phys. 229 (2010) 8994, eq. 9 to 12; the mean velocity of the box is zero
    Channel        period in x and y, no-slip plates at z = 0 and z = height: the periodic flow and, for each wave along the
                   plates, the smooth flow that takes its velocity off them

The error falls exponentially with the number of points as long as the point forces enclose the singularities of the flow
continued into the body: sphere_points and spheroid_points say where these are. Lengths in any unit, viscosity 1. Found
against independent results by tests/accuracy/stokes_periodic.py.

    box = PeriodicBox((4, 4, 4))
    sphere = sphere_points(centre, radius)
    flow, = solve(box, [sphere], [uniform((-1, 0, 0))])
    flow.force(0)                                          # on the fluid; holds the mean pressure gradient's share
"""
import dataclasses
import itertools
import math

import numpy as np

DIGITS = 1e-10  # of the point force's flow: what is left out of Ewald's sums and of the waves along the plates


def _erfc_scaled():
    """Returns erfc(x) exp(x^2) for 0 <= x <= 6, to 1e-14, as a polynomial in t = 2 / (2 + x)."""
    low = 2 / (2 + 6)
    series = np.polynomial.chebyshev.Chebyshev.interpolate(
        np.vectorize(lambda t: math.erfc(2 / t - 2) * math.exp((2 / t - 2)**2)), 26, [low, 1])
    return lambda x: series(2 / (2 + x))


_erfcx = _erfc_scaled()


@dataclasses.dataclass(frozen=True)
class Surface:
    """A Surface says where a body's flow is matched (on its surface) and where its point forces are (inside)."""
    centre: np.ndarray
    matched: np.ndarray    # [m, 3]
    sources: np.ndarray    # [n, 3]


class PeriodicBox:
    """Computes the flow of point forces, repeated with the box; 1 / viscosity, zero mean velocity over the box."""

    def __init__(self, lengths, split=None):
        """Takes Ewald's parameter split, 1 / length; its default makes waves and images cost alike."""
        self.lengths = np.array(lengths, float)
        self.volume = self.lengths.prod()
        reach = math.sqrt(-math.log(DIGITS)) + 0.3
        self.split = split or 4.2 / self.volume**(1 / 3)
        self.cut = reach / self.split
        largest = 2 * reach * self.split
        numbers = [np.arange(-int(largest * l / (2 * np.pi)), int(largest * l / (2 * np.pi)) + 1) for l in self.lengths]
        k = 2 * np.pi * np.stack(np.meshgrid(*numbers, indexing="ij"), -1).reshape(-1, 3) / self.lengths
        k = k[len(k) // 2 + 1:]  # of k and -k one
        k = k[(k**2).sum(1) < largest**2]
        self.waves = k
        k2 = (k**2).sum(1)
        s = k2 / (4 * self.split**2)
        self.weights = 2 / self.volume * (1 + s) * np.exp(-s) / k2
        images = [np.arange(-math.ceil(self.cut / l + 0.5), math.ceil(self.cut / l + 0.5) + 1) for l in self.lengths]
        self.images = np.array(list(itertools.product(*images))) * self.lengths

    def velocities(self, targets, sources):
        """Returns [targets, 3, sources, 3]: velocity at a target (first axes) of a unit force at a source (last axes)."""
        result = self._long_range(targets, sources)
        away = targets[:, None, :] - sources[None, :, :]
        away -= self.lengths * np.round(away / self.lengths)
        flat = result.transpose(0, 2, 1, 3).reshape(-1, 3, 3)
        away = away.reshape(-1, 3)
        for image in self.images:
            x = away + image
            r2 = (x**2).sum(1)
            near = np.flatnonzero(r2 < self.cut**2)
            if len(near):
                flat[near] += self._short_range(x[near], r2[near])
        return flat.reshape(len(targets), len(sources), 3, 3).transpose(0, 2, 1, 3)

    def _short_range(self, x, r2):
        r = np.sqrt(r2)
        gauss = np.exp(-self.split**2 * r2) * self.split / math.sqrt(np.pi)
        erfc = _erfcx(self.split * r) * np.exp(-self.split**2 * r2)
        along = (gauss / r2 + erfc / (2 * r * r2)) / (4 * np.pi)
        both = along * r2 - gauss / (2 * np.pi)
        return along[:, None, None] * x[:, :, None] * x[:, None, :] + both[:, None, None] * np.eye(3)

    def _long_range(self, targets, sources):
        result = np.zeros((len(targets), 3, len(sources), 3))
        for part in np.array_split(np.arange(len(self.waves)), len(self.waves) // 2000 + 1):
            k, w = self.waves[part], self.weights[part]
            phase, back = targets @ k.T, sources @ k.T
            there = np.hstack([np.cos(phase), np.sin(phase)])
            here = np.hstack([np.cos(back), np.sin(back)])
            across = np.eye(3) - k[:, :, None] * k[:, None, :] / (k**2).sum(1)[:, None, None]
            for i in range(3):
                for j in range(i, 3):
                    block = (there * np.tile(w * across[:, i, j], 2)) @ here.T
                    result[:, i, :, j] += block
                    if i != j:
                        result[:, j, :, i] += block
        return result


class Repeated:
    """Computes the flow of point forces that are repeated at several places of a box, by shifts in the box's lengths."""

    def __init__(self, box, places):
        self.box, self.places = box, np.array(places, float)

    def velocities(self, targets, sources):
        """Returns [targets, 3, sources, 3], as the box does."""
        return sum(self.box.velocities(targets, sources + place) for place in self.places)


class Channel:
    """Computes the flow of point forces between plates at rest at z = 0 and z = height, repeated along x and y; no mean pressure gradient."""

    def __init__(self, lengths, height, nearest):
        """Takes nearest, the least of the sums of distances to a plate, of a source and of a target."""
        self.lengths, self.height = np.array(lengths, float), float(height)
        self.area = self.lengths.prod()
        self.periodic = PeriodicBox((*self.lengths, 2 * self.height))
        largest = (-math.log(DIGITS) - 9) / nearest  # the flow is a thousandth of the force's at its nearest
        numbers = [np.arange(-int(largest * l / (2 * np.pi)), int(largest * l / (2 * np.pi)) + 1) for l in self.lengths]
        k = 2 * np.pi * np.stack(np.meshgrid(*numbers, indexing="ij"), -1).reshape(-1, 2) / self.lengths
        k = k[len(k) // 2 + 1:]
        self.waves = k[(k**2).sum(1) < largest**2]

    def velocities(self, targets, sources):
        result = self.periodic.velocities(targets, sources)
        result[:, 0, :, 0] += (mean := self._mean_profile(targets[:, 2], sources[:, 2]))
        result[:, 1, :, 1] += mean
        for part in np.array_split(self.waves, len(self.waves) // 500 + 1):
            self._add_plates(result, part, targets, sources)
        return result

    def _mean_profile(self, z, source):
        """Returns what the mean over x and y of the flow between the plates is more than that of the periodic one."""
        z, source = z[:, None], source[None, :]
        plates = np.minimum(z, source) * (self.height - np.maximum(z, source)) / self.height
        d, period = np.abs(z - source), 2 * self.height
        return (plates - (d**2 / (2 * period) - d / 2 + period / 12)) / self.area

    def _add_plates(self, result, k, targets, sources):
        """Adds for each wave the flow that vanishes with the periodic one at both plates.

        For a wave along e = k / |k|: the component across e and z is a sum of exp(-|k| z) and exp(-|k| (height - z)); w = u_z is
        a sum of these and of themselves times the distance, and u_e = i w' / |k|."""
        kappa = np.sqrt((k**2).sum(1))
        e = k / kappa[:, None]
        at_plates = [self._source_waves(kappa, plate - sources[:, 2]) for plate in (0.0, self.height)]
        h = kappa * self.height
        decay = np.exp(-h)
        # across: values at both plates of the two exponentials
        value = np.stack([np.stack([np.ones_like(h), decay], -1), np.stack([decay, np.ones_like(h)], -1)], 1)
        across = np.linalg.solve(value, -np.stack([p["across"] for p in at_plates], 1))  # [k, 2, sources]
        # w and w' / kappa at both plates of exp(-s), s exp(-s) with s from below, and the same with s from above
        zero, one = np.zeros_like(h), np.ones_like(h)
        matrix = np.stack([
            np.stack([one, zero, decay, h * decay], -1),
            np.stack([-one, one, decay, (h - 1) * decay], -1),
            np.stack([decay, h * decay, one, zero], -1),
            np.stack([-decay, (1 - h) * decay, one, -one], -1)], 1)
        # of unit force along e: w, then w'/kappa = -i u_e; the same of unit force along z
        right_e = np.stack([x for p in at_plates for x in (p["z of e"], -1j * p["e of e"])], 1)
        right_z = np.stack([x for p in at_plates for x in (p["z of z"], -1j * p["e of z"])], 1)
        of_e, of_z = np.linalg.solve(matrix, -right_e), np.linalg.solve(matrix, -right_z)

        low = kappa[:, None] * targets[:, 2]
        high = kappa[:, None] * (self.height - targets[:, 2])
        a, b = np.exp(-low), np.exp(-high)
        w = np.stack([a, low * a, b, high * b], 1)
        slope = np.stack([-a, (1 - low) * a, b, (high - 1) * b], 1)
        there = np.exp(1j * (k @ targets[:, :2].T))[:, None, :]
        back = np.exp(-1j * (k @ sources[:, :2].T))[:, None, :] * (2 / self.area)

        def add(i, j, left, right, weight):
            left, right = left * there * weight[:, None, None], right * back
            shape = (-1, left.shape[-1]), (-1, right.shape[-1])
            result[:, i, :, j] += (left.real.reshape(shape[0]).T @ right.real.reshape(shape[1]) -
                                   left.imag.reshape(shape[0]).T @ right.imag.reshape(shape[1]))

        t = np.stack([-e[:, 1], e[:, 0]], -1)
        one = np.ones(len(k))
        for i in range(2):
            for j in range(2):
                add(i, j, np.stack([a, b], 1), across, t[:, i] * t[:, j])
                add(i, j, 1j * slope, of_e, e[:, i] * e[:, j])
            add(i, 2, 1j * slope, of_z, e[:, i])
            add(2, i, w, of_e, e[:, i])
        add(2, 2, w, of_z, one)

    def _source_waves(self, kappa, distances):
        """Returns the periodic flow's wave at signed distances (z) from point forces, along e and z, and across: [waves, sources]."""
        result = dict.fromkeys(("across", "e of e", "z of e", "e of z", "z of z"), 0)
        for image in range(-3, 4):
            z = np.abs(s := distances + image * 2 * self.height)
            kz = kappa[:, None] * z
            e = np.exp(-kz) / (4 * kappa[:, None])
            result["across"] = result["across"] + 2 * e
            result["e of e"] = result["e of e"] + (1 - kz) * e
            result["z of z"] = result["z of z"] + (1 + kz) * e
            result["z of e"] = result["z of e"] - 1j * kappa[:, None] * s * e
        result["e of z"] = result["z of e"]
        return result


def fibonacci(count):
    """Returns points spread evenly over the unit sphere."""
    i = np.arange(count) + 0.5
    z, angle = 1 - 2 * i / count, np.pi * (1 + math.sqrt(5)) * i
    r = np.sqrt(1 - z**2)
    return np.stack([r * np.cos(angle), r * np.sin(angle), z], -1)


def sphere_points(centre, radius, count=400, depth=0.65):
    """Returns the points of a sphere, with its point forces at depth times the radius. Another sphere or a plate at a gap g (in radii) has its images
    at most at 1 - sqrt(g (1 + g / 4)) (sphere) or 1 - sqrt(g (2 + g)) + g (plate): the depth must be above that."""
    return Surface(np.array(centre, float), centre + radius * fibonacci(2 * count),
                   centre + radius * depth * fibonacci(count))


def spheroid_points(centre, polar, equatorial, rotation, count=600, depth=0.6):
    """Returns the points of a spheroid whose axis of symmetry is the last column of rotation, with the point forces on a confocal one (inside it all of an
    isolated spheroid's singularities lie between the foci), whose smaller axis is depth times the body's."""
    return ellipsoid_points(centre, (equatorial, equatorial, polar), rotation, count, depth)


def ellipsoid_points(centre, axes, rotation, count=600, depth=0.6):
    """Returns the points of an ellipsoid with these semi-axes in its own frame, likewise."""
    axes = np.array(axes, float)
    shift = (1 - depth**2) * axes.min()**2
    return Surface(np.array(centre, float), centre + (fibonacci(2 * count) * axes) @ rotation.T,
                   centre + (fibonacci(count) * np.sqrt(axes**2 - shift)) @ rotation.T)


def torus_points(centre, radius, tube, rotation, count=600, depth=0.4):
    """Returns the points of a torus about the last column of rotation, with the point forces on one whose tube is depth times as thick."""
    def lattice(number, thickness):
        around = round(math.sqrt(number * radius / tube))
        across = round(number / around)
        i, j = (x.ravel() for x in np.meshgrid(np.arange(around), np.arange(across), indexing="ij"))
        u, v = 2 * np.pi * (i + j % 2 / 2 + 0.25) / around, 2 * np.pi * (j + 0.5) / across
        rho = radius + thickness * np.cos(v)
        return centre + np.stack([rho * np.cos(u), rho * np.sin(u), thickness * np.sin(v)], -1) @ rotation.T
    return Surface(np.array(centre, float), lattice(2 * count, tube), lattice(count, depth * tube))


def uniform(velocity):
    return lambda x: np.broadcast_to(np.array(velocity, float), x.shape)


def rotation_about(centre, omega):
    return lambda x: np.cross(omega, x - centre)


@dataclasses.dataclass
class Mirrors:
    """Mirrors are planes through a point, across which the flow and the bodies are mirrored: u(Rx) = sign R u(x)."""
    centre: np.ndarray
    signs: tuple             # of the planes normal to x, y, z; 0: no mirror

    def elements(self):
        for choice in itertools.product(*[(1, -1) if s else (1,) for s in self.signs]):
            yield np.array(choice, float), math.prod(s for s, c in zip(self.signs, choice) if c < 0)

    def image(self, points, flip):
        return self.centre + flip * (points - self.centre)

    def whole(self, sources, strengths, residual):
        """Returns the flow of the point forces and of their images."""
        parts = list(self.elements())
        return Flow([np.concatenate([self.image(y, flip) for flip, _ in parts]) for y in sources],
                    [np.concatenate([sign * flip * f for flip, sign in parts]) for f in strengths], residual)

    def kept(self, points):
        away = points - self.centre
        return points[np.all([a >= 0 for a, s in zip(away.T, self.signs) if s] or [np.ones(len(points), bool)], axis=0)]


@dataclasses.dataclass
class Flow:
    sources: list            # of each body [n, 3]
    strengths: list          # of each body [n, 3]
    residual: float          # largest velocity error at the matched points over the largest wanted velocity

    def force(self, body):
        return self.strengths[body].sum(0)

    def torque(self, body, centre):
        return np.cross(self.sources[body] - centre, self.strengths[body]).sum(0)


def least_squares(matrix, wanted):
    """Solves the least squares by the triangle of both side by side: several times faster than numpy's singular values."""
    n = matrix.shape[1]
    triangle = np.linalg.qr(np.hstack([matrix, wanted]), mode="r")
    return np.linalg.solve(triangle[:n, :n], triangle[:n, n:])


def solve(box, bodies, velocities, mirrors=None):
    """Returns the flows in the box, one for each of the velocities (functions of the points) that the bodies' surfaces have. With
    mirrors the bodies are those of one part, and what is mirrored belongs to them too."""
    mirrors = mirrors or Mirrors(np.zeros(3), (0, 0, 0))
    matched = np.concatenate([mirrors.kept(b.matched) for b in bodies])
    sources = [mirrors.kept(b.sources) for b in bodies]
    points = np.concatenate(sources)
    matrix = np.zeros((len(matched), 3, len(points), 3))
    for flip, sign in mirrors.elements():
        matrix += sign * box.velocities(matched, mirrors.image(points, flip)) * flip
    matrix = matrix.reshape(3 * len(matched), -1)
    wanted = np.stack([v(matched).ravel() for v in velocities], -1)
    strengths = least_squares(matrix, wanted)
    errors = np.abs(matrix @ strengths - wanted).max(0) / np.abs(wanted).max(0)
    ends = np.cumsum([len(s) for s in sources])[:-1]
    return [mirrors.whole(sources, np.split(f.reshape(-1, 3), ends), error) for f, error in zip(strengths.T, errors)]
