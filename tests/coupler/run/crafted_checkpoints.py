#!/usr/bin/python3
"""Checkpoints that no run wrote, with every checksum right, and such with damaged metadata: refused by name, at once,
without a crash. crafted_checkpoints.py SILT [TEST]"""
import random
import shutil
import unittest

import h5py
import numpy as np

from silt_test import CASE, SiltTest

GOLDEN = 0x9E3779B97F4A7C15


def checksum(values):
    """As adapters/hdf5/checksum.hpp has it."""
    data = np.ascontiguousarray(values).reshape(-1)
    bits = data.view(f"u{data.dtype.itemsize}").astype(np.uint64)
    with np.errstate(over="ignore"):
        x = bits + np.uint64(GOLDEN) * np.arange(1, len(bits) + 1, dtype=np.uint64)
        x = (x ^ (x >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        x ^= x >> np.uint64(31)
        return np.uint64(np.where(bits != 0, x, np.uint64(0)).sum(dtype=np.uint64))


def put(name, values):
    """Replaces a dataset, of its type, by values with a right checksum."""
    def craft(f):
        kind = f[name].dtype
        del f[name]
        f.create_dataset(name, data=np.array(values, dtype=kind)).attrs["checksum"] = checksum(np.array(values, kind))
    return craft


def change(name, index, value):
    def craft(f):
        values = f[name][:]
        values[index] = value
        put(name, values)(f)
    return craft


def declare(name, shape):
    """A dataset of this shape that has no byte in the file."""
    def craft(f):
        kind = f[name].dtype
        del f[name]
        f.create_dataset(name, shape=shape, dtype=kind).attrs["checksum"] = np.uint64(0)
    return craft


def attribute(name, value):
    def craft(f):
        f["state"].attrs[name] = value
    return craft


def without(name):
    def craft(f):
        del f[name]
    return craft


def wrapping_counts(f):
    rows = len(f["impulses/partner"])
    put("bodies/impulse_count", [2**63, 2**63 + rows])(f)


CRAFTED = {
    "its shape is 1000, and the case has 1": change("bodies/shape", 0, 1000),
    "its shape is -5, and the case has 1": change("bodies/shape", 1, -5),
    "its material is 7": change("bodies/material", 1, 7),
    "its kind is -1": change("bodies/kind", 1, -1),
    "its motion is 200": change("bodies/motion", 0, 200),
    "its mass is -1": change("bodies/mass", 0, -1),
    "its position is not finite": change("bodies/position", (0, 1), np.nan),
    "its orientation has the square 0": change("bodies/orientation", 1, 0),
    "body 1 comes after body 1": put("bodies/id", [1, 1]),
    "body 0 comes after body 0": put("bodies/id", [0, 2]),
    "/bodies/id has another": lambda f: put("bodies/id", 1)(f),
    "do not fit together": wrapping_counts,
    "/bodies/mass declares more values than the file": declare("bodies/mass", (2**40,)),
    "/cells/populations declares more values than the file": declare("cells/populations", (19, 2**14, 2**14, 2**14)),
    "of another lattice": put("cells/populations", np.zeros((19, 2, 2, 2))),
    "has no dataset /bodies": without("bodies"),
    "it is of step -7": attribute("step", np.int64(-7)),
    "it is of step 24, by its name of step 25": attribute("step", np.int64(24)),
}


class Checkpoints(SiltTest):
    def setUp(self):
        super().setUp()
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

    def test_links_and_attributes_have_checksums(self):
        """HDF5 1.10 can crash on a damaged heap: there is none."""
        for heap in (b"FRHP", b"FHDB", b"HEAP", b"GCOL"):
            self.assertNotIn(heap, self.good)

    def test_damaged_metadata(self):
        with h5py.File(self.path) as f:
            data = []
            f.visititems(lambda _, o: data.append((o.id.get_offset(), o.id.get_storage_size()))
                         if isinstance(o, h5py.Dataset) and o.id.get_offset() else None)
        metadata = [at for at in range(len(self.good)) if not any(first <= at < first + n for first, n in data)]
        random.seed(1)
        refused = 0
        for at in random.sample(metadata, 60):
            damaged = bytearray(self.good)
            damaged[at] ^= 1 << random.randrange(8)
            self.path.write_bytes(damaged)
            result = self.run_silt("info", self.path)
            self.assertIn(result.returncode, (0, 2), f"byte {at}: {result.stderr}")
            refused += result.returncode == 2
        self.assertGreater(refused, 20)
        shutil.rmtree(self.out)


if __name__ == "__main__":
    unittest.main()
