#!/usr/bin/python3
"""contact_loads.py SILT: contact force and torque, mass and buoyancy in bodies.h5 against mechanics, the same
bits on any ranks."""
import math
import re
import unittest

import numpy as np
from silt_test import SiltTest, script
from silt_runs import WALLS_ACROSS_Z, body_of, domain_of, entry_of, shape_of  # on the path by silt_test

import silt_results  # on the path by silt_test

RADIUS, DENSITY, GRAVITY = 3, 2.5, 1e-5
VOLUME = 4 / 3 * math.pi * RADIUS**3
MASS = DENSITY * VOLUME

# The ball at (16, 8, 3) touches the floor, where the blocks of a run on several ranks meet.
SCENE = (domain_of([32, 16, 16], WALLS_ACROSS_Z) +
         "blocks = [8, 8, 16]\n[gravity]\nacceleration = [0, 0, -1e-5]\n" +
         shape_of("ball", "sphere", "radius = 3") + body_of("ball", 2.5, "position = [16, 8, 3]") +
         "[run]\nsteps = 60\n[output]\nbodies = { every = 20, contacts = true }\n")
WET = SCENE.replace("[gravity]", "[fluid]\nrelaxation_time = 0.8\n[gravity]")


class ContactLoads(SiltTest):
    def last(self, text, *arguments, ranks=1):
        self.write(text)
        self.silt("run", self.case, *arguments, ranks=ranks)
        return silt_results.open(self.case).bodies

    def near(self, found, wanted, share=1e-9):
        scale = np.abs(wanted).max()
        self.assertLess(np.abs(np.asarray(found) - wanted).max(), share * scale, (found, wanted))

    def test_the_floor_bears_the_weight(self):
        for settings in ((), ("--set", "contacts.substeps=4"), ("--set", 'contacts.resolver="ffd"')):
            rows = self.last(SCENE, *settings).at(-1)
            self.near(rows["mass"], MASS, 1e-12)
            self.near(rows["contact_force"], [0, 0, MASS * GRAVITY])
            self.assertLess(np.abs(rows["contact_torque"]).max(), 1e-12 * MASS * GRAVITY * RADIUS)
            self.assertNotIn("buoyancy", rows)

    def test_in_a_fluid_less_its_buoyancy(self):
        # in double: at first rounding in single precision pushes the ball aside by 1e-9 of its weight
        series = self.last(WET, "--set", "run.steps=1600", "--set", 'fluid.precision="double"')  # the fluid under it comes to rest
        rows, rest = series.at(-1), np.array([0, 0, (MASS - VOLUME) * GRAVITY])
        self.near(rows["buoyancy"], [0, 0, VOLUME * GRAVITY], 1e-12)
        self.near(rows["contact_force"], rest, 1e-6)
        self.assertLess(np.abs(rows["force"]).max(), 1e-6 * MASS * GRAVITY)
        for rows in map(series.at, range(1, len(series))):
            self.near(rows["contact_force"] + rows["force"], rest)

    def test_all_that_acts_is_mass_times_acceleration(self):
        """Of a ball that a spring and a damper pull along a floor that moves, through a fluid, in gravity that
        swings: the fluid, weight, buoyancy, contacts and films, springs; and their torques."""
        scene = WET.replace('z = ["no-slip"', 'z = [{ type = "moving", velocity = [0, 0.004, 0] }').replace("position =", "velocity = [0.01, 0, 0]\nposition =")
        scene += '[[springs]]\nbody = "ball"\nends = [[16, 8, 5], [20, 6, 9]]\nstiffness = 2e-4\nlength = 4\ndamping = 1e-3\n'
        series = self.last(scene, "--set", "output.bodies.every=1", "--set", "gravity.over_time={ table = [[0, 1]], amplitude = 0.8, frequency = 0.01 }")
        middle = np.array(series.step[1:]) - 0.5
        gravity = GRAVITY * (1 + 0.8 * np.sin(2 * np.pi * 0.01 * middle))
        buoyancy, up = series.array("buoyancy")[1:, 0], np.array([0, 0, 1])
        self.near(buoyancy, np.outer(VOLUME * gravity, up), 1e-12)
        acts = sum(series.array(name)[1:, 0] for name in ("force", "contact_force", "spring_force")) + buoyancy
        self.near(acts - np.outer(MASS * gravity, up), MASS * np.diff(series.array("velocity")[:, 0], axis=0), 1e-11)
        turns = sum(series.array(name)[1:, 0] for name in ("torque", "contact_torque", "spring_torque"))
        inertia = 0.4 * MASS * RADIUS**2
        self.near(turns, inertia * np.diff(series.array("angular_velocity")[:, 0], axis=0), 1e-11)
        for name, least in (("contact_force", 0.01), ("spring_force", 0.05), ("force", 0.005)):
            self.assertGreater(np.abs(series.array(name)[1:, 0]).max(), least * MASS * GRAVITY)

    def test_buoyancy_of_gravity_that_begins_later(self):
        rows = self.last(WET, "--set", "gravity.over_time={ table = [[50, 0], [51, 1]] }").at(-1)
        self.near(rows["buoyancy"], [0, 0, VOLUME * GRAVITY], 1e-12)

    def test_friction_turns_a_rolling_ball(self):
        slope = 1e-5 * np.array([math.sin(0.3), 0, -math.cos(0.3)])
        scene = SCENE.replace("[0, 0, -1e-5]", str(list(slope)))
        rows = self.last(scene, "--set", "contacts.friction=0.8", "--set", "contacts.substeps=2").at(-1)
        down = 2 / 7 * MASS * slope[0]  # what keeps a full sphere from slipping
        self.near(rows["contact_force"], [-down, 0, -MASS * slope[2]])
        self.near(rows["contact_torque"], [0, down * RADIUS, 0])

    def test_a_locked_body_bears_what_lies_on_it(self):
        """The ball rests on a post that all axes hold, and one that only may turn, a radius beside its top."""
        every_axis = '["x", "y", "z", "rotation x", "rotation y", "rotation z"]'
        for locked, turned in ((every_axis, 0), ('["x", "y", "z"]', 0.3)):
            post = f"""position = [{16 - 2 * RADIUS * turned}, 8, {3 + 2 * RADIUS * math.sqrt(1 - turned**2)}]
[[bodies]]
shape = "ball"
name = "post"
density = 1
locked = {locked}
position = [16, 8, 3]
"""
            rows = self.last(SCENE.replace("position = [16, 8, 3]\n", post), "--set", "run.steps=20").at(-1)
            ball, post = rows["contact_force"]
            self.near(ball, -post, 1e-12)
            self.assertGreater(ball[2], 0.9 * (1 - turned**2) * MASS * GRAVITY)
            self.assertLess(np.abs(rows["contact_torque"]).max(), 1e-12 * MASS * GRAVITY * RADIUS)

    def test_a_locked_body_feels_films_as_a_free_one(self):
        """A ball towed to the floor, and one so heavy that it moves on: the forces of the last step."""
        towed = WET.replace("[0, 0, -1e-5]", "[0, 0, 0]").replace("position = [16, 8, 3]", "velocity = [0, 0, -1e-3]\nposition = [16, 8, 3.24]")
        all_axes = 'locked = ["x", "y", "z", "rotation x", "rotation y", "rotation z"]\nposition ='
        films = []
        for scene in (towed.replace("position =", all_axes), towed.replace("density = 2.5", "density = 1e7")):
            rows = self.last(scene, "--set", "run.steps=100", "--set", "output.bodies.every=100").at(-1)
            films.append(rows["contact_force"][0])
        self.assertGreater(films[0][2], 0.1 * 6 * math.pi * 0.1 * RADIUS**2 * 1e-3 / 0.14)
        self.near(films[0], films[1], 1e-3)

    def test_impacts_act_on_both(self):
        two = """position = [10, 8, 8]
velocity = [0.05, 0.01, 0]
[[bodies]]
shape = "ball"
name = "heavy"
density = 10
position = [16.2, 8.5, 8]
[[bodies]]
shape = "ball"
name = "post"
density = 1
motion = "fixed"
position = [26, 8, 8]
"""
        series = self.last(SCENE.replace("position = [16, 8, 3]\n", two).replace("-1e-5", "0"), "--set", "output.bodies.every=1")
        forces = series.array("contact_force")
        self.assertGreater(np.abs(forces[:, 0]).max(), 1e-3 * MASS)
        self.near(forces[:, 0], -forces[:, 1], 1e-12)
        self.assertTrue(np.isnan(forces[:, 2]).all())

    def test_mass_that_a_wall_sweeps_beside_a_body_is_told(self):
        """A cube that pushes a box: as a wall it takes none of the fluid in front of the box, as a body it does."""
        script("make_mesh", "cube", self.case / "cube.obj")  # two across
        box = shape_of("box", "box", "edges = [8, 8, 8]") + body_of("box", 1.5, "position = [20.05, 12, 12]")
        begin, end = domain_of([48, 24, 24], '"no-slip"') + "[fluid]\nrelaxation_time = 0.8\n", "[run]\nsteps = 200\n"
        pusher = 'file = "cube.obj"\nscale = 4\nposition = [12, 12, 12]\nmotion = { velocity = [0.02, 0, 0] }\n'
        wall = entry_of("walls", ['type = "mesh"', 'solid = "inside"']) + pusher
        file, scale, place, motion = pusher.splitlines(keepends=True)
        body = shape_of("pusher", "mesh", file + scale) + body_of("pusher", 1, place + motion)
        lost = {}
        for scene in (wall, body):
            self.write(begin + box + scene + end)
            said = self.silt("run", self.case, "--overwrite").stdout
            found = re.search("warning: the fluid lost (\\S+) % of its mass", said)
            lost[scene] = found and float(found[1])
            self.assertNotIn("compressible", said)
        self.assertIsNone(lost[body])
        swept = 100 * 8 * 8 * 0.02 * 200 / (48 * 24 * 24 - 2 * 8**3)
        self.assertTrue(lost[wall] and 0.8 < lost[wall] / swept < 1, (lost, swept))

    def test_the_same_on_any_ranks(self):
        moving = WET.replace("position =", "velocity = [0.05, 0.02, 0]\nposition =")
        moving = moving.replace("[16, 8, 3]\n", '[16, 8, 3]\n[[fill]]\nshape = "ball"\ndensity = 2\ncount = 20\ngap = 0.2\n')
        alone = self.last(moving, "--set", "contacts.substeps=2").columns
        self.assertGreater(np.count_nonzero(alone["contact_force"]), 20)
        for ranks in (2, 4, 8):
            columns = self.last(moving, "--set", "contacts.substeps=2", ranks=ranks).columns
            for name, values in alone.items():
                self.assertTrue((columns[name] == values).all(), (ranks, name))

    def test_goes_on_with_the_columns_it_began_with(self):
        self.last(SCENE, "--set", "run.steps=20", "--set", "output.checkpoint.every=20")
        said = self.silt("resume", self.case, "--set", "run.steps=40", "--set", "output.bodies.contacts=false", code=1).stderr
        self.assertIn("output.bodies.contacts as the run began", said)
        self.silt("resume", self.case, "--set", "run.steps=40")
        self.assertEqual(list(silt_results.open(self.case).bodies.step), [0, 20, 40])

    def test_only_where_asked_for(self):
        rows = self.last(SCENE.replace(", contacts = true", "")).at(-1)
        self.assertNotIn("contact_force", rows)


if __name__ == "__main__":
    unittest.main()
