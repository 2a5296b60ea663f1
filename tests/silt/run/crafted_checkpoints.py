#!/usr/bin/python3
"""Checkpoints that no run wrote, with every checksum right, and such with damaged metadata: refused by name, at once,
without a crash. crafted_checkpoints.py SILT [TEST]"""
import pathlib
import sys
import unittest

import h5py
import numpy as np

from silt_test import CASE, ROOT, SiltTest

sys.path.append(str(ROOT / "tests/stress"))
import crafted  # noqa: E402

TOUCHING = CASE.replace("[[6, 8, 8], [18, 8, 9]]", "[[6, 8, 2.5], [11, 8, 2.5]]")  # each other and the floor


def put(name, values):
    """Replaces a dataset, of its type, by values with a right checksum."""
    return lambda f: crafted.put(f, name, np.array(values, f[name].dtype))


def change(name, index, value):
    def craft(f):
        values = f[name][:]
        values[index] = value
        crafted.put(f, name, values)
    return craft


def declare(name, shape):
    """A dataset of this shape that has no byte in the file."""
    def craft(f):
        kind = f[name].dtype
        del f[name]
        f.create_dataset(name, shape=shape, dtype=kind).attrs["checksum"] = np.uint64(0)
    return craft


def attribute(name, value):
    return lambda f: f["state"].attrs.__setitem__(name, value)


def without(name):
    return lambda f: f.__delitem__(name)


def link(name, to=None):
    """To a named pipe beside the file, which who opens it for reading waits for, or to another place in it."""
    def craft(f):
        del f[name]
        f[name] = h5py.SoftLink(to) if to else h5py.ExternalLink(crafted.pipe_beside(f), "/x")
    return craft


def wrapping_counts(f):
    rows = len(f["impulses/partner"])
    put("bodies/impulse_count", [2**63, 2**63 + rows])(f)


CRAFTED = {
    "/bodies/shape, row 0 (body 1): it is 1000, and must be from 0 to 0": change("bodies/shape", 0, 1000),
    "/bodies/motion, row 0 (body 1): it is 200, and must be from 0 to 2": change("bodies/motion", 0, 200),
    "/bodies/mass, row 0 (body 1): it is inf": change("bodies/mass", 0, np.inf),
    "/bodies/position, row 0 (body 1): it is nan": change("bodies/position", (0, 1), np.nan),
    "/bodies/inertia_B, row 1 (body 2): it is no tensor": change("bodies/inertia_B", 1, 0),
    "/bodies/mapping_position, row 1 (body 2): it is inf": change("bodies/mapping_position", (1, 0), np.inf),
    "/bodies/mapping_orientation, row 1 (body 2): it is of the square 0": change("bodies/mapping_orientation", 1, 0),
    "/impulses/impulse, row 0 (body 1): it is nan": change("impulses/impulse", (0, 2), np.nan),
    "/impulses/partner, row 0 (body 1): it is 17, and must be another body or a wall": change("impulses/partner", 0, 17),
    "/impulses/image, row 1 (body 1): it is 5, and must be from -1 to 1": change("impulses/image", (1, 0), 5),
    "/bodies/id, row 1 (body 3): it is 3, and must be from 1 to 2": put("bodies/id", [1, 3]),
    "/cells/populations, population 4 of the cell [1, 2, 3]: it is nan": change("cells/populations", (4, 3, 2, 1), np.nan),
    "body 1 comes after body 1": put("bodies/id", [1, 1]),
    "/bodies/id has another": put("bodies/id", 1),
    "do not fit together": wrapping_counts,
    "/bodies/mass declares more values than the file": declare("bodies/mass", (2**40,)),
    "/cells/populations declares more values than the file": declare("cells/populations", (19, 2**14, 2**14, 2**14)),
    "of another lattice": put("cells/populations", np.zeros((19, 2, 2, 2))),
    "has no dataset /bodies": without("bodies"),
    "/state/next_id is -3, and must be from 1": attribute("next_id", np.int64(-3)),
    "/state/contacts is -1, and must be from 0": attribute("contacts", np.int64(-1)),
    "/state/fluid_speed is nan, and must be a number": attribute("fluid_speed", np.nan),
    "it is of step 24, by its name of step 25": attribute("step", np.int64(24)),
    "/bodies/id is a link to another place or file": link("bodies/id"),
    "/state is a link to another place or file": link("state"),
    "/cells/populations is a link to another place or file": link("cells/populations", "/bodies/id"),
    "/bodies/mass has its values in another file": lambda f: crafted.piped(f, "bodies/mass", None),
}


class Checkpoints(SiltTest):
    def setUp(self):
        super().setUp()
        self.write(TOUCHING)
        self.silt("run", self.case, "--steps", 25, "--set", "output.fields.every=0")
        self.path = self.out / "checkpoint_000000000025.h5"
        self.good = self.path.read_bytes()

    def test_every_one_is_refused(self):
        for i, (text, craft) in enumerate(CRAFTED.items()):
            with self.subTest(text):
                self.path.write_bytes(self.good)
                with h5py.File(self.path, "r+") as f:
                    craft(f)
                errors = self.silt("resume", self.case, "--set", "run.steps=30", ranks=1 + (i % 4 == 0), code=2).stderr
                self.assertIn("cannot use the checkpoint " + str(self.path), errors)
                self.assertIn(text, errors)
                self.assertIn("start the case again", errors)
        self.path.write_bytes(self.good)
        with h5py.File(self.path, "r+") as f:  # and the crafting itself does no harm
            change("bodies/position", (0, 1), f["bodies/position"][0, 1])(f)
        self.silt("resume", self.case, "--set", "run.steps=30")

    def test_a_run_that_begins_with_one_is_refused_too(self):
        follower = pathlib.Path(self.scratch.name) / "follower"
        follower.mkdir()
        (follower / "case.toml").write_text(TOUCHING.replace("velocity = [0.02, 0, 0]\npositions = [[6, 8, 2.5], [11, 8, 2.5]]\n", "")
                                            + f'[initial]\nfrom = "{self.out}"\n')
        self.silt("run", follower, "--steps", 2)
        for name, value in (("time_step", 0.0), ("density", np.nan), ("relaxation_time", -1.0)):
            self.path.write_bytes(self.good)
            with h5py.File(self.path, "r+") as f:
                attribute(f"start.{name}", value)(f)
            self.assertIn(f"start.{name} is {value:g}; it must be a number above 0", self.silt("run", follower, "--overwrite", "--steps", 2, code=2).stderr)

    def test_links_and_attributes_have_checksums(self):
        """HDF5 1.10 can crash on a damaged heap: there is none."""
        for heap in (b"FRHP", b"FHDB", b"HEAP", b"GCOL"):
            self.assertNotIn(heap, self.good)


if __name__ == "__main__":
    unittest.main()
