#!/usr/bin/python3
"""units SILT [FIRST [COUNT]]: scenes put together at random, each in lattice units and in SI units, one a seed.

A cell, a step, the density and the heat capacity of the fluid are powers of two in SI units, so every conversion is exact: both
cases must end with the same bits, and each number that one writes must be that of the other times its unit. A key or a
column that is read or written without its unit, or with another one, is seen.
"""
import pathlib
import re
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import silt_runs  # noqa: E402, F401, I001 (the path)
from case_text import case_text, si  # noqa: E402
from random_scene import Scene, result  # noqa: E402

BASE = dict(m=2.**-11, s=2.**-13, kg=2.**10 * 2.**-33, K=1.0)  # a fluid of 1024 kg/m3
CAPACITY = 2.**12                                               # of the fluid, J/(kg K)
DERIVED = {"N": "kg m/s2", "Pa": "kg/m/s2", "W": "kg m2/s3", "J": "kg m2/s2", "rad": "1"}
NUMBERS = ("", "1", "periods", "quaternion w, x, y, z")
UNITS = {  # of the keys of a case, by what they mean; keys of the same name in several tables have the same
    "m": "size position positions ends length spacing shift gap margin distance radius diameter diameters edges vertices point points "
         "line box smallest largest amplitude hamaker_gap lubrication_min_gap at",
    "m/s": "velocity superficial_velocity swirl noise", "m/s2": "acceleration body_force", "1/s": "angular_velocity frequency", "s": "time from",
    "kg/m3": "density", "Pa": "pressure", "m2/s": "kinematic_viscosity thermal_diffusivity", "N": "cohesion", "J": "hamaker",
    "N/m": "stiffness", "N s/m": "damping", "K": "temperature", "K/m": "mean_gradient", "heat/m2/s": "heat_flux", "heat/s": "heat_source",
    "heat/kg/K": "heat_capacity", "1/K": "expansion"}
UNIT_OF = {key: unit for unit, keys in UNITS.items() for key in keys.split()}


def scale(unit):
    """The value of one lattice unit in SI units."""
    if unit in NUMBERS:
        return 1.0
    found = 1.0
    for n, part in enumerate(unit.replace("^", "").split("/")):
        for factor in part.strip("() ").split():
            form = re.fullmatch(r"([A-Za-z]+|1)(\d*)", factor)
            if not form:
                raise SystemExit(f"no unit: {unit}")
            name, power = form.groups()
            if name == "heat":
                one = BASE["kg"] * CAPACITY
            elif name in BASE or name == "1":
                one = BASE.get(name, 1.0)
            else:
                one = scale(DERIVED[name])
            found *= one ** (int(power or 1) * (1 if n == 0 else -1))
    return found


def times(value, factor):
    return [times(v, factor) for v in value] if isinstance(value, list) else value * factor


def in_si(table):
    """A table of a case in SI units."""
    found = dict(table)
    for key, value in table.items():
        if isinstance(value, dict) and key != "orientation":
            found[key] = in_si(value)
        elif isinstance(value, list) and any(isinstance(entry, dict) for entry in value):
            found[key] = [in_si(entry) if isinstance(entry, dict) else entry for entry in value]
        elif key == "table":  # of a share over time
            found[key] = [[time * BASE["s"], share] for time, share in value]
        elif key == "file":
            found["scale"] = BASE["m"]
        elif key in UNIT_OF and not isinstance(value, (str, bool)) and not (key == "amplitude" and not isinstance(value, list)):
            found[key] = times(value, scale(UNIT_OF[key]))
    return found


def tables_in_si(tables):
    found = in_si(tables)
    found["fluid"]["density"] = scale("kg/m3")
    if "heat" in found:
        found["heat"]["heat_capacity"] = CAPACITY
    return found


def quantities(tables):
    """Figures of the report of every type that the scene has a value for."""
    names = [body.get("name", body["shape"]) for key in ("bodies", "fill") for body in tables.get(key, [])]
    bearers = [dict(side=f"{axis}-{end}") for axis, sides in tables["domain"]["boundary"].items() if sides != "periodic"
               for end, side in zip(("low", "high"), sides) if side["type"] in ("no-slip", "moving")][:1]
    bearers += [dict(wall=wall["name"]) for wall in tables.get("walls", [])] + [dict(body=name) for name in names[:1]]
    loads = [dict(type=f"{of}-{what}") | bearer for bearer in bearers for of in ("fluid", "contact") for what in ("force", "torque")
             if what == "force" or "side" not in bearer]
    bodies = ("max-speed mean-height height-deviation drift displacement mean-velocity largest-angular-velocity body-temperature "
              "packing-fraction body-count least-velocity angular-velocity-deviation max-penetration")
    fluid = "kinetic-energy dissipation superficial-velocity body-force mean-temperature stored-heat heat-flow"
    found = loads + [dict(type=name) for name in (bodies.split() if names else []) + fluid.split()]
    found += [dict(type="flow-rate", axis="x", at=tables["domain"]["size"][0] / 4), dict(type="outflow-rate", time=4),
              dict(type="viscous-stress", component="xy"), dict(type="pressure-drop", axis="y", at=[8, 20])]
    found += [dict(type=f"wall-{what}", time=8) | bearer for bearer in bearers if "wall" in bearer for what in ("torque", "power")]
    found = [one for one in found if "heat" in tables or not re.search("heat|temperature", one["type"])]
    return [dict(name=f"q{n}") | one for n, one in enumerate(found)]


def differences(lattice, physical):
    """Yields what is not the same but for its unit."""
    if lattice.report["state_hash"] != physical.report["state_hash"]:
        yield "state"
    of_heat = {"heat-flow": "heat/s", "stored-heat": "heat"}
    types = physical.report["quantity_types"]
    compared = [(f"{types[name]['type']} in {types[name]['unit']}", lattice.report["quantities"][name], value,
                 of_heat.get(types[name]["type"], types[name]["unit"])) for name, value in physical.report["quantities"].items()]
    if lattice.bodies:
        compared += [(f"bodies.h5: {name}", values, physical.bodies.columns[name], physical.bodies.unit(name))
                     for name, values in lattice.bodies.columns.items()]
    if lattice.fields:
        compared += [(f"fields: {name}", lattice.fields[-1][name], physical.fields[-1][name], physical.fields[-1].unit(name))
                     for name in lattice.fields[-1].names]
    for name, here, there, unit in compared:
        if here is None or there is None:
            if here is not there:
                yield name
        elif not np.array_equal(np.asarray(here) * scale(unit), np.asarray(there), equal_nan=np.asarray(there).dtype.kind == "f"):
            yield f"{name}: {here} and {there}"


def scene_of(seed):
    """The tables of a scene, with all that it can write; None if it has no fluid: the unit of mass is then no power of two."""
    tables = Scene(seed).tables()
    if "fluid" not in tables:
        return None
    for n, wall in enumerate(tables.get("walls", [])):
        wall["name"] = f"wall {n}"
    fields = ["velocity", "density", "pressure", "shear-rate", "vorticity", *(["temperature"] if "heat" in tables else [])]
    tables["output"] |= dict(bodies=dict(every=16, contacts=True),
                             fields=dict(every=tables["run"]["steps"], precision="double", quantities=fields))
    return tables | dict(quantities=quantities(tables))


def main():
    silt, first, count = sys.argv[1], *(int(n) for n in (sys.argv[2:] + ["0", "200"][len(sys.argv) - 2:]))
    compared = faults = 0
    for seed in range(first, first + count):
        if not (tables := scene_of(seed)):
            continue
        with tempfile.TemporaryDirectory(prefix="silt-units-") as folder:
            texts = case_text("Units", **tables), case_text("Units", units=si(BASE["m"], BASE["s"]), **tables_in_si(tables))
            (code, lattice, said), (other, physical, also_said) = (
                result(silt, pathlib.Path(folder) / name, text) for name, text in zip(("lattice", "si"), texts))
            wrong = [f"exit codes {code} and {other}"] if code != other else list(differences(lattice, physical)) if lattice else []
            compared += lattice is not None and physical is not None
        if wrong:
            faults += 1
            print(f"seed {seed}:", *wrong, said, also_said, *texts, sep="\n", flush=True)
    print(f"{count} scenes, {compared} accepted and compared, {faults} with a fault")
    sys.exit(faults > 0 or compared == 0)


if __name__ == "__main__":
    main()
