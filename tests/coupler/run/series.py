#!/usr/bin/python3
"""series.py SILT: the columns of [[output.series]] against mechanics, the same file on any ranks and across a restart."""
import math
import pathlib
import sys
import unittest

import numpy as np
from silt_test import CHANNEL, SiltTest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))

import silt_results  # noqa: E402

WEIGHT = 2.5 * 4 / 3 * math.pi * 3**3 * 1e-5

# One ball lies on the floor, one on a fixed cube, beside the middle of its upper face.
RESTING = """
[units]
system = "lattice"
[domain]
size = [32, 16, 24]
boundary = { x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] }
blocks = [8, 8, 24]
[gravity]
acceleration = [0, 0, -1e-5]
[[shapes]]
name = "ball"
type = "sphere"
radius = 3
[[shapes]]
name = "cube"
type = "box"
edges = [8, 8, 8]
[[bodies]]
shape = "ball"
density = 2.5
positions = [[8, 8, 3], [25, 8, 13]]
[[bodies]]
shape = "cube"
density = 1
motion = "fixed"
position = [24, 8, 6]
[run]
steps = 60
"""

# A crowd that moves through a fluid past a post and a turning rod, and bounces off the floor.
CROWD = """
[units]
system = "lattice"
[domain]
size = [32, 16, 16]
boundary = { x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] }
blocks = [8, 8, 8]
[fluid]
relaxation_time = 0.8
body_force = [1e-5, 0, 0]
[gravity]
acceleration = [0, 0, -1e-4]
[[shapes]]
name = "ball"
type = "sphere"
radius = 2.5
[[shapes]]
name = "rod"
type = "capsule"
radius = 2
length = 6
[[fill]]
shape = "ball"
density = 2
count = 12
gap = 0.2
[[bodies]]
shape = "rod"
density = 1
motion = "prescribed"
angular_velocity = [0.01, 0, 0]
position = [16, 8, 8]
[run]
steps = 60
[output]
checkpoint = { every = 25, keep = 5 }
bodies = { every = 1 }
"""


def series(name, every, quantities):
    """quantities: the lines of each by its name."""
    text = "".join(f'[[quantities]]\nname = "{n}"\n{lines}\n' for n, lines in quantities.items())
    return text + f'[[output.series]]\nname = "{name}"\nevery = {every}\ncolumns = {str(list(quantities)).replace(chr(39), chr(34))}\n'


def of(kind, axes="xyz", **keys):
    lines = "".join(f'{key} = "{value}"\n' for key, value in keys.items())
    return {f"{kind}.{'.'.join(keys.values())}.{a}": f'type = "{kind}"\n{lines}axis = "{a}"' for a in axes}


class Series(SiltTest):
    def near(self, found, wanted, share=1e-9):
        self.assertLessEqual(np.abs(np.asarray(found) - wanted).max(), share * np.abs(wanted).max(), (found, wanted))

    def test_weights(self):
        columns = {**of("contact-force", body="ball"), **of("contact-force", body="cube"), **of("contact-torque", body="cube"),
                   **of("contact-force", side="z-low")}
        for settings in ((), ("--set", "contacts.substeps=3")):
            self.write(RESTING + series("loads", 7, columns))
            self.silt("run", self.case, "--overwrite", *settings)
            table = silt_results.open(self.case).table("loads")
            self.assertEqual(list(table["step"]), list(range(0, 60, 7)))
            self.assertTrue(np.isnan(table["contact-force.ball.z"][0]))

            def vector(name):
                return [table[f"{name}.{a}"][-1] for a in "xyz"]
            self.near(vector("contact-force.ball"), [0, 0, 2 * WEIGHT])
            self.near(vector("contact-force.cube"), [0, 0, -WEIGHT])
            self.near(vector("contact-torque.cube"), [0, WEIGHT, 0])  # a ball one cell beside the middle
            self.near(vector("contact-force.z-low"), [0, 0, -WEIGHT])

    def test_poiseuille(self):
        """Walls bear the body force; the parabola's flow rate at the middles of the cells."""
        columns = {**of("fluid-force", side="z-low"), **of("fluid-force", "x", side="z-high"), "rate": 'type = "flow-rate"\naxis = "x"\nat = 3.2'}
        self.write(CHANNEL.replace("steps = 10000\nsteady = { quantity = \"energy\", change = 1e-3, every = 100 }", "steps = 3000")
                   .replace("[4, 4, 6]", "[4, 4, 3]") + series("walls", 100, columns))
        self.silt("run", self.case)
        table = silt_results.open(self.case).table("walls")
        force, height, viscosity = 1e-6, 12, 0.1
        self.near(table["fluid-force.z-low.x"][-1], force * 8 * 8 * height / 2, 1e-6)
        self.near(table["fluid-force.z-high.x"][-1], force * 8 * 8 * height / 2, 1e-6)
        z = np.arange(height) + 0.5
        self.near(table["rate"][-1], 8 * (force * z * (height - z) / (2 * viscosity)).sum(), 1e-6)
        self.assertEqual(table["rate"][-1], self.report()["quantities"]["rate"])
        self.assertEqual(len(table), 31)

    def crowd(self):
        motions = {}
        for what in ("velocity", "angular-velocity", "height"):
            for kind in (f"mean-{what}", f"{what}-deviation", f"least-{what}", f"largest-{what}"):
                motions.update(of(kind, body="ball"))
        loads = {}
        for kind in ("fluid-force", "fluid-torque", "contact-force", "contact-torque"):
            loads.update(of(kind, body="ball"))
            loads.update(of(kind, body="rod"))
        loads.update(of("contact-force", side="z-low"))
        loads["stress"] = 'type = "wall-stress"\nside = "z-low"\naxis = "z"\ntime = 30'
        loads["rate"] = 'type = "flow-rate"\naxis = "z"\nat = 16'
        return CROWD + series("motions", 10, motions) + series("loads", 1, loads)

    def files(self):
        return [(self.out / f"series_{name}.csv").read_bytes() for name in ("motions", "loads")]

    def test_against_the_bodies(self):
        """Statistics of the velocities in bodies.h5; action and reaction of all that bodies touch; Newton's law for all balls."""
        self.write(self.crowd().replace("bodies = { every = 1 }", "bodies = { every = 1, contacts = true }"))
        self.silt("run", self.case)
        run = silt_results.open(self.case)
        motions, loads = run.table("motions"), run.table("loads")
        balls = run.bodies.array("velocity")[::10, 1:]  # the rod is given, and so the first
        for d, axis in enumerate("xyz"):
            v = balls[:, :, d]
            for kind, wanted in (("mean-velocity", v.mean(1)), ("velocity-deviation", v.std(1)), ("least-velocity", v.min(1)),
                                 ("largest-velocity", v.max(1))):
                found = motions[f"{kind}.ball.{axis}"]
                self.assertLess(np.abs(found - wanted).max(), 1e-12, kind)
            self.near(loads[f"contact-force.ball.{axis}"][1:], run.bodies.array("contact_force")[1:, 1:, d].sum(1))
            self.near(loads[f"fluid-force.rod.{axis}"][1:], run.bodies.array("force")[1:, 0, d])
            self.near(loads[f"fluid-torque.ball.{axis}"][1:], run.bodies.array("torque")[1:, 1:, d].sum(1))
        self.assertGreater(np.abs(loads["contact-force.rod.z"][1:]).max(), 1e-4)

    def test_action_and_reaction(self):
        """What dry balls feel is what the floor and the rod feel, less."""
        columns = {**of("contact-force", body="ball"), **of("contact-force", body="rod"), **of("contact-force", side="z-low"),
                   **of("contact-torque", body="rod")}
        text = CROWD.replace("[fluid]\nrelaxation_time = 0.8\nbody_force = [1e-5, 0, 0]\n", "") + series("loads", 1, columns)
        self.write(text.replace("[0, 0, -1e-4]", "[0, 0, -1e-3]"))
        self.silt("run", self.case, "--set", "run.steps=200", ranks=2)
        table = silt_results.open(self.case).table("loads")
        for axis in "xyz":
            given = table[f"contact-force.rod.{axis}"][1:] + table[f"contact-force.z-low.{axis}"][1:]
            self.near(-given, table[f"contact-force.ball.{axis}"][1:])
        self.assertGreater(np.abs(table["contact-force.rod.z"][1:]).max(), 1e-3)
        self.assertGreater(np.abs(table["contact-torque.rod.x"][1:]).max(), 1e-3)

    def test_the_same_on_any_ranks_and_after_a_restart(self):
        self.write(CROWD)
        self.silt("run", self.case, ranks=2)
        without = self.report()
        self.write(self.crowd())
        self.silt("run", self.case, "--overwrite")
        self.assertEqual(self.report()["state_hash"], without["state_hash"])
        whole = self.files()
        self.assertEqual([text.count(b"\n") for text in whole], [8, 62])
        for ranks in (2, 4, 8):
            self.silt("run", self.case, "--overwrite", ranks=ranks)
            self.assertEqual(self.files(), whole, ranks)
            if ranks == 2:  # and no step waits for it
                self.assertEqual(*(r["traffic"]["blocking_collectives_per_step"] for r in (self.report(), without)))
        for step in (50, 60):
            (self.out / f"checkpoint_{step:012}.h5").unlink()
        self.silt("resume", self.case, ranks=2)  # from step 25: rows of later steps are there, and a half one
        self.assertEqual(self.files(), whole)
        with open(self.out / "series_loads.csv", "a") as stream:
            stream.write("61,61,")
        for step in (50, 60):
            (self.out / f"checkpoint_{step:012}.h5").unlink()
        self.silt("resume", self.case)
        self.assertEqual(self.files(), whole)


if __name__ == "__main__":
    unittest.main()
