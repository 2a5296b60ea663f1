"""The structure of a packing: radial distribution, neighbours, and the order of the directions to them.

    from silt_results import structure
    run = silt_results.open("cases/packing")
    r, g = structure.radial_distribution(run, reach=0.03)       # at the end, of all bodies
    structure.neighbours(run, gap=1e-5).mean()                  # bodies that each one touches, as spheres
    structure.bond_order(run, reach=0.014, order=6)             # q6 of each body: 0.575 in a face-centred lattice
All take `index`, a time or several of them (-1), `kind`, the name of a kind, which the others are then of too (all kinds), and `box`, two
corners: they tell of the bodies whose centre lies there (the domain). Distances are over periodic sides.
"""
import numpy as np


class Cloud:
    """A Cloud is the centres and radii of bodies at one time in a box, of which some axes are periodic."""

    def __init__(self, run, index, kind, box):
        series = run.bodies
        rows = series.at(index)
        self.lower, self.upper = np.array(series.domain if box is None else box, float)
        whole = np.isclose(self.lower, series.domain[0]) & np.isclose(self.upper, series.domain[1])
        self.periodic = whole & np.array(run.scene.periodic)
        self.length = self.upper - self.lower
        chosen = self.within(rows["position"], box)
        if kind is not None:
            if kind not in series.kinds:
                raise ValueError(f"there is no kind {kind}; there are {', '.join(series.kinds)}")
            chosen &= rows["kind"] == series.kinds.index(kind)
        self.position = rows["position"][chosen]
        self.radius = series.bounding_radius[rows["kind"][chosen]] * rows.get("scale", np.ones(len(chosen)))[chosen]

    def within(self, position, box):
        """Says of places whether they lie in a box."""
        return np.ones(len(position), bool) if box is None else ((position >= box[0]) & (position <= box[1])).all(axis=1)

    def pairs(self, reach):
        """Returns the pairs closer than `reach`, each both ways round: rows of one, rows of the other, vectors from it to that."""
        if (self.periodic & (reach > self.length / 2)).any():
            raise ValueError(f"reach is {reach:g}; along a periodic axis it must be at most half a period, {self.length[self.periodic].min() / 2:g}")
        cells = np.clip((self.length / reach).astype(int), 1, 64)
        at = np.clip(((self.position - self.lower) / self.length * cells).astype(int), 0, cells - 1)
        number = np.ravel_multi_index(at.T, cells)
        order = np.argsort(number, kind="stable")
        begin = np.searchsorted(number[order], np.arange(cells.prod() + 1))
        found = []
        for offset in {tuple(np.where(self.periodic, o % cells, o)) for o in np.indices((3, 3, 3)).reshape(3, -1).T - 1}:
            to = np.where(self.periodic, (at + offset) % cells, at + offset)
            rows = np.flatnonzero(((to >= 0) & (to < cells)).all(axis=1))
            to = np.ravel_multi_index(to[rows].T, cells)
            count = begin[to + 1] - begin[to]
            first = np.repeat(rows, count)
            second = order[np.arange(count.sum()) - np.repeat(np.cumsum(count) - count - begin[to], count)]
            away = self.position[second] - self.position[first]
            away -= self.periodic * self.length * np.round(away / self.length)
            near = (np.einsum("ij,ij->i", away, away) < reach**2) & (first != second)
            found.append((first[near], second[near], away[near]))
        return tuple(map(np.concatenate, zip(*found)))


def directions(count=1000):
    """Returns unit vectors evenly over the sphere."""
    z = 1 - (2 * np.arange(count) + 1) / count
    turn = np.pi * (1 + 5**0.5) * np.arange(count)
    return np.column_stack([np.sqrt(1 - z**2) * np.cos(turn), np.sqrt(1 - z**2) * np.sin(turn), z])


def radial_distribution(run, reach, bins=100, index=-1, kind=None, box=None):
    """Returns the middles of the bins up to `reach` and g there: how many pairs are so far apart, over how many there would be of
    bodies spread at random over the box, whose sides are taken into account."""
    edges = np.linspace(0, reach, bins + 1)
    middle = (edges[1:] + edges[:-1]) / 2
    found, expected = np.zeros(bins), np.zeros(bins)
    for cloud in (Cloud(run, i, kind, box) for i in np.atleast_1d(index)):
        first, _, away = cloud.pairs(reach)
        found += np.histogram(np.linalg.norm(away, axis=1), edges)[0]
        share = 1 - middle[:, None, None] * np.abs(directions()) / cloud.length  # of the box that a shifted one still covers, axis by axis
        inside = np.clip(np.where(cloud.periodic, 1, share), 0, None).prod(axis=2).mean(axis=1)
        n = len(cloud.position)
        expected += n * (n - 1) / cloud.length.prod() * 4 / 3 * np.pi * (edges[1:]**3 - edges[:-1]**3) * inside
    return middle, np.divide(found, expected, out=np.full(bins, np.nan), where=expected > 0)


def neighbours(run, gap=0.0, index=-1, kind=None, box=None):
    """Returns of each body how many others are no further from it than `gap`, all taken as the spheres around them."""
    counts = []
    for cloud in (Cloud(run, i, kind, None) for i in np.atleast_1d(index)):
        first, second, away = cloud.pairs(2 * cloud.radius.max(initial=0) + gap) if len(cloud.position) else ([], [], None)
        if len(first):
            first = first[np.linalg.norm(away, axis=1) <= cloud.radius[first] + cloud.radius[second] + gap]
        counts.append(np.bincount(first, minlength=len(cloud.position))[cloud.within(cloud.position, box)])
    return np.concatenate(counts)


def bond_order(run, reach, order=6, index=-1, kind=None, box=None):
    """Returns of each body q_l after Steinhardt, Nelson and Ronchetti (1983), l = `order`, of the directions to those nearer than `reach`:
    the root of the mean of P_l(cos of the angle) over their pairs. 1 for one neighbour, nan for none."""
    legendre, values = np.polynomial.Legendre.basis(order), []
    for cloud in (Cloud(run, i, kind, None) for i in np.atleast_1d(index)):
        first, _, away = cloud.pairs(reach)
        row = np.argsort(first, kind="stable")
        unit = (away / np.linalg.norm(away, axis=1, keepdims=True))[row]
        counts, inside = np.bincount(first, minlength=len(cloud.position)), cloud.within(cloud.position, box)
        for own in (vectors for vectors, here in zip(np.split(unit, np.cumsum(counts)[:-1]), inside) if here):
            values.append(np.sqrt(max(legendre(own @ own.T).mean(), 0)) if len(own) else np.nan)
    return np.array(values)
