"""Stokes flow around one rigid body with edges in a periodic box, by boundary elements, for any orientation of the body.

A rigid body's flow is that of the tractions f on its surface alone (Pozrikidis, Boundary Integral and Singularity Methods, 1992,
section 4.1). f is constant on flat panels, which are finer towards the edges, where it has no bound; the velocity at their
centres is the wanted one. The integrals over a panel are in closed form. The flow of a point force in the box is that in
unbounded fluid and a smooth rest, which polynomials T_a of the place hold:

    integral of G f + sum T_a(x) K_ab P_b = u(x),   P_b = integral of T_b f,   so   P = (1 + A K)^-1 A u_a

A, the moments of the tractions that polynomials for velocity ask for, belongs to the body and is computed once; only K knows the
box and the orientation. Bodies are symmetric about the planes x, y, z = 0 of their frame: an eighth of each is enough.
Lengths in any unit, viscosity 1.

    body = Body(cube_panels(1.0, 16))
    resistance = body.resistance(PeriodicBox((4.25,) * 3), rotation)   # [6, 6]: force, torque by velocity, angular velocity
"""
import itertools

import numpy as np

DEGREE = 4                                # of the polynomials along each axis
FLIPS = np.array(list(itertools.product((1, -1), repeat=3)))


def graded(count, power=3.0):
    """Returns 0 to 1 in so many steps, finer towards 1."""
    return 1 - (1 - np.arange(count + 1) / count)**power


def cube_panels(edge, count):
    """Returns the panels of an eighth of a cube, [n, 4, 3]."""
    t = edge / 2 * graded(count)
    u, v = np.meshgrid(np.arange(count), np.arange(count), indexing="ij")
    u, v = u.ravel(), v.ravel()
    corners = [(t[u], t[v]), (t[u + 1], t[v]), (t[u + 1], t[v + 1]), (t[u], t[v + 1])]
    face = np.stack([np.stack([a, b, np.full(len(u), edge / 2)], -1) for a, b in corners], 1)
    return np.concatenate([np.roll(face, turn, -1) for turn in range(3)])


def cylinder_panels(radius, length, count):
    """Returns the panels of an eighth of a prism about the z axis, whose faces have the cylinder's radius in the mean."""
    step = np.pi / 2 / count
    angle = step * np.arange(count + 1)
    inner = step / 2 / np.log(np.tan(np.pi / 4 + step / 4))     # of the faces: the mean of 1 / cos is that of the cylinder
    ring = radius * inner / np.cos(step / 2) * np.stack([np.cos(angle), np.sin(angle)], -1)
    t = graded(count)

    def panel(k, j, low, high):
        ends = [(low[k], ring[j]), (low[k], ring[j + 1]), (high[k], ring[j + 1]), (high[k], ring[j])]
        return [[*(scale * point), z] for (scale, z), point in ends]

    side = [(1.0, length / 2 * z) for z in t]
    cap = [(r, length / 2) for r in t]
    pairs = list(itertools.product(range(count), range(count)))
    return np.array([panel(k, j, part[:-1], part[1:]) for part in (side, cap) for k, j in pairs])


def potentials(targets, panels):
    """Returns [targets, panels, 3, 3]: the velocity at a target by a unit traction on a panel, the integral of (1/r + rr/r^3) / 8 pi. Panels
    are flat polygons: Gauss' theorem in the plane makes sums over their sides of it."""
    first, second = panels[:, 1] - panels[:, 0], panels[:, 2] - panels[:, 0]
    third = panels[:, 3] - panels[:, 0]
    normal = np.cross(first, second) + np.cross(second, third)
    normal /= np.linalg.norm(normal, axis=-1)[:, None]
    w = np.einsum("tpi,pi->tp", targets[:, None] - panels[None, :, 0], normal)
    height = np.abs(w)
    simple, angle = np.zeros_like(w), np.zeros_like(w)
    vector, square = np.zeros((*w.shape, 3)), np.zeros((*w.shape, 3, 3))
    for k in range(panels.shape[1]):
        a, b = panels[:, k], panels[:, (k + 1) % panels.shape[1]]
        size = np.linalg.norm(b - a, axis=-1)
        sound = size > 1e-14
        t = (b - a) / np.where(sound, size, 1)[:, None]
        m = np.cross(t, normal)
        away = a[None] - targets[:, None]
        h = np.einsum("tpi,pi->tp", away, m)
        s1 = np.einsum("tpi,pi->tp", away, t)
        s2 = s1 + size
        r1, r2 = np.linalg.norm(away, axis=-1), np.linalg.norm(b[None] - targets[:, None], axis=-1)
        back = s1 + s2 < 0
        log = np.where(sound, np.log(np.where(back, r1 - s1, r2 + s2) / np.where(back, r2 - s2, r1 + s1)), 0)
        base = h**2 + w**2
        turn = np.where(sound, np.arctan2(h * s2, base + height * r2) - np.arctan2(h * s1, base + height * r1), 0)
        simple += h * log - height * turn
        angle += turn
        vector -= m * log[..., None]
        side = (h * log)[..., None] * m + np.where(sound, r2 - r1, 0)[..., None] * t
        square -= side[..., :, None] * m[:, None, :]
    # x - y = w n - rho, rho in the plane from the target's foot
    plane = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    square += simple[..., None, None] * plane
    mixed = -(w[..., None] * vector)[..., :, None] * normal[:, None, :]
    square += mixed + mixed.swapaxes(-1, -2)
    square += (height * angle)[..., None, None] * normal[:, :, None] * normal[:, None, :]
    return (square + simple[..., None, None] * np.eye(3)) / (8 * np.pi)


ORDERS = np.array(list(itertools.product(range(DEGREE + 1), repeat=3)))


def polynomials(points, half):
    """Returns [points, polynomials]: products of Chebyshev's, of x / half."""
    v = np.polynomial.chebyshev.chebvander(points / half, DEGREE)
    return np.einsum("pa,pb,pc->pabc", v[:, 0], v[:, 1], v[:, 2]).reshape(len(points), -1)


def _of_order(*orders):
    return int(np.flatnonzero((ORDERS == orders).all(1))[0])


class Body:
    """A Body knows the response of its shape in unbounded fluid."""

    def __init__(self, panels):
        self.half = np.abs(panels).max()
        centres = panels.mean(1)
        a, b, c = (panels[:, k] - panels[:, 0] for k in (1, 2, 3))
        areas = (np.linalg.norm(np.cross(a, b), axis=-1) + np.linalg.norm(np.cross(b, c), axis=-1)) / 2
        shape = polynomials(centres, self.half)
        parts = [self._flipped(centres, panels, flip) for flip in FLIPS]
        self.response = np.zeros((3 * len(ORDERS),) * 2)  # rows and columns: polynomial, component
        # mirrored at x = 0, a field whose component i is x^n ... is itself times -1 if n is odd, or if i is x, but not both
        parity = np.array([(n % 2) ^ (np.arange(3) == i) for n in ORDERS for i in range(3)])
        for kind in itertools.product((0, 1), repeat=3):
            members = np.flatnonzero((parity == kind).all(1))
            signs = [np.prod(np.where(flip < 0, 1 - 2 * np.array(kind), 1)) for flip in FLIPS]
            matrix = sum(sign * part for sign, part in zip(signs, parts))
            wanted = np.zeros((len(centres), 3, len(members)))
            for column, member in enumerate(members):
                wanted[:, member % 3, column] = shape[:, member // 3]
            tractions = np.linalg.solve(matrix, wanted.reshape(-1, len(members)))
            moments = 8 * (wanted * areas[:, None, None]).reshape(-1, len(members)).T
            self.response[np.ix_(members, members)] = moments @ tractions

    @staticmethod
    def _flipped(targets, panels, flip):
        """Returns the velocities at the targets by the panels' images, of which components are flipped too."""
        image = panels * flip
        blocks = [potentials(part, image) for part in np.array_split(targets, max(1, len(targets) * len(panels) // 100000))]
        return (np.concatenate(blocks) * flip).transpose(0, 2, 1, 3).reshape(3 * len(targets), -1)

    def resistance(self, box=None, rotation=np.eye(3)):
        """Returns [6, 6]: force and torque of the body on the fluid by its velocity and angular velocity, in the frame of the box,
        whose mean velocity is zero. rotation: from the body's frame to the box's."""
        motions = self._motions()
        response = self.response
        if box is not None:
            rest = self._rest(box, rotation)
            response = np.linalg.solve(np.eye(len(response)) + response @ rest, response)
        both = np.kron(np.eye(2), rotation)
        return both @ motions.T @ response @ motions @ both.T

    def _motions(self):
        """Returns [polynomials and components, 6]: uniform motions and rotations; its transpose makes force and torque of moments."""
        result = np.zeros((len(ORDERS), 3, 6))
        for i, unit in enumerate(np.eye(3)):
            result[_of_order(0, 0, 0), i, i] = 1
            for d, axis in enumerate(np.eye(3)):
                result[_of_order(*axis), :, 3 + i] = self.half * np.cross(unit, axis)
        return result.reshape(-1, 6)

    def _rest(self, box, rotation):
        """Returns K of the box, in the body's frame."""
        there, here = (self.half * np.cos(np.pi * (np.arange(n) + 0.5) / n) for n in (DEGREE + 1, DEGREE + 2))
        there, here = (np.stack(np.meshgrid(x, x, x, indexing="ij"), -1).reshape(-1, 3) for x in (there, here))
        values = box.velocities(there @ rotation.T, here @ rotation.T)
        away = (there[:, None] - here[None]) @ rotation.T
        r = np.linalg.norm(away, axis=-1)[..., None, None]
        free = (np.eye(3) / r + away[..., :, None] * away[..., None, :] / r**3) / (8 * np.pi)
        values = values.transpose(0, 2, 1, 3) - free
        values = rotation.T @ values @ rotation
        left = np.linalg.inv(polynomials(there, self.half))
        right = np.linalg.pinv(polynomials(here, self.half))
        return np.einsum("at,tsij,bs->aibj", left, values, right, optimize=True).reshape(3 * len(ORDERS), -1)
