#!/usr/bin/python3
"""symmetries SILT [FIRST [COUNT]]: scenes at random, turned, mirrored and shifted, one a seed.

No formula prefers an axis, a direction or a place. So a scene whose axes are permuted and mirrored, and which is shifted by whole
cells along periodic axes, must end as the scene itself does, turned alike, to rounding in double precision: bodies, loads, fields,
counts. A wrong formula is seen although it is the same on all ranks; one that is wrong alike in all directions is not. A fourth of the
scenes go on as another case (`initial.from`). Mass and momentum must stay where nothing changes them. The scenes are those
of combinations.py, but for what is a matter of axes or places by design:
  - a random fill draws its places in the order of x, y, z: its bodies are listed here, near one another (crowd.py);
  - noise is a function of the cell: there is none;
  - boxes (outflow, fills, fine cells) and tubes must not cross sides: such scenes are not shifted across them;
  - regions of levels have their faces on planes of whole tiles: shifts are by these;
  - the frames of capsules, cylinders and overlapping parts, and lines through meshes: symmetry.py and tolerance();
  - single precision rounds at 1e-7, which contacts make larger: all is double.
"""
import itertools
import pathlib
import random
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import silt_runs  # noqa: E402, F401, I001 (the path)
from silt_results.surfaces import rotations  # noqa: E402
from case_text import case_text  # noqa: E402
from crowd import Crowd  # noqa: E402
from random_scene import STONE, Scene, result  # noqa: E402
from symmetry import AXES, Symmetry  # noqa: E402

AXIAL = ("angular_velocity", "torque", "contact_torque", "spring_torque")
POLAR = ("velocity", "force", "contact_force", "spring_force", "buoyancy")
COUNTS = ("bodies", "bodies_arrived", "bodies_refused", "bodies_left", "fluid_cells", "links", "covered", "uncovered", "contacts",
          "lubricated_contacts", "unlubricated_contacts")


def quantities(tables):
    """Forces on sides, walls and all bodies, and heat."""
    bearers = [dict(side=f"{axis}-{end}") for axis, sides in tables["domain"]["boundary"].items() if sides != "periodic"
               for end, side in zip(("low", "high"), sides) if side["type"] in ("no-slip", "moving")]
    fluid = [dict(type="fluid-force", axis=axis) | bearer for bearer in bearers for axis in AXES]
    walls = [dict(type=f"fluid-{what}", axis=axis, wall=wall["name"]) for wall in tables.get("walls", []) for what in ("force", "torque") for axis in AXES]
    run = dict(over=[0, tables["run"]["steps"]])  # what contacts do changes from step to step
    contacts = [dict(type="contact-force", axis=axis) | run | of for of in [*bearers, *(dict(wall=wall["name"]) for wall in tables.get("walls", [])), {}]
                for axis in AXES] if tables["bodies"] else []
    contacts += [one | dict(type="contact-torque") for one in contacts if "side" not in one]
    of_all = ("heat-flow", "mean-temperature", "stored-heat")[0 if tables["bodies"] else 1:]
    heat = [dict(type="heat-flow") | bearer for bearer in bearers] + [dict(type=name) for name in of_all]
    found = (fluid + walls if "fluid" in tables else []) + contacts + (heat if "heat" in tables else [])
    return [dict(name=f"q{n}") | quantity for n, quantity in enumerate(found)]


def is_in_vessel(tables):
    return any(wall.get("solid") == "outside" for wall in tables.get("walls", []))


def with_more(tables, draw):
    """The tables with what only scenes of listed bodies can have: a vessel around them, and bodies of two materials."""
    size = tables["domain"]["size"]
    if not tables.get("walls") and draw.random() < 0.15:
        tables["walls"] = [dict(type="mesh", file="stone.ply", solid="outside", scale=min(size) / 7.5, position=[n / 2 + draw.uniform(-0.2, 0.2) for n in size])]
    if draw.random() < 0.3:
        tables["material_pairs"] = [dict(between=["grit", "default"], friction=0.2), dict(between=["grit", "grit"], friction=0.6, restitution=0.3)]
        for key in ("bodies", "fill"):
            tables[key] = [entry | dict(material=draw.choice(["default", "grit"])) for entry in tables.get(key, [])]
    return tables


def scene_of(seed):
    """The tables of a scene without what is not symmetric."""
    tables = with_more(Scene(seed).tables(), random.Random(f"more {seed}"))
    crowd = Crowd(seed, tables)
    for n, wall in enumerate(tables.get("walls", [])):
        wall["name"] = f"wall {n}"
    tables["bodies"], tables["fill"] = crowd.bodies(), list(crowd.fills())
    places = {body.get("name"): body["position"] for body in tables["bodies"]}
    tables["springs"] = [spring | dict(ends=[places[spring["body"]], spring["ends"][1]]) for spring in tables.get("springs", [])
                         if spring["body"] in places]
    steps = tables["run"]["steps"]
    tables["output"] = dict(bodies=dict(every=steps // 4, contacts=True), checkpoint=dict(every=steps))
    if "fluid" in tables:
        tables["fluid"]["precision"] = "double"
        tables["fluid"].get("initial", {}).pop("noise", None)
        fields = ["velocity", "density", *(["temperature"] if "heat" in tables else [])]
        tables["output"]["fields"] = dict(every=steps, quantities=fields, precision="double")
    return tables | dict(quantities=quantities(tables))


def symmetry_of(seed, tables):
    """A symmetry at random that leaves the scene a case: boxes and tubes are not shifted across periodic sides."""
    draw = random.Random(f"symmetry {seed}")
    order = draw.choice(list(itertools.permutations(range(3))))
    signs = [draw.choice([1, -1]) for _ in AXES]
    unit = 4 * 2 ** tables["coarsening"]["levels"] if "coarsening" in tables else 1
    tubes = {wall["axis"] for wall in tables.get("walls", []) if wall["type"] == "tube"}
    boxes = tables["fill"] or tables.get("outflow") or tables.get("coarsening", {}).get("fine") or is_in_vessel(tables)
    shift = [0, 0, 0]
    for a, d in enumerate(order):
        if tables["domain"]["boundary"][AXES[d]] == "periodic" and not boxes and tubes <= {AXES[d]}:
            shift[a] = unit * draw.randrange(tables["domain"]["size"][d] // unit)
    return Symmetry(tables["domain"]["size"], order, signs, shift)


def continued(tables):
    """The tables of a case, a more viscous one, that begins with the end of another one: a kind of bodies is named once."""
    kept = ("shape", "name", "material", "density", "motion", "locked", "temperature", "heat_capacity", "heat_source")
    kinds = {body.get("name", body["shape"]): {key: body[key] for key in kept if key in body} for body in tables["bodies"]}
    fluid = {key: value for key, value in tables["fluid"].items() if key not in ("initial", "quiet_start")}
    fluid["relaxation_time"] *= 1.1
    return tables | dict(fluid=fluid, bodies=list(kinds.values()))


def turns(bodies):
    """Yields the rotation of each body since it is there, at each time."""
    first = {}
    for t in range(len(bodies.time)):
        now = bodies.at(t)
        turned = rotations(now["orientation"])
        yield np.array([turn @ first.setdefault(i, turn).T for i, turn in zip(now["id"], turned)]).reshape(-1, 3, 3)


def differences_of_bodies(symmetry, before, after):
    if list(before.count) != list(after.count) or not np.array_equal(before.columns["id"], after.columns["id"]):
        yield "ids", np.inf
        return
    way = symmetry.points(before.columns["position"]) - after.columns["position"]
    yield "position", np.abs(way - symmetry.size * np.round(way / symmetry.size)).max(initial=0)  # across periodic sides
    for old, new in zip(turns(before), turns(after)):
        yield "rotation", np.abs(symmetry.matrix @ old @ symmetry.matrix.T - new).max(initial=0)
    for name in set(before.columns) & {*AXIAL, *POLAR}:
        turned = (symmetry.det if name in AXIAL else 1) * symmetry.vectors(before.columns[name])
        yield name, np.abs(np.nan_to_num(turned) - np.nan_to_num(after.columns[name])).max(initial=0)


def differences(symmetry, tables, before, after):
    """Yields by how much results are not the turned ones: name, largest difference."""
    for name in COUNTS:
        yield name, abs((before.report.get(name) or 0) - (after.report.get(name) or 0))
    if tables["bodies"]:
        yield from differences_of_bodies(symmetry, before.bodies, after.bodies)
    for quantity in tables["quantities"]:
        old, new = (of.report["quantities"][quantity["name"]] for of in (before, after))
        name = " ".join(str(quantity[key]) for key in ("type", "side", "wall", "axis") if key in quantity)
        yield name, abs(symmetry.quantity(quantity)[1] * (old or 0) - (new or 0))
    if "fluid" in tables:
        for name in before.fields[-1].names:
            yield name, np.abs(symmetry.cells(before.fields[-1][name]) - after.fields[-1][name]).max()


def changes(tables, report):
    """Yields what has to stay as it is, and by how much it did not: mass in a closed box without walls that move (method-walls.md), momentum
    where no force is from outside; and forces of contacts on all bodies, sides and walls together, without a fluid, which has a share of
    impacts, and without free-slip sides, which do not tell what they bear."""
    kinds = {side["type"] for sides in tables["domain"]["boundary"].values() if sides != "periodic" for side in sides}
    moving = any("motion" in wall for wall in tables.get("walls", []))
    if "fluid" in tables and not moving and not kinds & {"velocity-inlet", "pressure-outlet"}:
        yield "mass", abs(report["mass_drift"] + report["mass_taken"])
    if report["momentum_drift"] is not None and tables.get("coupling", {}).get("force", "exact") == "exact":
        yield "momentum", report["momentum_drift"]
    if "fluid" not in tables and "free-slip" not in kinds and tables["contacts"]["resolver"] == "sffd":
        for axis in AXES:
            yield f"contact-force of all {axis}", abs(sum(report["quantities"][q["name"]] or 0 for q in tables["quantities"]
                                                          if q["type"] == "contact-force" and q["axis"] == axis))


def compare(silt, tables, symmetry, also_continued=False):
    """Returns the largest differences of a scene and its turned one by name (None: both are refused or stopped), and messages."""
    found = {}
    with tempfile.TemporaryDirectory(prefix="silt-symmetry-") as folder:
        for number, stage in enumerate([tables, continued(tables)] if also_continued else [tables]):
            runs = []
            for name, its, mesh in (("before", stage, STONE), ("after", symmetry.scene(stage), symmetry.mesh(*STONE))):
                initial = dict(initial={"from": f"../{name}0/out"}) if number else {}
                runs.append(result(silt, pathlib.Path(folder) / f"{name}{number}", case_text("A symmetry", **(its | initial)), mesh))
            (code, before, said), (other_code, after, also_said) = runs
            if code != other_code:
                return {"exit code": abs(code - other_code)}, said + also_said
            if before is None:
                return found or None, said
            for name, value in [*differences(symmetry, stage, before, after), *changes(stage, before.report), *changes(stage, after.report)]:
                found[name] = max(found.get(name, 0), value if value == value else np.inf)
    return found, ""


def tolerance(tables):
    """Rounding in double precision after some tens of steps, contacts included: 2e-11 at most in 110 scenes. Lines of cells meet meshes in
    planes across one axis each, with corners and cuts rounded to 2^-24 (method-coupling.md, (51) and (52)): 1e-7 at most."""
    meshes = [*tables["shapes"], *tables.get("walls", [])]
    return 1e-6 if any(mesh["type"] == "mesh" for mesh in meshes) else 1e-9


def main():
    silt, first, count = sys.argv[1], *(int(n) for n in (sys.argv[2:] + ["0", "200"][len(sys.argv) - 2:]))
    compared, faults = 0, 0
    for seed in range(first, first + count):
        tables = scene_of(seed)
        symmetry = symmetry_of(seed, tables)
        can_continue = "fluid" in tables and not any(tables.get(key) for key in ("springs", "fill", "outflow", "walls"))
        found, text = compare(silt, tables, symmetry, can_continue and seed % 4 == 0)
        compared += found is not None
        wrong = {name: float(f"{value:.2g}") for name, value in (found or {}).items() if value > tolerance(tables)}
        if wrong:
            faults += 1
            print(f"seed {seed}, axes {symmetry.order}, signs {list(symmetry.signs)}, shift {list(symmetry.shift)}: {wrong}\n"
                  f"{text}{case_text('A symmetry', **tables)}", flush=True)
    print(f"{count} scenes, {compared} accepted and compared, {faults} with a fault")
    sys.exit(faults > 0 or compared == 0)


if __name__ == "__main__":
    main()
