"""What a run writes, computed again from its bodies and fields: masses of shapes, figures of the report, means, points and parts of fields."""
import functools
import itertools

import h5py
import numpy as np
from random_scene import STONE
from silt_results import Field
from silt_results.surfaces import rotations
from symmetry import AXES, rotation

POINTS = 96  # along each axis, of the sums for compounds, whose parts overlap
MOTIONS = {"height": "position", "velocity": "velocity", "angular-velocity": "angular_velocity"}
AT_END = {f"{of}-{name}": (column, take) for name, column in MOTIONS.items() for of, take in (("mean", np.mean), ("least", np.min), ("largest", np.max))} | {
    f"{name}-deviation": (column, np.std) for name, column in MOTIONS.items()}


def from_moments(volume, centre, second):
    """Volume and inertia about the centre of mass, for density 1, from the integral of x x."""
    second = second - volume * np.outer(centre, centre)
    return volume, np.trace(second) * np.eye(3) - second


def polyhedron(corners, triangles):
    """Sums over the tetrahedra that triangles, turned outward, make with the origin."""
    a = np.array(corners, float)[np.array(triangles)]
    volumes, s = np.linalg.det(a) / 6, a.sum(axis=1)
    second = np.einsum("n,nij->ij", volumes / 20, np.einsum("nki,nkj->nij", a, a) + np.einsum("ni,nj->nij", s, s))
    return from_moments(volumes.sum(), volumes @ s / 4 / volumes.sum(), second)


def hull(corners):
    """The triangles of a convex body of few corners: those with all others on one side."""
    corners, triangles = np.array(corners, float), []
    for t in itertools.combinations(range(len(corners)), 3):
        heights = (corners - corners[t[0]]) @ np.cross(corners[t[1]] - corners[t[0]], corners[t[2]] - corners[t[0]])
        triangles += [t] if (heights < 1e-9).all() else [t[::-1]] if (heights > -1e-9).all() else []
    return corners, triangles


def is_in(part, x):
    x = (x - part.get("position", [0, 0, 0])) @ rotation(part.get("orientation"))
    if part["type"] == "sphere":
        return (x**2).sum(axis=-1) < part["diameter"]**2 / 4
    if part["type"] == "box":
        return (np.abs(x) < np.array(part["edges"]) / 2).all(axis=-1)
    return (np.hypot(x[..., 0], x[..., 1]) < part["diameter"] / 2) & (np.abs(x[..., 2]) < part["length"] / 2)


def compound(parts):
    wide = (np.arange(POINTS) + 0.5) * 16 / POINTS - 8
    x = np.stack(np.meshgrid(wide, wide, wide, indexing="ij"), axis=-1)
    inside, share_of_point = x[np.any([is_in(part, x) for part in parts], axis=0)], (16 / POINTS)**3
    return from_moments(share_of_point * len(inside), inside.mean(axis=0), share_of_point * inside.T @ inside)


def solid(shape):
    """Volume and inertia for density 1 of a shape."""
    r, h = shape.get("diameter", 0) / 2, shape.get("length", 0)
    barrel, ball, ends = np.pi * r * r * h, 4 / 3 * np.pi * r**3, r * r / 5 + h * h / 4 + 3 / 8 * h * r

    def middle(volume, *squares):  # integrals of x x, y y and z z
        return from_moments(volume, np.zeros(3), np.diag(squares))
    edges, diameters = np.array(shape.get("edges", [0] * 3)), np.array(shape.get("diameters", [0] * 3))
    across = barrel * r * r / 4 + ball * r * r / 5
    found = dict(sphere=lambda: middle(ball, *[ball * r * r / 5] * 3), cylinder=lambda: middle(barrel, *[barrel * r * r / 4] * 2, barrel * h * h / 12),
                 capsule=lambda: middle(barrel + ball, across, across, barrel * h * h / 12 + ball * ends),
                 box=lambda: middle(edges.prod(), *edges.prod() * edges**2 / 12),
                 ellipsoid=lambda: middle(np.pi / 6 * diameters.prod(), *np.pi / 6 * diameters.prod() * diameters**2 / 20),
                 mesh=lambda: polyhedron(*STONE), polyhedron=lambda: polyhedron(*hull(shape["vertices"])), compound=lambda: compound(shape["parts"]))
    return found[shape["type"]]()


def share(over, time):
    """The factor of over_time."""
    table = np.array((over or {}).get("table", [[0, 1]]))
    return np.interp(time, *table.T) + (over or {}).get("amplitude", 0) * np.sin(2 * np.pi * (over or {}).get("frequency", 0) * time)


def is_fluid(field):
    return field["solid"] == 0 if "solid" in field.names else np.ones(field.size, bool)


class Record:
    """The results of a scene that wrote its bodies in every step; with levels, in every step of the widest cells."""

    def __init__(self, tables, run):
        self.tables, self.run, self.report, self.is_wet = tables, run, run.report, "fluid" in tables
        self.every, self.steps = tables["output"]["bodies"]["every"], tables["run"]["steps"]
        self.size = np.array(tables["domain"]["size"])
        self.entries = {entry.get("name", entry["shape"]): entry for entry in tables["bodies"] + tables["fill"]}
        self.shapes = {shape["name"]: shape for shape in tables["shapes"]}
        self.solids = {name: solid(shape) for name, shape in self.shapes.items()}
        self.moves = any(entry.get("motion") != "fixed" for entry in self.entries.values())
        self.walls_move = any("motion" in wall for wall in tables.get("walls", []))
        self.sides = {f"{axis}-{end}": side for axis, sides in tables["domain"]["boundary"].items() if sides != "periodic"
                      for end, side in zip(("low", "high"), sides)}
        self.kinds = {side["type"] for side in self.sides.values()}
        self.columns = {name: values for series in tables["output"]["series"] for name, values in run.table(series["name"]).columns.items()}

    def sees(self, **wanted):
        """The quantities in every step of what is wanted, and the values of each."""
        return [(one, self.columns[one["name"]]) for one in self.tables["quantities"] if wanted.items() <= one.items() and one["name"] in self.columns]

    def gravity(self, time):
        table = self.tables.get("gravity", dict(acceleration=[0, 0, 0]))
        return np.array(table["acceleration"]) * share(table.get("over_time"), time)

    @functools.cached_property
    def bodies(self):
        """The columns of bodies.h5 for each time that was written, with the entries of the case, inertia, and how much of the mass floats."""
        found = []
        for n in range(len(self.run.bodies) if self.entries else 0):
            rows = self.run.bodies.at(n)
            entries = [self.entries[self.run.bodies.kinds[kind]] for kind in rows["kind"]]
            turned = rotations(rows["orientation"])
            own = np.array([entry["density"] * self.solids[entry["shape"]][1] for entry in entries]).reshape(-1, 3, 3)
            displaced = rows["mass"] / np.array([entry["density"] for entry in entries]) if self.is_wet else 0 * rows["mass"]
            found.append(rows | dict(entry=np.array(entries, object), inertia=turned @ own @ np.swapaxes(turned, 1, 2), displaced=displaced,
                                     is_free=~np.isnan(rows["contact_force"]).any(axis=1), place=rows["position"] + rows["image"] * self.size))
        return found

    @functools.cached_property
    def cells(self):
        """For each of these times the id of the body in each cell, and whether the cell is fluid."""
        fields = [Field(self.run.folder / f"slice_cells_{n:012}.hdf") for n in range(0, self.steps + 1, self.every)]
        return [(field["body-id"].astype(int), is_fluid(field)) for field in fields]

    def saved(self, step, column):
        """A column of the bodies of a checkpoint."""
        with h5py.File(self.run.folder / f"checkpoint_{step:012}.h5") as file:
            return file["bodies"][column][:]


def momentum_owed(record, step):
    """What the fluid owes to bodies, (38) of method-coupling.md: the momentum of their cells beyond their volume. With levels, where the velocities before the
    step are not written, it is that of the checkpoint."""
    if record.every > 1:
        return 2.0**-44 * record.saved(step, "impulse_debt")[:, :3].sum(axis=0)
    rows, ids, total = record.bodies[step - 1], record.cells[step][0], np.zeros(3)
    periodic = [record.tables["domain"]["boundary"][axis] == "periodic" for axis in AXES]
    for k, middle in enumerate(record.saved(step, "mapping_position")):
        arms = np.argwhere(ids == rows["id"][k]) + 0.5 - middle
        arms -= periodic * record.size * np.round(arms / record.size)
        total += (len(arms) - rows["displaced"][k]) * rows["velocity"][k] + np.cross(rows["angular_velocity"][k], arms.sum(axis=0))
    return total


def kinetic(rows):
    """The kinetic energy of bodies."""
    spin = np.einsum("bi,bij,bj->b", rows["angular_velocity"], rows["inertia"], rows["angular_velocity"])
    return 0.5 * (rows["mass"] * (rows["velocity"]**2).sum(axis=1) + spin).sum()


def of_bodies(record, one):
    """The value of a figure of bodies by its definition; None: it has none, or steps between were not written."""
    d, kind, start = AXES.index(one.get("axis", "z")), one["type"], one.get("time", 0)
    of_kind = [[entry is record.entries.get(one.get("body"), entry) for entry in rows["entry"]] for rows in record.bodies]
    times = [{key: value[those] for key, value in rows.items()} for rows, those in zip(record.bodies, of_kind)]
    first, last = times[0], times[-1]
    _, i, j = np.intersect1d(first["id"], last["id"], return_indices=True)
    if kind in AT_END and len(last["id"]):
        return AT_END[kind][1](last[AT_END[kind][0]][:, d])
    if kind in ("drift", "displacement") and len(i):
        moved = last["place"][j] - first["place"][i]
        return np.linalg.norm(moved, axis=1).max() if kind == "drift" else moved[:, d].mean()
    if record.every > 1 or not all(len(rows["id"]) for rows in times):
        return None
    free = [{key: value[rows["is_free"]] for key, value in rows.items()} for rows in times]
    g = record.gravity(0) / share(record.tables.get("gravity", {}).get("over_time"), 0)

    def speeds(rows):
        return np.where(rows["position"][:, d] >= one["height"], rows["velocity"][:, d], 0)

    def below(rows):
        return rows["mass"][rows["position"][:, d] < one["height"]].sum()

    def momentum(rows):
        return (rows["mass"] * rows["velocity"][:, d]).sum()

    def energy(rows):
        return kinetic(rows) - ((rows["mass"] - rows["displaced"]) * ((rows["place"] - np.where(g > 0, record.size, 0)) @ g)).sum()

    def torque(rows, time):
        return np.cross((rows["mass"] - rows["displaced"]) @ (rows["position"] - one["centre"]), record.gravity(time))[d]

    def angle(rows, time):
        down, m = record.gravity(time), rows["mass"] @ (rows["position"] - one["centre"])
        a, b = (d + 1) % 3, (d + 2) % 3
        return np.degrees(np.arctan2(down[a] * m[b] - down[b] * m[a], down[a] * m[a] + down[b] * m[b]))
    found = {"max-speed": lambda: max(np.linalg.norm(rows["velocity"], axis=1).max() for rows in times),
             "max-height-after": lambda: max(rows["position"][:, d].max() for rows in times[start:]),
             "rebound-ratio": lambda: max(0, *(speeds(rows).max() for rows in times)) / (-min(0, *(speeds(rows).min() for rows in times)) or np.nan),
             "discharge-rate": lambda: (below(last) - below(times[start])) / (record.steps - start),
             "momentum-change": lambda: (momentum(free[-1]) - momentum(free[0])) / (free[0]["mass"] * np.linalg.norm(free[0]["velocity"], axis=1)).sum(),
             "energy-change": lambda: energy(free[-1]) / energy(free[0]) - 1, "energy-growth": lambda: max(map(energy, free)) / energy(free[0]) - 1,
             "bed-angle": lambda: np.mean([angle(rows, n) for n, rows in enumerate(times) if n >= start]),
             "weight-torque": lambda: np.mean([torque(rows, n) for n, rows in enumerate(free) if n >= start])}
    with np.errstate(invalid="ignore", divide="ignore"):
        value = found[kind]() if kind in found else None
    return value if value is not None and np.isfinite(value) else None


def layers(field, d, at, periodic):
    """The two layers of cells beside a plane across an axis, and their shares."""
    low = int(np.floor(at - 0.5)) if periodic else min(max(int(np.floor(at - 0.5)), 0), field.size[d] - 2)
    return (low % field.size[d], 1 - (at - 0.5 - low)), ((low + 1) % field.size[d], at - 0.5 - low)


def of_fluid(record, one):
    """The value of a quantity of the fluid at the end; None: it is none, or does not follow from fields alone."""
    if not record.is_wet or record.every > 1:
        return None
    field, d = record.run.fields[-1], AXES.index(one.get("axis", "z"))
    fluid, u, periodic = is_fluid(field), field["velocity"], record.tables["domain"]["boundary"][AXES[d]] == "periodic"
    if one["type"] == "kinetic-energy":
        return 0.5 * (u[fluid]**2).sum(axis=-1).mean()
    if one["type"] == "dissipation":
        return (record.tables["fluid"]["relaxation_time"] - 0.5) / 3 * (field["shear-rate"][fluid]**2).mean()
    if one["type"] == "superficial-velocity":
        rows = [] if not record.entries else [v[d] for v, entry in zip(record.bodies[-1]["velocity"], record.bodies[-1]["entry"])
                                              if entry is record.entries.get(one.get("body"), entry)]
        return (u[fluid][:, d] - (np.mean(rows) if rows else 0)).sum() / fluid.size
    if one["type"] == "pressure-drop":
        sums = [[sum(s * values.take(k, d).sum() for k, s in layers(field, d, at, periodic)) for values in (np.where(fluid, field["pressure"], 0), fluid)]
                for at in one["at"]]
        return sums[0][0] / sums[0][1] - sums[1][0] / sums[1][1] if sums[0][1] > 0 and sums[1][1] > 0 else None
    if one["type"] == "flow-rate" and all(fluid.take([k - 1, k, k + 1], d, mode="wrap").all() for k, _ in layers(field, d, one["at"], periodic)):
        return sum(s * u[..., d].take(k, d).sum() for k, s in layers(field, d, one["at"], periodic))
    return None


def samples(record):
    """Means over time, points and parts of fields against the fields of the same steps: yields names and differences."""
    fields = {field.step: field for field in record.run.fields} if record.is_wet else {}
    for part in map(Field, record.run.folder.glob("slice_part_*.hdf")):
        box = tuple(slice(int(a), int(a) + n) for a, n in zip(part.lower + 0.5, part.size))
        for name in part.names if np.max(part.spacing) == 1 else ():  # else there are coarse cells only
            yield f"slice: {name}", part[name] - fields[part.step][name][box]
    if "mean" in record.tables["output"]:
        yield from means(record.run.mean, [field for step, field in sorted(fields.items()) if step >= record.tables["output"]["mean"]["from"]])
    probes = record.run.probes("line") if record.is_wet else None
    for n, (step, field) in enumerate(sorted(fields.items())):
        for k, x in enumerate(np.stack([probes.of(axis)[n] for axis in AXES], axis=1)):
            at = np.floor(x - 0.5).astype(int)
            box = tuple(slice(a, a + 2) for a in at)
            if (at >= 0).all() and (at + 2 <= field.size).all() and is_fluid(field)[box].all() and not field["level"][box].any():
                shares = np.prod(np.meshgrid(*([1 - a, a] for a in x - 0.5 - at), indexing="ij"), axis=0)
                yield "probe: density", np.tensordot(shares, field["density"][box], 3) - probes.of("density")[n][k]
                yield "probe: velocity", np.tensordot(shares, field["velocity"][box], 3) - [probes.of(f"velocity.{axis}")[n][k] for axis in AXES]


def means(mean, fields):
    fluid = np.stack([is_fluid(field) for field in fields])

    def over_time(values):
        return (fluid[..., None] * values).sum(axis=0) / np.maximum(fluid.sum(axis=0), 1)[..., None]
    u = np.stack([field["velocity"] for field in fields])
    away = u - over_time(u)
    yield "mean: velocity", mean["velocity"] - over_time(u)
    yield "mean: velocity-variance", mean["velocity-variance"] - over_time(away**2)
    yield "mean: velocity-covariance", mean["velocity-covariance"] - over_time(away[..., [0, 0, 1]] * away[..., [1, 2, 2]])
    yield "mean: pressure", mean["pressure"] - over_time(np.stack([field["pressure"] for field in fields])[..., None])[..., 0]
    yield "mean: solid-fraction", mean["solid-fraction"] - (1 - fluid.mean(axis=0))
