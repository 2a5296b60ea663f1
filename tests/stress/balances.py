#!/usr/bin/python3
"""balances SILT [FIRST [COUNT]]: whether what scenes at random write obeys the laws of mechanics, one scene a seed.

The other scripts compare runs with runs; this one compares a run with laws, from its files alone:
  - each free body: mass times acceleration, and the change of angular momentum, are the sums of the loads that are written;
  - the fluid: its momentum, mass and heat change by what sides, walls, bodies and sources give;
  - contacts act on both bodies, press and rub by Coulomb's law, and do no work;
  - figures of the report, means, points and parts of fields are those of the bodies and fields, computed by themselves (recomputed.py).
The scenes are those of symmetries.py, a third of them without their fluid. All is to rounding in double precision; each check says where.
"""
import collections
import pathlib
import random
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import silt_runs  # noqa: E402, F401, I001 (the path)
from case_text import case_text  # noqa: E402
from silt_results.surfaces import rotations  # noqa: E402
from random_scene import result  # noqa: E402
from recomputed import AT_END, Record, is_fluid, kinetic, momentum_owed, of_bodies, of_fluid, samples, share  # noqa: E402
from symmetries import scene_of  # noqa: E402
from symmetry import AXES  # noqa: E402

LOADS = ("fluid-force", "fluid-torque", "contact-force", "contact-torque", "heat-flow")  # of a step
STATES = ("stored-heat", "mean-temperature", "body-force")                                # at its end
OPEN = {"velocity-inlet", "pressure-outlet"}
TOLERANCE = 1e-9  # of 10^5 cells, whose sums are rounded to quanta of 2^-48 to 2^-40


def without(table, *keys):
    return {key: value for key, value in table.items() if key not in keys}


def dry(tables):
    """The bodies of a scene alone."""
    def cold(entries):
        return [without(entry, "temperature", "heat_capacity", "heat_source", "heat_flux") for entry in entries]
    boundary = {axis: sides if sides == "periodic" or sides[0]["type"] in OPEN else cold(sides) for axis, sides in tables["domain"]["boundary"].items()}
    boundary = {axis: "periodic" if sides != "periodic" and sides[0]["type"] in OPEN else sides for axis, sides in boundary.items()}
    return without(tables, "fluid", "heat", "coarsening", "coupling") | {key: cold(tables.get(key, [])) for key in ("bodies", "fill", "walls")} | dict(
        domain=tables["domain"] | dict(boundary=boundary), run=dict(steps=200))


def simpler(tables, draw):
    """The tables without some of what has no exact balance, so that most scenes have one."""
    def often():
        return draw.random() < 0.7
    closed, round_about = often(), "coarsening" in tables and often()
    boundary = {axis: "periodic" if round_about or (closed and sides != "periodic" and sides[0]["type"] in OPEN) else sides
                for axis, sides in tables["domain"]["boundary"].items()}
    tables = tables | dict(domain=tables["domain"] | dict(boundary=boundary))
    if often():
        tables["walls"] = [without(wall, "motion") for wall in tables.get("walls", [])]
    if often():
        tables["outflow"], tables["fill"] = [], []
    if "heat" in tables and often():
        tables["heat"]["expansion"] = 0
    if "fluid" in tables and often():
        tables["coupling"]["force"] = "exact"
    if any("locked" in body for body in tables["bodies"]):
        tables["contacts"] = without(tables["contacts"], "impact_sweeps") | dict(resolver="sffd")
    tables["springs"] = [] if "coarsening" in tables else tables.get("springs", [])  # whose forces are written at the times of bodies only
    if tables["springs"] and often():
        tables["springs"] = [without(spring, "damping") for spring in tables["springs"]]
    for spring in tables["springs"]:
        others = [body for body in tables["bodies"] if body.get("name", spring["body"]) != spring["body"]]
        ends = [spring["ends"][0], others[0]["position"] if others else spring["ends"][1]]
        spring |= (dict(to=others[0]["name"]) if others else {}) | dict(ends=[[x + 1, y - 0.5, z + 0.75] for x, y, z in ends])  # beside the middles
    return tables


def loads(tables):
    """Quantities that have a value in every step: what acts on sides, walls and kinds of bodies, and heat."""
    sides = {f"{axis}-{end}": side for axis, both in tables["domain"]["boundary"].items() if both != "periodic"
             for end, side in zip(("low", "high"), both)}
    kinds = [dict(body=name) for name in dict.fromkeys(entry.get("name", entry["shape"]) for entry in tables["bodies"] + tables["fill"])]
    walls = [dict(wall=wall["name"]) for wall in tables.get("walls", [])]
    bear = [dict(side=name) for name, side in sides.items() if side["type"] in ("no-slip", "moving")]
    stop = [dict(side=name) for name, side in sides.items() if side.get("solid_for_bodies", True)]
    found = [dict(type="body-force", axis=axis) for axis in AXES] if "fluid" in tables else []
    for what, has, bearers in (("fluid", "fluid" in tables, bear), ("contact", kinds, stop)):
        found += [dict(type=f"{what}-force", axis=axis) | of for of in bearers + walls + kinds for axis in AXES] if has else []
        found += [dict(type=f"{what}-torque", axis=axis) | of for of in walls + kinds for axis in AXES] if has else []
    heat = [dict(type="heat-flow") | of for of in bear + walls + kinds] + [dict(type="stored-heat"), dict(type="mean-temperature")]
    return found + (heat if "heat" in tables else [])


def figures(tables, draw):
    """Quantities of every type that is computed again, each of a kind of bodies and along an axis at random."""
    size, kinds = tables["domain"]["size"], [entry.get("name", entry["shape"]) for entry in tables["bodies"]]
    same = not tables["fill"] and not tables.get("outflow") and all(sides == "periodic" or all(side.get("solid_for_bodies", True) for side in sides)
                                                                     for sides in tables["domain"]["boundary"].values())
    driven = any(entry.get("motion", "free") not in ("free", "fixed") for entry in tables["bodies"])
    types = [*AT_END, "drift", "displacement", "max-speed", "max-height-after", "rebound-ratio"] if kinds else []
    types += ["bed-angle", "weight-torque"] if kinds and "gravity" in tables else []
    types += ["discharge-rate", "momentum-change", "energy-change"] + ["energy-growth"] * (not driven) if kinds and same else []
    types += ["kinetic-energy", "dissipation", "superficial-velocity", "pressure-drop", "flow-rate"] if "fluid" in tables else []
    found = []
    for name in types:
        axis = draw.choice(AXES)
        n = size[AXES.index(axis)]
        centre = dict(time=10, centre=[n / 3 for n in size])
        more = {"max-height-after": dict(time=10), "rebound-ratio": dict(height=n / 3), "discharge-rate": dict(time=10, height=n / 2), "bed-angle": centre,
                "weight-torque": centre, "pressure-drop": dict(at=[n * draw.random(), n * draw.random()]), "flow-rate": dict(at=n * draw.random())}
        keys = {} if name in ("drift", "max-speed", "energy-change", "energy-growth", "kinetic-energy", "dissipation") else dict(axis=axis)
        is_of_fluid = name in ("kinetic-energy", "dissipation", "pressure-drop", "flow-rate")
        body = dict(body=draw.choice(kinds)) if kinds and draw.random() < 0.5 and not is_of_fluid else {}
        found.append(dict(type=name) | keys | more.get(name, {}) | body)
    return found


def scene(seed):
    """The tables of a scene that writes all that balances need."""
    draw, tables = random.Random(f"balances {seed}"), scene_of(seed)
    tables = simpler(dry(tables) if draw.random() < 0.3 and tables["bodies"] else tables, draw)
    every, steps, size = 2 ** tables.get("coarsening", dict(levels=0))["levels"], tables["run"]["steps"], tables["domain"]["size"]
    tables["quantities"] = [dict(name=f"q{n}") | one for n, one in enumerate(loads(tables) + figures(tables, draw))]
    series = [dict(name=name, every=every, columns=[one["name"] for one in tables["quantities"] if one["type"] in types]) | more
              for name, types, more in (("loads", LOADS, dict(mean_of=every)), ("states", STATES, {}))]
    tables["output"] = dict(bodies=dict(every=every, contacts=True), checkpoint=dict(every=steps // 4, keep=9), report=dict(every=every),
                            series=[one for one in series if one["columns"]])
    if "fluid" in tables:
        names = ["velocity", "density", "pressure", "shear-rate", *(["temperature"] if "heat" in tables else [])]
        fields = dict(quantities=names, precision="double", every=steps // 4)
        probes = dict(name="line", line=[[2, 3, 4], [n - 3.25 for n in size]], count=9, every=steps // 4, quantities=["velocity", "density"])
        cells = dict(name="cells", box=[[0, 0, 0], size], every=every, quantities=["body-id"])
        tables["output"] |= dict(fields=fields, probes=[probes], slices=[cells, fields | dict(name="part", box=[[0, 4, 8], [16, 20, 24]])])
        if "coarsening" not in tables and "balance" not in tables["run"]:
            tables["output"]["mean"] = {"from": steps // 4, "every": steps // 4}
    return tables


def pairs(record):
    """Yields the number of a time and the bodies before and at it, those that are in both."""
    for n, (old, now) in enumerate(zip(record.bodies, record.bodies[1:])):
        _, rows, others = np.intersect1d(old["id"], now["id"], return_indices=True)
        yield n + 1, *({key: value[kept] for key, value in of.items()} for of, kept in ((old, rows), (now, others)))


def locks(rows, about=""):
    """Says which axes of bodies are locked, [body, axis]."""
    return np.array([[about + axis in entry.get("locked", []) for axis in AXES] for entry in rows["entry"]], bool).reshape(-1, 3)


def newton(record):
    """Free bodies, step by step. The mass of compounds, whose parts overlap, is known to a thousandth here; the spin of a body with locked axes is that
    before the last half step; `ffd` loses a part of the force on a body in contact."""
    for n, old, now in pairs(record) if record.every == 1 else ():
        gravity, mass, change = record.gravity(n - 0.5), now["mass"][:, None], now["velocity"] - old["velocity"]
        exact = np.array([record.shapes[entry["shape"]]["type"] != "compound" for entry in now["entry"]], bool)
        volumes = np.array([record.solids[entry["shape"]][0] * entry["density"] for entry in now["entry"]])
        yield "mass", (now["mass"] / volumes - 1) * np.where(exact, 1, 1e-7)
        if "buoyancy" in now:
            yield "buoyancy", now["buoyancy"] + now["displaced"][:, None] * gravity
        force = now["force"] + now["contact_force"] + now.get("buoyancy", 0) + now.get("spring_force", 0) + mass * gravity
        torque = now["torque"] + now["contact_torque"] + now.get("spring_torque", 0)
        whole = now["is_free"] & ~((record.tables["contacts"]["resolver"] == "ffd") & now["contact_force"].any(axis=1))
        yield "force", np.where(locks(now), 0, mass * change - force)[whole]
        yield "locked axis", change[locks(now)]
        turns = ~locks(now, "rotation ")
        missing = np.subtract(*(np.einsum("bij,bj->bi", rows["inertia"], rows["angular_velocity"]) for rows in (now, old))) - torque
        yield "torque", (np.where(turns, missing, 0) * np.where(exact, 1, 3e-9)[:, None] * np.where(turns.all(axis=1), 1, 1e-6)[:, None])[whole]


def kinds_of_bodies(record):
    """Loads on a kind of bodies are the sums over its bodies, and change its momentum also where steps are summed."""
    columns = {"fluid-force": "force", "contact-force": "contact_force", "fluid-torque": "torque", "contact-torque": "contact_torque"}
    for n, old, now in pairs(record):
        for name, entry in record.entries.items():
            mine = np.array([of is entry for of in now["entry"]], bool)
            if not now["is_free"][mine].all() or len(record.bodies[n]["id"]) != len(mine):
                continue
            total = {what: np.array([values[n] for _, values in record.sees(type=what, body=name)] or [0, 0, 0]) for what in columns}
            if record.every == 1:
                yield from ((what, total[what] - now[column][mine].sum(axis=0)) for what, column in columns.items())
            elif record.tables["contacts"]["resolver"] == "sffd" and not entry.get("locked"):
                change = (now["mass"][:, None] * (now["velocity"] - old["velocity"]))[mine].sum(axis=0)
                weight = (now["mass"] - now["displaced"])[mine].sum() * record.gravity(0)
                yield "force on a kind", change - record.every * (total["fluid-force"] + total["contact-force"] + weight)


def springs(record):
    """Springs without dampers pull by their stiffness along the shortest way between their ends, halfway through a step, (49) of method-coupling.md."""
    tables = record.tables
    if not tables["springs"] or any("damping" in spring for spring in tables["springs"]):
        return
    periodic = [tables["domain"]["boundary"][axis] == "periodic" for axis in AXES]

    def way(a, b):
        return b - a - periodic * record.size * np.round((b - a) / record.size)

    def row_of(rows, name):
        return [k for k, entry in enumerate(rows["entry"]) if entry.get("name") == name]

    def arm(rows, name, end, after):  # of an end, `after` a part of a step; it starts at the given place
        start = record.bodies[0]
        (first,), (k,) = row_of(start, name), row_of(rows, name)
        own = rotations(start["orientation"])[first].T @ way(start["position"][first], np.array(end))
        half = np.array([[1, *0.5 * after * rows["angular_velocity"][k]]])
        return k, rotations(half / np.linalg.norm(half))[0] @ rotations(rows["orientation"])[k] @ own
    for n, old, now in pairs(record):
        force, torque = np.zeros((2, len(now["id"]), 3))
        for spring in tables["springs"]:
            names = [spring["body"], *([spring["to"]] if "to" in spring else [])]
            if not all(row_of(now, name) for name in names):
                return
            at = [arm(old, name, end, 0.5) for name, end in zip(names, spring["ends"])]
            places = [old["position"][k] + 0.5 * old["velocity"][k] + own for k, own in at] + [np.array(spring["ends"][1])]
            apart, length = way(*places[:2]), np.linalg.norm(way(*map(np.array, spring["ends"])))
            pull = spring["stiffness"] * (1 - length / np.linalg.norm(apart)) * apart
            for (k, own), sign in zip(at, (1, -1)):
                if now["is_free"][k]:
                    force[k] += sign * pull
                    torque[k] += np.cross(own, sign * pull)
        yield "spring force", now["spring_force"] - force
        yield "spring torque", now["spring_torque"] - torque


def momentum(record):
    """The fluid gains what drives it, less what acts on bodies, sides and walls. The fluid owes a body what its cells hold beyond its volume, and gets
    impacts later. So it is with `exact`, or where nothing moves; not across free-slip sides, with open sides and walls that move, with buoyancy where cells
    change, nor, with levels, where steps between have other cells, or where a border of levels meets a side, whose force lacks what packets leave there."""
    tables, expansion, levels = record.tables, record.tables.get("heat", {}).get("expansion", 0), "coarsening" in record.tables
    if not record.is_wet or record.kinds & OPEN or record.walls_move or (record.moves and (tables["coupling"]["force"] != "exact" or expansion)):
        return
    if levels and (record.kinds & {"no-slip", "moving"} or (record.moves and "body_force" in tables["fluid"]) or expansion):
        return
    drive = np.stack([values for _, values in record.sees(type="body-force")], axis=1)
    fluid = np.array([cells.sum() for _, cells in record.cells])
    gain = record.every * fluid[1:, None] * 0.5 * (drive[:-1] + drive[1:])  # a velocity has half of the next step's force
    if expansion:
        gain -= expansion * (record.sees(type="mean-temperature")[0][1] * fluid)[:-1, None] * record.gravity(0)
    for n, _, now in pairs(record) if tables["fluid"].get("body_force_on_bodies") else ():
        gain[n - 1] += record.every * now["displaced"][now["is_free"]].sum() * drive[n - 1]
    for what in ("fluid-force", "contact-force") if tables["contacts"]["resolver"] == "sffd" else ("fluid-force",):
        for one, values in record.sees(type=what):
            gain[:, AXES.index(one["axis"])] -= record.every * values[1:]

    def held(field):
        u = field["velocity"][is_fluid(field)].sum(axis=0)
        return u + momentum_owed(record, field.step) + record.saved(field.step, "pending_impact").sum(axis=0) if record.entries else u
    bears = [not any(name[0] == axis and side["type"] == "free-slip" for name, side in record.sides.items()) for axis in AXES]
    for old, new in zip(record.run.fields[1:], record.run.fields[2:]):  # there is no checkpoint before
        first, last = old.step // record.every, new.step // record.every
        if len({tuple(rows["id"]) for rows in record.bodies[first:last + 1]}) < 2:
            yield "momentum", (held(new) - held(old) - gain[first:last].sum(axis=0))[bears]


def heat(record):
    """The heat that is stored changes by what sides, walls and bodies of given temperature give, and by what bodies and a mean gradient produce. What a body
    of given temperature covers has that temperature. Such a body shows its flow over some steps: sums over one are a hundredth as exact."""
    tables, ids = record.tables, {tuple(rows["id"]) for rows in record.bodies}
    if "heat" not in tables or record.kinds & OPEN or len(ids) > 1:
        return
    diffusivity = min(1, (tables["fluid"]["relaxation_time"] - 0.5) / 3 / tables["heat"]["prandtl"])
    gradient, given = np.array(tables["heat"].get("mean_gradient", [0, 0, 0])), lambda entry: "temperature" in entry and "heat_capacity" not in entry
    if (gradient.any() and (record.moves or record.walls_move or record.every > 1)) or (record.every > 1 and any(map(given, record.entries.values()))):
        return
    stored = np.array(record.sees(type="stored-heat")[0][1])
    rate = np.full(len(stored) - 1, 0.0 + sum(entry.get("heat_source", 0) for rows in record.bodies[:1] for entry in rows["entry"]))
    for one, values in record.sees(type="heat-flow"):
        values = np.nan_to_num(values)
        if "body" not in one:
            rate += values[1:]
        elif given(record.entries[one["body"]]):
            rate += (values[1:] - (1 - diffusivity) * values[:-1]) / diffusivity
    if gradient.any():
        rate -= np.stack([record.run.series[f"momentum.fluid.{axis}"] for axis in AXES], axis=1)[:-1] @ gradient
    for n, rows in enumerate(record.bodies):
        stored[n] += sum(entry["temperature"] * (record.cells[n][0] == i).sum() for i, entry in zip(rows["id"], rows["entry"]) if given(entry))
    yield "heat", 1e-2 * (np.diff(stored) - record.every * rate)


def mass(record):
    """The drift of the mass is that of the fields and of what bodies owe; in a closed domain, in which no wall moves, it is what cells took."""
    for field in record.run.fields[1:] if record.is_wet else ():
        owed = 2.0**-50 * record.saved(field.step, "mass_owed")[:, 0].sum() if record.entries else 0
        start, now = ((of["density"] - 1)[is_fluid(of)] for of in (record.run.fields[0], field))
        yield "mass drift", (now.sum() + owed - start.sum()) / len(start) - record.run.series["mass_drift"][field.step // record.every]
    if record.is_wet and not record.walls_move and not record.kinds & OPEN:
        yield "mass of the fluid", record.run.series["mass_drift"] + record.run.series["mass_taken"]


def contacts(record):
    """Contacts act on all bodies, sides and walls with forces whose sum is zero (a fluid gets a share of impacts). They press sides
    and rub by Coulomb's law, on free-slip sides not at all. They do no work but that of what is driven; restitution sees the velocity
    before the kick, so work is that along the mean of both velocities of a step, up to that of a kick alone."""
    tables, laws = record.tables, record.tables["contacts"]
    if laws["resolver"] != "sffd" or not record.entries:
        return
    pulls = laws.get("cohesion") or laws.get("hamaker") or (record.is_wet and tables["coupling"].get("lubrication", True))
    friction = max([laws["friction"], *(pair["friction"] for pair in tables.get("material_pairs", []))])
    work = np.zeros(record.steps // record.every + 1)
    for name, side in record.sides.items():
        values, d = np.stack([values for _, values in record.sees(type="contact-force", side=name)] or [0 * work] * 3, axis=1), AXES.index(name[0])
        press = values[1:, d] * (1 if name.endswith("high") else -1)
        if not pulls:
            yield "pull at a side", np.minimum(press, 0)
            most = 0 if side["type"] == "free-slip" else friction * press
            yield "friction at a side", np.maximum(np.linalg.norm(np.delete(values[1:], d, axis=1), axis=1) - most, 0)
        if side["type"] == "moving":
            work += values @ side["velocity"] * share(side.get("over_time"), np.arange(len(work)) - 0.5)
    if record.is_wet:
        return
    for axis in AXES:
        yield "forces of all contacts", sum(values[1:] for _, values in record.sees(type="contact-force", axis=axis))
    for n, old, now in pairs(record) if not pulls and not record.walls_move else ():
        for what, load, motion in (("force", "contact_force", "velocity"), ("torque", "contact_torque", "angular_velocity")):
            mean = 0.5 * (old[motion] + now[motion])
            work[n] += np.nansum(now[load] * mean)
            for k in np.flatnonzero(~now["is_free"]):
                of_body = record.sees(type=f"contact-{what}", body=now["entry"][k]["name"])
                work[n] += sum(values[n] * mean[k, AXES.index(one["axis"])] for one, values in of_body)
        kicks = record.gravity(n - 0.5) + now.get("spring_force", 0 * now["velocity"]) / now["mass"][:, None]
        yield "work of contacts", max(work[n] - (now["mass"] @ kicks**2).sum(), 0)


def again(record):
    """Figures of the report and of series.csv, computed again."""
    is_rough = any(shape["type"] == "compound" for shape in record.tables["shapes"]) or any(entry.get("locked") for entry in record.entries.values())
    rough = 1e-6 if is_rough else 1
    for one in record.tables["quantities"]:
        found = of_bodies(record, one) if record.entries else None
        found = of_fluid(record, one) if found is None else found
        if found is not None:
            value = record.report["quantities"][one["name"]]
            error = np.inf if value is None else (value - found) / max(1, abs(found))
            yield one["type"], error * (rough if one["type"].startswith("energy") else 1)
    for n, rows in enumerate(record.bodies):
        free, series = {key: value[rows["is_free"]] for key, value in rows.items()}, record.run.series
        yield "energy.bodies", rough * (series["energy.bodies"][n] - kinetic(free))
        yield "momentum.bodies", [series[f"momentum.bodies.{axis}"][n] for axis in AXES] - free["mass"] @ free["velocity"]
    for field in record.run.fields if record.is_wet else ():
        reported = [record.run.series[f"momentum.fluid.{axis}"][field.step // record.every] for axis in AXES]
        yield "momentum.fluid", (reported - field["velocity"][is_fluid(field)].sum(axis=0)) / np.maximum(1, np.abs(reported))  # alike in all cells at the start


CHECKS = (newton, kinds_of_bodies, springs, momentum, heat, mass, contacts, again, samples)


def errors(record):
    """The largest error of each name."""
    found = collections.defaultdict(float)
    for check in CHECKS:
        for name, wrong in check(record):
            wrong = np.abs(np.asarray(wrong, float))
            found[name] = max(found[name], np.where(np.isnan(wrong), np.inf, wrong).max(initial=0))
    return found


def main():
    silt, first, count = sys.argv[1], *(int(n) for n in (sys.argv[2:] + ["0", "200"][len(sys.argv) - 2:]))
    checked, faults = collections.Counter(), 0
    for seed in range(first, first + count):
        tables = scene(seed)
        text = case_text("A balance", **tables)
        with tempfile.TemporaryDirectory(prefix="silt-balance-") as folder:
            run = result(silt, pathlib.Path(folder) / "case", text)[1]
            found = errors(Record(tables, run)) if run else {}
        checked.update(["scenes"] * (run is not None) + list(found))
        wrong = {name: float(f"{error:.2g}") for name, error in found.items() if not error <= TOLERANCE}
        if wrong:
            faults += 1
            print(f"seed {seed}: {wrong}\n{text}", flush=True)
    print(f"{count} scenes, {checked['scenes']} accepted and checked, momentum of {checked['momentum']}, heat of {checked['heat']}, {faults} with a fault")
    sys.exit(faults > 0 or checked["scenes"] == 0)


if __name__ == "__main__":
    main()
