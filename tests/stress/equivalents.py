#!/usr/bin/python3
"""equivalents SILT [FIRST [COUNT]]: scenes at random, each beside cases that mean the same, one a seed.

What is wrong alike in all directions and on all ranks is not seen by combinations.py, symmetries.py and units.py. Here another case
describes the same physics in another way:
  - doubled: a periodic scene and the same behind it, in a domain twice as long: images, wraps, means over the domain;
  - mirrored: a scene with a free-slip side and its mirror image behind that side;
  - the same bits: functions of time, materials, blocks, names told in another way (retold.py);
  - alike: bodies in another order, other shapes of the same form, other coefficients (retold.py).
Bodies, loads, fields and counts must be those of the scene, in both copies: in all bits, or to rounding in double precision. The scenes and
the tolerance are those of symmetries.py; but where several contacts of a pair resist rolling or twisting, which is found in turns with
sliding (method-bodies.md), the order of the contacts is seen to 1e-6.
"""
import copy
import pathlib
import random
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import silt_runs  # noqa: E402, F401, I001 (the path)
from silt_results.surfaces import rotations  # noqa: E402
from case_text import case_text  # noqa: E402
from copies import Same, doubled, mirrored  # noqa: E402
from random_scene import STONE, result  # noqa: E402
from retold import ALIKE, SAME_BITS  # noqa: E402
from symmetries import AXIAL, COUNTS, POLAR, scene_of, tolerance  # noqa: E402


def retold(tellings):
    def told(tables, draw):
        found = tables
        for tell in tellings:
            found = tell(found, draw)
        return tables, Same(tables, found)
    return told


WAYS = dict(doubled=doubled, mirrored=mirrored, same_bits=retold(SAME_BITS), alike=retold(ALIKE))


class Partners:
    """The bodies of a copy in the other run, found by their places when they come."""

    def __init__(self, way, copy_of_scene):
        self.size, self.copy, self.partner, self.first = way.size, copy_of_scene, {}, {}

    def differences(self, now, there):
        """Yields by how much bodies are not where and as they should be."""
        row_of = {i: row for row, i in enumerate(there["id"].tolist())}
        turned, other_turned = (rotations(of["orientation"]) for of in (now, there))
        for row, i in enumerate(now["id"].tolist()):
            ways = np.abs(self.copy.points(now["position"][row]) - there["position"])
            if i not in self.partner:
                self.partner[i] = int(there["id"][np.argmin(ways.max(axis=1))])
            if self.partner[i] not in row_of:
                yield "bodies that left", np.inf
                continue
            other = row_of[self.partner[i]]
            way, turn = ways[other], self.copy.matrix @ turned[row] @ self.copy.matrix.T
            yield "position", np.abs(way - self.size * np.round(way / self.size)).max()  # across periodic sides
            first = self.first.setdefault(i, (turn, other_turned[other]))
            yield "rotation", np.abs(turn @ first[0].T - other_turned[other] @ first[1].T).max()
            for name in set(now) & set(there) & {*AXIAL, *POLAR}:
                expected = (self.copy.det if name in AXIAL else 1) * self.copy.vectors(now[name][row])
                yield name, np.abs(np.nan_to_num(expected) - np.nan_to_num(there[name][other])).max()


def differences_of_bodies(way, before, after):
    if list(len(way.copies) * np.array(before.count)) != list(after.count):
        yield "number of bodies", np.inf
        return
    copies = [Partners(way, one) for one in way.copies]
    for t in range(len(after.time)):
        for one in copies:
            yield from one.differences(before.at(t), after.at(t))
    found = [partner for one in copies for partner in one.partner.values()]
    yield "bodies twice", len(found) - len(set(found))


def differences(way, tables, before, after):
    """Yields by how much results are not those of the scene: name, largest difference."""
    for name in COUNTS:
        yield name, abs(len(way.copies) * (before.report.get(name) or 0) - (after.report.get(name) or 0))
    if tables["bodies"]:
        yield from differences_of_bodies(way, before.bodies, after.bodies)
    for quantity in tables["quantities"]:
        old, new = (of.report["quantities"][quantity["name"]] for of in (before, after))
        name = " ".join(str(quantity[key]) for key in ("type", "side", "wall", "axis") if key in quantity)
        yield name, abs(way.quantity(quantity, old or 0) - (new or 0))
    if "fluid" in tables:
        for name in before.fields[-1].names:
            yield name, np.abs(way.field(before.fields[-1][name]) - after.fields[-1][name]).max()


def compare(silt, tables, way, bits):
    """Returns the largest differences by name (None: both cases are refused or stopped), and what is to be told of them."""
    texts = case_text("A scene", **tables), case_text("The same", **way.told)
    with tempfile.TemporaryDirectory(prefix="silt-equivalent-") as folder:
        (code, before, said), (other_code, after, also_said) = (
            result(silt, pathlib.Path(folder) / name, text, again=way.again) for name, text in zip(("scene", "same"), texts))
        told = "\n".join([said, also_said, *texts])
        if code != other_code:
            return {"exit code": abs(code - other_code)}, told
        if before is None:
            return None, told
        found = {"state": np.inf} if bits and before.report["state_hash"] != after.report["state_hash"] else {}
        for name, value in differences(way, tables, before, after):
            found[name] = max(found.get(name, 0), value if value == value else np.inf)
        return found, told


def limit(tables, bits):
    turns = {"rolling_friction", "twisting_friction"} & set(tables["contacts"])
    return 0 if bits else max(tolerance(tables), 1e-5 if turns else 0)


def main():
    silt, first, count = sys.argv[1], *(int(n) for n in (sys.argv[2:] + ["0", "200"][len(sys.argv) - 2:]))
    compared = faults = 0
    for seed in range(first, first + count):
        for name, tell in WAYS.items():
            tables = scene_of(seed)
            bits = name == "same_bits"
            if bits and "fluid" in tables and seed % 2:
                tables["fluid"]["precision"] = "single"
            if not (told := tell(copy.deepcopy(tables), random.Random(f"{name} {seed}"))):
                continue
            found, texts = compare(silt, *told, bits)
            compared += found is not None
            wrong = {key: float(f"{value:.2g}") for key, value in (found or {}).items() if value > limit(tables, bits)}
            if wrong:
                faults += 1
                print(f"seed {seed}, {name}: {wrong}\n{texts}", flush=True)
    print(f"{count} scenes, {compared} pairs of cases compared, {faults} with a fault")
    sys.exit(faults > 0 or compared == 0)


if __name__ == "__main__":
    main()
