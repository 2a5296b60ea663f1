"""Other ways to tell the scene of a case. Each takes the tables of a case and chance, and returns tables that mean the same."""
import numpy as np
from symmetry import AXES, quaternion, rotation

LAWS = ("restitution", "friction", "rolling_friction", "twisting_friction", "cohesion", "hamaker", "hamaker_gap")


def changed(tables, key, change):
    """The tables with the one of this name, or each entry of the list of this name, changed."""
    table = tables.get(key)
    return tables | {key: [change(entry) for entry in table] if isinstance(table, list) else change(table)} if table else tables


def with_sides(tables, change):
    boundary = {axis: both if both == "periodic" else [change(side) for side in both] for axis, both in tables["domain"]["boundary"].items()}
    return tables | dict(domain=tables["domain"] | dict(boundary=boundary))


# What ends with the same bits.

def over_time(tables, draw):
    """Half of a vector, multiplied by a function of time that is twice the one before, or 2."""
    def told(table, vector, key="over_time"):
        if not any(table.get(vector, [])) or table.get("type") == "velocity-inlet":
            return table
        before = table.get(key, {})
        function = dict(table=[[time, 2 * share] for time, share in before.get("table", [[0, 1]])])
        if "amplitude" in before:
            function |= dict(amplitude=2 * before["amplitude"], frequency=before["frequency"])
        return table | {vector: [x / 2 for x in table[vector]], key: function}
    if "coarsening" in tables:
        return tables
    if not tables.get("heat", {}).get("expansion"):
        tables = changed(tables, "gravity", lambda table: told(table, "acceleration"))
    if "superficial_velocity" not in tables.get("fluid", {}):
        tables = changed(tables, "fluid", lambda table: told(table, "body_force", "body_force_over_time"))
    return with_sides(tables, lambda side: told(side, "velocity"))


def materials(tables, draw):
    """Each pair of materials is told the law that was that of all, and all are told another one."""
    contacts = tables["contacts"]
    if "material_pairs" in tables:
        return tables
    known = LAWS[:6] if contacts["resolver"] == "sffd" else LAWS[:2]
    laws = dict.fromkeys(known, 0) | {key: contacts[key] for key in LAWS if key in contacts}
    pairs = [dict(between=list(pair)) | laws for pair in (("default", "default"), ("grit", "default"), ("grit", "grit"))]
    rest = {key: value for key, value in contacts.items() if key not in LAWS}
    tables = tables | dict(contacts=rest | dict(restitution=0.3, friction=0.2), material_pairs=pairs)
    for key in ("bodies", "fill", "walls"):
        tables = changed(tables, key, lambda entry: entry | dict(material=draw.choice(["default", "grit"])))
    return tables


def cut(tables, draw):
    """Other blocks; or levels of cells that are all fine, where nothing is against these."""
    domain, fluid = tables["domain"], tables.get("fluid", {})
    if "coarsening" in tables:
        return tables
    steady = not ("over_time" in str(tables) or "superficial_velocity" in fluid or "balance" in tables["run"])
    if fluid and steady and not any(n % 2 for n in domain["size"]):
        without = {key: value for key, value in domain.items() if key != "blocks"}
        return tables | dict(domain=without, coarsening=dict(levels=1, fine=[dict(box=[[0, 0, 0], domain["size"]])]))
    return tables | dict(domain=domain | dict(blocks=[draw.choice([8, 9, 12, 16]) for _ in AXES]))


def moving_at_rest(tables, draw):
    """Sides at rest are moving ones of no velocity, and walls at rest move as little."""
    tables = with_sides(tables, lambda side: side | dict(type="moving", velocity=[0, 0, 0]) if side["type"] == "no-slip" else side)
    return changed(tables, "walls", lambda wall: (dict(motion=dict(velocity=[0, 0, 0])) if wall["type"] == "mesh" else dict(angular_velocity=0)) | wall)


def defaults(tables, draw):
    """Keys are given the values that they have by default."""
    sweeps = dict(sweeps=16) if tables["contacts"]["resolver"] == "sffd" else {}
    for key, values in dict(contacts=dict(margin=1) | sweeps, bodies=dict(origin="shape", material="default", motion="free"),
                            coupling=dict(remap_tolerance=0.1, time="implicit"), fluid=dict(density=1),
                            heat=dict(temperature=0, initial=0, heat_capacity=1)).items():
        tables = changed(tables, key, lambda table: values | table)
    return tables


def names_and_sizes(tables, draw):
    """Each body has a name of its own; round shapes and tubes have a radius for a diameter, or the other way round."""
    held, number = {spring["body"] for spring in tables["springs"]}, iter(range(10**6))

    def told(table):
        table = dict(table)
        if "diameter" in table:
            table["radius"] = table.pop("diameter") / 2
        elif "radius" in table:
            table["diameter"] = 2 * table.pop("radius")
        if "parts" in table:
            table["parts"] = [told(part) for part in table["parts"]]
        return table
    tables = changed(tables, "bodies", lambda body: body if body.get("name") in held else body | dict(name=f"body {next(number)}"))
    return changed(changed(tables, "shapes", told), "walls", told)


# What ends alike to rounding.

def order(tables, draw):
    """Bodies and the corners of polyhedra are listed in another order."""
    tables = tables | dict(bodies=draw.sample(tables["bodies"], len(tables["bodies"])))
    return changed(tables, "shapes", lambda shape: shape | dict(vertices=draw.sample(shape["vertices"], len(shape["vertices"]))) if "vertices" in shape else shape)


def coefficients(tables, draw):
    """Viscosity and thermal diffusivity themselves; two relaxation times that are equal for one (levels limit the odd one of "trt")."""
    if "fluid" not in tables:
        return tables
    fluid = dict(tables["fluid"])
    tau = fluid.pop("relaxation_time")
    if fluid["collision"] == "bgk" and "coarsening" not in tables:
        fluid |= dict(collision="trt", magic=(tau - 0.5)**2)
    fluid[draw.choice(["kinematic_viscosity", "dynamic_viscosity"])] = nu = (tau - 0.5) / 3
    return changed(tables | dict(fluid=fluid), "heat", lambda heat: {key: value for key, value in heat.items() if key != "prandtl"} |
                   dict(thermal_diffusivity=nu / heat["prandtl"]))


def shapes(tables, draw):
    """A box is the polyhedron of its corners; a round shape is a compound of one part (but a sphere, which need not be mapped when it
    turns); rotations are quaternions."""
    def told(shape):
        if shape["type"] == "box":
            a, b, c = (edge / 2 for edge in shape["edges"])
            return dict(name=shape["name"], type="polyhedron", vertices=[[x, y, z] for x in (-a, a) for y in (b, -b) for z in (-c, c)])
        if shape["type"] in ("capsule", "ellipsoid"):
            return dict(name=shape["name"], type="compound", parts=[{key: value for key, value in shape.items() if key != "name"}])
        return shape
    tables = changed(tables, "bodies", lambda body: body | dict(orientation=quaternion(rotation(body.get("orientation"))).tolist()))
    return changed(tables, "shapes", told)


def motions(tables, draw):
    """A fixed body is of prescribed motion at rest; one of prescribed motion has it from a table of motion."""
    def told(body):
        if body.get("motion") == "fixed":
            return body | dict(motion="prescribed", velocity=[0, 0, 0])
        if body.get("motion") != "prescribed":
            return body
        w = np.array(body.get("angular_velocity", [0, 0, 0]))
        motion = dict(velocity=body["velocity"]) | (dict(angular_velocity=float(np.linalg.norm(w)), axis=w.tolist()) if w.any() else {})
        return {key: value for key, value in body.items() if key not in ("velocity", "angular_velocity")} | dict(motion=motion)
    return changed(tables, "bodies", told)


def springs_and_tubes(tables, draw):
    """A spring is two of half the stiffness; a tube's axis is a direction through another of its points, a wall turns the other way about
    the opposite axis."""
    def told(wall):
        if wall["type"] == "tube":
            axis = np.eye(3)[AXES.index(wall["axis"])]
            return wall | dict(axis=(2 * axis).tolist(), point=(wall["point"] + 3 * axis).tolist())
        motion = wall.get("motion", {})
        return wall | dict(motion=motion | dict(axis=[0, 0, -1], angular_velocity=-motion["angular_velocity"])) if "axis" in motion else wall
    half = [spring | dict(stiffness=spring["stiffness"] / 2, damping=spring["damping"] / 2) for spring in tables["springs"]]
    return changed(tables | dict(springs=half * 2), "walls", told)


SAME_BITS = [over_time, materials, cut, moving_at_rest, defaults, names_and_sizes]
ALIKE = [order, coefficients, shapes, motions, springs_and_tubes]
