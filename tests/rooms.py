#!/usr/bin/python3
"""rooms.py ROOT: the rooms include one another only downwards; an arrow up, a circle and an unknown room are found."""
import pathlib
import subprocess
import sys
import tempfile

root = pathlib.Path(sys.argv[1])


def rooms(tree):
    done = subprocess.run([root / "scripts/rooms", tree], capture_output=True, text=True)
    return done.returncode, done.stderr


def told(files):
    with tempfile.TemporaryDirectory() as folder:
        for name, include in files.items():
            file = pathlib.Path(folder) / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(f'#include "{include}"\n')
        return rooms(folder)


assert rooms(root) == (0, ""), rooms(root)
assert told({"coupler/flow.cpp": "lbm/fluid.hpp"}) == (0, "")
code, text = told({"rigid/shapes/shape.hpp": "rigid/bodies/body_set.hpp"})
assert code == 1 and "rigid/shapes/shape.hpp:1: rigid/shapes is not above rigid/bodies" in text, text
code, text = told({"silt/case/a.hpp": "silt/run/b.hpp", "silt/run/b.hpp": "silt/case/a.hpp"})
assert code == 1 and "a circle: silt/case -> silt/run -> silt/case" in text, text
code, text = told({"coupler/attic/a.hpp": "lbm/b.hpp"})
assert code == 1 and "the room coupler/attic has no floor" in text, text
code, text = told({})
assert code == 1 and "no sources found" in text, text
