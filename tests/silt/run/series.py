#!/usr/bin/python3
"""series.py SILT: [[output.series]] and [[output.probes]] against mechanics, the same files on any ranks and
across a restart."""
import math
import subprocess
import time
import unittest

import numpy as np
from silt_test import CASE, CHANNEL, ENVIRONMENT, SiltTest
from silt_runs import WALLS_ACROSS_Z, body_of, domain_of, fill_of, shape_of  # on the path by silt_test

import silt_results  # on the path by silt_test

WEIGHT = 2.5 * 4 / 3 * math.pi * 3**3 * 1e-5

# One ball lies on the floor, one on a fixed cube, beside the middle of its upper face.
RESTING = (domain_of([32, 16, 24], WALLS_ACROSS_Z) +
           "blocks = [8, 8, 24]\n[gravity]\nacceleration = [0, 0, -1e-5]\n" +
           shape_of("ball", "sphere", "radius = 3") + shape_of("cube", "box", "edges = [8, 8, 8]") +
           body_of("ball", 2.5, "positions = [[8, 8, 3], [25, 8, 13]]") +
           body_of("cube", 1, 'motion = "fixed"', "position = [24, 8, 6]") + "[run]\nsteps = 60\n")

# A crowd that moves through a fluid past a post and a turning rod, and bounces off the floor.
CROWD = (domain_of([32, 16, 16], WALLS_ACROSS_Z) + "blocks = [8, 8, 8]\n" +
         "[fluid]\nrelaxation_time = 0.8\nbody_force = [1e-5, 0, 0]\n" +
         "[gravity]\nacceleration = [0, 0, -1e-4]\n" + shape_of("ball", "sphere", "radius = 2.5") +
         shape_of("rod", "capsule", "radius = 2", "length = 6") + fill_of("ball", 2, 12, "gap = 0.2") +
         body_of("rod", 1, 'motion = "prescribed"', "angular_velocity = [0.01, 0, 0]", "position = [16, 8, 8]") +
         "[run]\nsteps = 60\n" +
         "[output]\ncheckpoint = { every = 25, keep = 5 }\nbodies = { every = 1 }\n")


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
        """Walls bear the body force; the parabola's flow rate at the middles of the cells; each stress has its own box and component."""
        columns = {**of("fluid-force", side="z-low"), **of("fluid-force", "x", side="z-high"), "rate": 'type = "flow-rate"\naxis = "x"\nat = 3.2'}
        for name, component, low in (("lower", "xz", 0), ("normal", "xx", 0), ("upper", "xz", 6)):
            columns[name] = f'type = "viscous-stress"\ncomponent = "{component}"\nbox = [[0, 0, {low}], [8, 8, {low + 6}]]'
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
        self.near(table["lower"][-1], 3 * force, 1e-6)  # half of a wall's: the shear stress falls linearly to 0 in the middle
        self.near(table["upper"][-1], -3 * force, 1e-6)
        self.assertLess(abs(table["normal"][-1]), 1e-3 * force)
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
        """Statistics of the velocities in bodies.h5; action and reaction of all that bodies touch; Newton's
        law for all balls."""
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

    def test_parts_of_a_tensor(self):
        """The last row of a series has the values of the report, of each component of a stress and in each box."""
        columns = {f"{kind}-{c}-{z}": f'type = "{kind}-stress"\ncomponent = "{c}"\nbox = [[0, 0, {z}], [32, 16, 16]]'
                   for kind in ("viscous", "particle") for c in ("xx", "xz") for z in (0, 8)}
        self.write(CROWD + series("stress", 60, columns))
        self.silt("run", self.case, ranks=2)
        table = silt_results.open(self.case).table("stress")
        values = {name: table[name][-1] for name in columns}
        self.assertEqual(values, self.report()["quantities"])
        self.assertEqual(len(set(values.values())), len(columns), values)

    def test_action_and_reaction(self):
        """Dry balls feel the opposite of what the floor and the rod feel."""
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
        for ranks in (3, 4):
            self.silt("run", self.case, "--overwrite", ranks=ranks)
            self.assertEqual(self.files(), whole, ranks)
            if ranks == 3:  # and no step waits for it
                self.assertEqual(*(r["traffic"]["blocking_collectives_per_step"] for r in (self.report(), without)))
        self.forget(50, 60)
        self.silt("resume", self.case, ranks=2)  # from step 25: rows of later steps are there, and a half one
        self.assertEqual(self.files(), whole)
        with open(self.out / "series_loads.csv", "a") as stream:
            stream.write("61,61,")
        self.forget(50, 60)
        self.silt("resume", self.case)
        self.assertEqual(self.files(), whole)

    def test_means_over_steps(self):
        """Rows of means against the rows of each step; the same on any ranks, and where a run goes on amid a mean."""
        columns = {**of("fluid-force", body="rod"), **of("mean-velocity", "z", body="ball"), **of("contact-torque", "x", body="rod")}
        means = "".join(f'[[output.series]]\nname = "{name}"\nevery = {every}\nmean_of = {count}\ncolumns = {list(columns)}\n'.replace("'", '"')
                        for name, every, count in (("some", 20, 9), ("all", 15, 15)))
        self.write(CROWD + series("each", 1, columns) + means)
        self.silt("run", self.case)
        each = silt_results.open(self.case).table("each")
        for name, every, count in (("some", 20, 9), ("all", 15, 15)):
            table = silt_results.open(self.case).table(name)
            self.assertEqual(list(table["step"]), list(range(0, 61, every)))
            for column in columns:
                self.near(table[column][1:], [each[column][step - count + 1:step + 1].mean() for step in table["step"][1:].astype(int)], 1e-12)
                np.testing.assert_array_equal(table[column][0], each[column][0])
        whole = [(self.out / f"series_{name}.csv").read_bytes() for name in ("some", "all")]
        self.silt("run", self.case, "--overwrite", ranks=4)
        self.assertEqual([(self.out / f"series_{name}.csv").read_bytes() for name in ("some", "all")], whole)
        self.forget(50, 60)  # step 25 lies within a mean of 15
        self.silt("resume", self.case, ranks=2)
        self.assertEqual([(self.out / f"series_{name}.csv").read_bytes() for name in ("some", "all")], whole)
        self.silt("run", self.case, "--overwrite", "--set", "run.steps=35")  # and 35 within one of 9
        self.silt("resume", self.case, "--set", "run.steps=60")
        self.assertEqual((self.out / "series_some.csv").read_bytes(), whole[0])

    def test_other_definitions_begin_anew(self):
        """A mean that is of something else where a run goes on is of the steps since then, and the run says so; of the same
        it is as without a stop."""
        loads = {f"{side}-{a}": f'type = "wall-stress"\nside = "{side}"\naxis = "{a}"\ntime = 0' for side in ("z-low", "z-high") for a in "xz"}
        load = '[[quantities]]\nname = "load"\ntype = "wall-stress"\nside = "z-low"\naxis = "z"\ntime = 5\n'
        means = '[[output.series]]\nname = "means"\nevery = 15\nmean_of = 15\ncolumns = ["load", "z-low-x"]\n'
        text = CROWD.replace("[output]\n", '[output]\nmean = { from = 0, every = 2 }\n').replace(
            "steps = 60\n", 'steps = 60\nsteady = { quantity = "load", change = 1e-12, every = 10 }\n')
        self.write(text + series("each", 1, loads) + load + means)
        self.silt("run", self.case)
        each = {name: silt_results.open(self.case).table("each")[name] for name in loads}
        whole, rows = self.report()["quantities"]["load"], (self.out / "series_means.csv").read_bytes()
        self.near(whole, each["z-low-z"][5:].mean(), 1e-12)

        def resumed(*settings):
            """Returns the mean, the first row after step 25, and the warnings."""
            self.forget(50, 60)
            said = self.silt("resume", self.case, *(word for setting in settings for word in ("--set", setting)))
            means = silt_results.open(self.case).table("means")
            row = {name: means[name][2] for name in means.names}
            warnings = [line.partition("warning: ")[2] for line in (said.stdout + said.stderr).splitlines() if "warning: " in line]
            return self.report()["quantities"]["load"], row, [w for w in warnings if "checkpoint" in w or " anew " in w]

        mean, row, warnings = resumed()
        self.assertEqual((mean, warnings, (self.out / "series_means.csv").read_bytes()), (whole, [], rows))
        for setting, name in (("quantities[4].axis=x", "z-low-x"), ("quantities[4].side=z-high", "z-high-z")):
            mean, row, warnings = resumed(setting.replace("=", '="') + '"')
            self.near(mean, each[name][26:].mean(), 1e-12)
            self.near(row["load"], each[name][26:31].mean(), 1e-12)
            self.near(row["z-low-x"], each["z-low-x"][16:31].mean(), 1e-12)
            for word, of in zip(warnings, ("quantities[4] ('load') ", "output.series[1] ", "run.steady ")):
                self.assertTrue(word.startswith(of), warnings)
            self.assertEqual(len(warnings), 3, warnings)
        mean, row, warnings = resumed("quantities[4].time=30")
        self.near(mean, each["z-low-z"][30:].mean(), 1e-12)
        self.near(row["load"], each["z-low-z"][16:31].mean(), 1e-12)
        self.assertEqual(len(warnings), 2, warnings)
        for setting, word in (("output.mean.every=5", "output.mean "), ("output.mean.from=1", "output.mean "),
                              ("run.steady.every=5", "run.steady ")):
            mean, row, warnings = resumed(setting)
            self.assertEqual(mean, whole)
            self.assertTrue(len(warnings) == 1 and warnings[0].startswith(word), warnings)

    def test_a_checkpoint_stands_for_the_rows_before_it(self):
        self.write(self.crowd().replace("steps = 60", "steps = 100000000").replace("bodies = { every = 1 }\n", ""))
        run = subprocess.Popen(self.command(["run", self.case], 1), stdout=subprocess.DEVNULL, env=ENVIRONMENT)
        self.addCleanup(run.wait)
        self.addCleanup(run.kill)
        while not (there := list(self.out.glob("checkpoint_*.h5"))):
            self.assertIsNone(run.poll())
            time.sleep(0.02)
        run.kill()
        run.wait()
        step = int(max(there).stem.partition("_")[2])
        self.assertEqual(list(silt_results.open(self.case).table("loads")["step"])[:step + 1], list(range(step + 1)))


# A fluid sheared between walls that slide against each other, with wide cells in the middle.
COUETTE = (domain_of([16, 16, 48], '{ x = "periodic", y = "periodic", z = [{ type = "moving", velocity = [-0.024, 0, 0] }, { type = "moving", velocity = [0.024, 0, 0] }] }') +
           '[coarsening]\nlevels = 1\ndistance = 8\nfine = [{ box = [[0, 0, 0], [16, 16, 8]] }, { box = [[0, 0, 40], [16, 16, 48]] }]\n' +
           '[fluid]\nrelaxation_time = 2\nprecision = "double"\n[run]\nsteps = 4000\n' +
           '[[output.probes]]\nname = "across"\nline = [[0, 3.1, 0], [16, 12.9, 48]]\ncount = 40\n' +
           'every = 100\nquantities = ["velocity", "shear-rate"]\n')


def probes(name, lines):
    return f'[[output.probes]]\nname = "{name}"\n{lines}\n'


def trilinear(field, name, points):
    """Returns values of the file's image, by the weights of those of eight cells; periodic along x and y. For one that is
    not fluid stands the linear function that is nearest to the others and to the fluid next to these outward."""
    values, solid = field[name], field["solid"] != 0

    def fluid(cell):
        """Its index, or nothing."""
        if not 0 <= cell[2] < solid.shape[2]:
            return None
        cell = tuple(cell % solid.shape)
        return None if solid[cell] else cell
    found = []
    for x in points:
        low = np.floor(x - 0.5).astype(int)
        total, seen, missing = 0 * values[0, 0, 0], [], []
        for corner in np.ndindex(2, 2, 2):
            place = low + corner
            weight = np.prod(1 - np.abs(x - 0.5 - place))
            if fluid(place) is None:
                missing.append((weight, place))
                continue
            total = total + weight * values[fluid(place)]
            outward = np.diag(2 * np.array(corner) - 1)
            seen += [p for p in (place, *(place + outward)) if fluid(p) is not None]
        if not seen:
            total = total * np.nan
        elif missing:
            centre, known = np.mean(seen, 0), np.array([values[fluid(p)] for p in seen], float)
            gradient = np.linalg.lstsq(np.array(seen) - centre, known - known.mean(0), rcond=1e-6)[0]
            for weight, place in missing:
                total = total + weight * (known.mean(0) + (place - centre) @ gradient)
        found.append(np.maximum(total, 0) if name == "shear-rate" else total)
    return np.array(found)


class Probes(SiltTest):
    QUANTITIES = 'quantities = ["velocity", "density", "pressure", "shear-rate"]'

    def test_against_the_fields(self):
        """Everywhere, beside bodies, in them and across periodic sides."""
        points = np.random.default_rng(5).uniform(0, [24, 16, 16], (60, 3))
        points[:3] = [0, 0, 0], [24, 16, 16], [6, 8, 8]
        text = CASE.replace("fields = { every = 20 }", f'fields = {{ every = 20, precision = "double", {self.QUANTITIES} }}')
        self.write(text + probes("cloud", f"points = {points.tolist()}\nevery = 20\n{self.QUANTITIES}"))
        self.silt("run", self.case)
        run = silt_results.open(self.case)
        cloud = run.probes("cloud")
        self.assertEqual(list(cloud.time), [0, 20, 40, 60])
        self.assertTrue((cloud.of("y")[2] == points[:, 1]).all())
        for k, field in enumerate(run.fields):
            u = trilinear(field, "velocity", points)
            for d, axis in enumerate("xyz"):
                np.testing.assert_allclose(cloud.of(f"velocity.{axis}")[k], u[:, d], rtol=0, atol=1e-12)
            for name in ("density", "pressure", "shear-rate"):
                np.testing.assert_allclose(cloud.of(name)[k], trilinear(field, name, points), rtol=0, atol=1e-12)
        self.assertTrue(np.isnan(cloud.of("density")[:2, 2]).all())  # in a ball
        self.assertGreater(np.nanmax(np.abs(cloud.of("velocity.z")[3])), 1e-4)
        whole = (self.out / "probes_cloud.csv").read_bytes()
        for ranks in (3, 4):
            self.silt("run", self.case, "--overwrite", ranks=ranks)
            self.assertEqual((self.out / "probes_cloud.csv").read_bytes(), whole, ranks)
        self.forget(50, 60)
        self.silt("resume", self.case)
        self.assertEqual((self.out / "probes_cloud.csv").read_bytes(), whole)
        for other in (points[:30], points + 0.25 * (points < 12)):  # fewer; elsewhere
            self.forget(50, 60)
            self.silt("resume", self.case, "--set", f"output.probes[0].points={other.tolist()}")
            before = (self.out / "probes_cloud.1.csv").read_bytes()
            self.assertTrue(whole.startswith(before) and before.count(b"\n") == 1 + 2 * len(points))
            cloud = silt_results.open(self.case).probes("cloud")
            self.assertEqual(list(cloud.time), [40, 60])
            np.testing.assert_allclose(cloud.of("x")[0], other[:, 0])
            (self.out / "probes_cloud.1.csv").replace(self.out / "probes_cloud.csv")

    def test_the_parabola(self):
        """At the middles of the cells exact, between them linear."""
        self.write(CHANNEL.replace("steps = 10000\nsteady = { quantity = \"energy\", change = 1e-3, every = 100 }", "steps = 3000")
                   + probes("across", f"line = [[3, 4, 0.5], [3, 4, 11.5]]\ncount = 34\nevery = 3000\n{self.QUANTITIES}"))
        self.silt("run", self.case)
        across = silt_results.open(self.case).probes("across")
        z, middles, force, viscosity = across.of("z")[1], np.arange(12) + 0.5, 1e-6, 0.1
        u = force / (2 * viscosity) * middles * (12 - middles)
        np.testing.assert_allclose(across.of("velocity.x")[1], np.interp(z, middles, u), rtol=1e-6)
        shear = force / viscosity * np.abs(6 - middles)
        np.testing.assert_allclose(across.of("shear-rate")[1], np.interp(z, middles, shear), rtol=1e-6)
        np.testing.assert_allclose(across.of("density")[1], 1, atol=1e-12)

    def test_on_cells_of_two_widths(self):
        self.write(COUETTE)
        self.silt("run", self.case)
        across = silt_results.open(self.case).probes("across")
        z = across.of("z")[-1]  # of cells of width 2 from 8 to 40
        np.testing.assert_allclose(across.of("velocity.x")[-1], (z - 24) * 1e-3, atol=1e-12)
        np.testing.assert_allclose(across.of("shear-rate")[-1], 1e-3, rtol=0.02)
        whole = (self.out / "probes_across.csv").read_bytes()
        for ranks in (3, 4):
            self.silt("run", self.case, "--overwrite", "--steps", 100, ranks=ranks)
            lines = (self.out / "probes_across.csv").read_bytes()
            self.assertTrue(whole.startswith(lines) and lines.count(b"\n") == 81, ranks)


if __name__ == "__main__":
    unittest.main()
