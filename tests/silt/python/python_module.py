#!/usr/bin/python3
"""python_module.py SILT FOLDER: the module `silt` in FOLDER does what the program SILT does, its arrays are
what they say they are, and the program of its page runs as it stands."""
import contextlib
import gc
import io
import re
import subprocess
import sys
import textwrap
import unittest
import warnings

from module_test import ROOT, ModuleTest

import numpy as np
import silt
import silt_results
from silt_test import CASE, UNSTABLE
from silt_runs import body_of, domain_of, shape_of

DRY = (domain_of([32, 32, 32]) + shape_of("ball", "sphere", "radius = 3") +
       body_of("ball", 2, "positions = [[8, 8, 8], [24, 24, 24]]") + "[run]\nsteps = 10\n")
WATER = """
[units]
system = "si"
cell_size = 1e-3
relaxation_time = 0.8
[domain]
size = [0.016, 0.02, 0.024]
boundary = "periodic"
[fluid]
density = 1000
kinematic_viscosity = 1e-6
precision = "double"
[coupling]
force = "exact"
[[shapes]]
name = "ball"
type = "sphere"
radius = 4e-3
[[bodies]]
shape = "ball"
density = 2000
position = [0.008, 0.01, 0.012]
[run]
steps = 5
[output]
fields = { every = 5, quantities = ["velocity", "density", "body-id"], precision = "double" }
"""
MASS = 2 * 4 / 3 * np.pi * 3**3  # of a ball of DRY


class Module(ModuleTest):
    # ---- physics ----

    def test_a_force_gives_its_impulse_once(self):
        simulation = self.simulation(DRY)
        force, torque = np.array([0.02, -0.01, 0.03]), np.array([0.1, 0.2, -0.3])
        first = int(simulation.bodies.id[0])
        simulation.add_force(first, force, torque=torque)
        simulation.step()
        bodies = simulation.bodies
        self.assertTrue(np.allclose(bodies.mass, MASS, rtol=1e-12))
        inertia = 2 / 5 * MASS * 3**2
        for _ in range(2):
            self.assertTrue(np.allclose(MASS * bodies.velocity[0], force, rtol=1e-12), bodies.velocity)
            self.assertTrue(np.allclose(inertia * bodies.angular_velocity[0], torque, rtol=1e-12))
            self.assertTrue((bodies.velocity[1] == 0).all() and (bodies.angular_velocity[1] == 0).all())
            simulation.step()

    def test_momentum_in_a_fluid(self):
        """No impulse is lost: the body and the fluid have it, but for what has yet to act on the body."""
        simulation = self.simulation(WATER)
        force = np.array([0, 0, 0.2])
        simulation.add_force(1, force)
        simulation.step()
        fluid = simulation.field("velocity")[simulation.field("body-id") == 0].sum(axis=0)
        body = simulation.bodies.mass[0] * simulation.bodies.velocity[0]
        self.assertTrue(np.allclose(fluid + body, force, atol=1e-3 * 0.2), (fluid, body))
        self.assertLess(body[2], force[2] - 1e-2 * 0.2)  # some of it is the fluid's
        one = simulation.units
        self.assertAlmostEqual(one["length"], 1e-3, delta=1e-15)
        self.assertAlmostEqual(one["time"], 0.1 * 1e-6 / 1e-6, delta=1e-12)  # nu = (tau - 1/2) / 3
        self.assertAlmostEqual(one["force"], 1000 * 1e-3**4 / one["time"]**2, delta=1e-15)
        self.assertAlmostEqual(simulation.time, one["time"], delta=1e-12)

    def test_fluid_at_rest(self):
        simulation = self.simulation(WATER)
        with self.assertRaisesRegex(ValueError, "steps is -1; it must be at least 0"):
            simulation.run(-1)
        simulation.run(3)
        self.assertEqual(simulation.steps_done, 3)
        self.assertEqual((simulation.cells, simulation.box), ((16, 20, 24), ((0, 0, 0), (16, 20, 24))))
        density, velocity, ball = (simulation.field(name) for name in ("density", "velocity", "body-id"))
        self.assertEqual((density.shape, velocity.shape), ((16, 20, 24), (16, 20, 24, 3)))
        self.assertTrue((density == 1).all() and (velocity == 0).all())
        self.assertAlmostEqual((ball == 1).sum(), 4 / 3 * np.pi * 4**3, delta=15)
        self.assertEqual(tuple(np.argwhere(ball == 1).mean(axis=0) + 0.5), (8, 10, 12))

    # ---- the program and the module ----

    def test_same_state_as_of_the_program(self):
        self.silt("run", self.case, "--set", "fluid.relaxation_time=0.7")
        simulation = silt.Simulation(str(self.case), set=["fluid.relaxation_time=0.7"])
        simulation.run(59)
        simulation.step()
        self.assertEqual(simulation.hash(), self.report()["state_hash"])
        simulation.add_force(1, [0, 0, 1e-9])
        simulation.step()
        other = silt.Simulation(self.case, set=["fluid.relaxation_time=0.7"])
        other.run(61)
        self.assertNotEqual(simulation.hash(), other.hash())

    def test_same_fields_and_bodies_as_in_files(self):
        text = WATER.replace("density = 2000", "density = 2000\nvelocity = [1e-3, 0, 2e-3]\nangular_velocity = [0, 0.1, 0.2]")
        text += 'bodies = { every = 5 }\n'
        self.write(text)
        self.silt("run", self.case)
        files, simulation = silt_results.open(self.case), silt.Simulation(self.case)
        simulation.run(5)
        for name in ("velocity", "density", "body-id"):
            scale = simulation.units.get(name, 1)
            self.assertTrue(np.allclose(scale * simulation.field(name), files.fields[-1][name], rtol=1e-14, atol=0), name)
        last, bodies = files.bodies.at(-1), simulation.bodies
        for name, of in (("position", "length"), ("velocity", "velocity"), ("angular_velocity", "angular_velocity"),
                         ("force", "force"), ("torque", "torque"), ("mass", "mass")):
            self.assertTrue(np.allclose(simulation.units[of] * getattr(bodies, name), last[name], rtol=1e-14, atol=0), name)
        for name in ("id", "kind", "image", "orientation"):
            self.assertTrue((getattr(bodies, name) == last[name]).all(), name)
        self.assertEqual(simulation.kinds, list(files.bodies.kinds))

    # ---- files ----

    def same_files(self, out, other):
        """All that two runs wrote is the same, but for what tells of the machine and of time."""
        self.assertEqual({path.name for path in out.iterdir()} - {"report.html"}, {path.name for path in other.iterdir()})
        a, b = silt_results.Run(out), silt_results.Run(other)
        self.assertEqual(a.report["state_hash"], b.report["state_hash"])
        for key in ("exit_reason", "steps", "quantities", "energy", "contacts", "covered"):
            self.assertEqual(a.report[key], b.report[key])
        for name in a.bodies.columns:
            self.assertTrue((a.bodies.columns[name] == b.bodies.columns[name]).all(), name)
        for left, right in zip(a.fields, b.fields):
            self.assertTrue((left["velocity"] == right["velocity"]).all())
        for name in ("steps", "energy.bodies", "quantities.height"):
            self.assertEqual(a.series[name][a.series["steps"] % 10 == 0].tolist(), b.series[name].tolist())  # a row more where it was broken off
        self.assertEqual((out / "series_course.csv").read_text(), (other / "series_course.csv").read_text())

    def test_it_writes_what_the_program_does(self):
        self.write(CASE.replace("[output]", "[output]\nreport = { every = 10 }") + '[[output.series]]\nname = "course"\nevery = 1\ncolumns = ["height"]\n')
        self.silt("run", self.case)
        out = self.case / "driven"
        with silt.Simulation(self.case, out=out) as simulation:
            while not simulation.ended:
                simulation.step()
            with self.assertRaisesRegex(ValueError, "step 60 was the last one.*raise run.steps"):
                simulation.step()
        self.same_files(out, self.out)
        log = (out / "run.log").read_text()
        self.assertRegex(log, r"^silt [^\n]*1 rank, 8 blocks,(?s:.*)kinematic viscosity(?s:.*)warning: bodies.0..shape(?s:.*)\nstep 60/60 ")
        done = subprocess.run([ROOT / "scripts/report", self.case, out], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Completed", (out / "report.html").read_text())
        broken_off = """
            import silt
            with silt.Simulation(".", out="driven", overwrite=True) as simulation:
                simulation.run(35)
            """
        for ranks in (1, 2):
            result = self.script(broken_off, ranks)
            self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))
            self.assertEqual((self.report(out)["exit_reason"], self.report(out)["exit_text"]), ("interrupted", "the program ended it at step 35"))
            self.silt("resume", self.case, "--out", out) if ranks == 2 else silt.Simulation(self.case, out=out, resume=True).run()
            (out / "checkpoint_000000000035.h5").unlink(missing_ok=True)
            (self.out / "checkpoint_000000000025.h5").unlink(missing_ok=True)
            self.same_files(out, self.out)

    def test_what_cannot_be_written_is_told(self):
        self.write(UNSTABLE)
        with self.assertRaisesRegex(silt.GuardStop, "coupling.time"), silt.Simulation(self.case, out=self.out) as simulation:
            simulation.run()
        self.assertEqual(self.report()["exit_reason"], "guard")
        for options, error, text in (({"overwrite": True}, ValueError, "overwrite and resume are of a folder of results: give out as well"),
                                     ({"out": self.case / "case.toml"}, silt.CaseError, "case.toml"),
                                     ({"out": self.case / "none", "resume": True}, silt.CaseError, "there is no checkpoint to go on from|none")):
            with self.assertRaisesRegex(error, text):
                silt.Simulation(self.case, **options)

    # ---- arrays ----

    def test_views_are_views(self):
        simulation = self.simulation(DRY)
        position, velocity = simulation.bodies.position, simulation.bodies.velocity
        self.assertEqual(position.__array_interface__["data"], simulation.bodies.position.__array_interface__["data"])
        simulation.set_velocity(2, [0.01, 0, 0], [0, 0, 0.1])
        self.assertEqual(velocity[1].tolist(), [0.01, 0, 0])
        simulation.step()
        self.assertAlmostEqual(position[1, 0], 24.01, delta=1e-12)
        turned = simulation.bodies.orientation[1]  # w, x, y, z
        self.assertTrue(np.allclose(turned, [np.cos(0.05), 0, 0, np.sin(0.05)], atol=1e-4), turned)
        simulation.set_pose(2, [20, 21, 22], orientation=[0, 0, 2, 0])
        self.assertEqual(position[1].tolist(), [20, 21, 22])
        self.assertEqual(simulation.bodies.orientation[1].tolist(), [0, 0, 1, 0])
        for name in ("id", "position", "velocity", "orientation", "force"):
            with self.assertRaisesRegex(ValueError, "read-only"):
                getattr(simulation.bodies, name)[...] = 0
        del simulation  # the arrays keep what they look at
        gc.collect()
        self.assertEqual(position[1].tolist(), [20, 21, 22])

    def test_numbers_of_the_interpreter_stay_as_they_are(self):
        smallest = sys.float_info.min
        simulation = self.simulation(CASE)
        simulation.run(2)
        self.assertGreater(smallest / 2, 0)  # the steps have none so small

    # ---- errors ----

    def test_errors_of_a_case_are_those_of_the_program(self):
        self.write(CASE.replace("radius = 2.5", "radios = 2.5"))
        said = self.silt("check", self.case, "--set", "fluid.relaxation_time=0.4", code=2).stderr
        with self.assertRaises(silt.CaseError) as error:
            silt.Simulation(self.case, set=["fluid.relaxation_time=0.4"])
        self.assertEqual(str(error.exception).strip(), said.strip())
        self.assertRegex(said, r"case.toml:\d+:\d+: .*did you mean 'radius'")
        self.assertIsInstance(error.exception, ValueError)
        self.write(CASE)
        for options, text in (({"set": ["run.steps="]}, "set: run.steps= has no value; to take a key away: --unset run.steps"),
                              ({"unset": ["run.steps=1"]}, "unset: 'run.steps=1' must be the path of a key")):
            with self.assertRaisesRegex(ValueError, text):
                silt.Simulation(self.case, **options)
        with self.assertRaisesRegex(silt.CaseError, "needs one of steps, time"):
            silt.Simulation(self.case, unset=["run.steps"])

    def test_errors_of_calls(self):
        simulation = self.simulation(CASE)
        before = simulation.hash()
        for call, text in ((lambda: simulation.add_force(7, [0, 0, 1]), "there is no body 7"),
                           (lambda: simulation.add_force(1, [0, 0, float("nan")]), "force is .*nan.*finite"),
                           (lambda: simulation.set_pose(1, [8, 8, 8], [0, 0, 0, 0]), "must be a quaternion"),
                           (lambda: simulation.field("velocty"), "no field 'velocty'; did you mean 'velocity'")):
            with self.assertRaisesRegex(ValueError, text):
                call()
        with self.assertRaises(TypeError):
            simulation.add_force(1, [0, 1])
        self.assertEqual(simulation.hash(), before)
        with self.assertRaisesRegex(ValueError, "no .fluid."):
            self.simulation(DRY).field("density")

    def test_changes_that_a_case_may_not_have_are_refused(self):
        """As a case file is: by the same words, on every rank, before anything is changed."""
        text = (domain_of([32, 32, 32], '{ x = "periodic", y = "periodic", z = ["no-slip", "no-slip"] }') +
                shape_of("ball", "sphere", "radius = 3") + body_of("ball", 2, "position = [8, 8, 8]") +
                body_of("ball", 2, 'motion = "fixed"\nposition = [24, 24, 16]') + "[run]\nsteps = 10\n")
        fluid = "[fluid]\nrelaxation_time = 0.8\n"
        places = (([8, 8, 2], r"position is \[8, 8, 2\]: the body reaches 1 into the lower wall of z; its z must be between 3 and 29"),
                  ([8, 8, 30], "the body reaches 1 into the upper wall of z"),
                  ([8, 8, -2], r"it must lie in the domain, \[0, 0, 0\] to \[32, 32, 32\]"),
                  ([33, 8, 8], "it must lie in the domain"),
                  ([24, 24, 14], r"position is \[24, 24, 14\]: the body overlaps body 2, at \[24, 24, 16\], by at least 4; move it away"))
        for position, words in places[:-1]:
            self.assertRegex(self.case_error(text.replace("[8, 8, 8]", str(position))), words)
        velocities = (([0.4, 0, 0], [0, 0, 0], "velocity is 0.4 cells a step; it must be at most 0.3: lower it to 0.1", True),
                      ([0, 0, 0], [0, 0.2, 0], "angular_velocity is 0.6 cells a step; it must be at most 0.3", True),
                      ([5, 0, 0], [0, 0, 0], "velocity: the body moves 5 cells in a step; beyond 3.5", False),
                      ([0, 0, 0], [0, 0, 4], "angular_velocity turns the body by 229.183 degrees in a step; at most 180 are possible", False))
        for wet in (True, False):
            simulation = self.simulation(text + wet * fluid)
            before = simulation.hash()
            for position, words in places:
                with self.assertRaisesRegex(ValueError, words):
                    simulation.set_pose(1, position)
            for velocity, turn, words, of_fluid in velocities:
                if of_fluid == wet:
                    with self.assertRaisesRegex(ValueError, words):
                        simulation.set_velocity(1, velocity, turn)
            for call, words in ((lambda: simulation.add_force(1, [0, 0, 1e30]), "force gives body 1 a velocity of .* cells a step in one step; at most"),
                                (lambda: simulation.add_force(1, [0, 0, 0.01 * MASS], [0, 1e9, 0]), "torque gives body 1 a velocity of"),
                                (lambda: simulation.set_velocity(1, [float("inf"), 0, 0]), "velocity is .inf.*finite"),
                                (lambda: simulation.set_pose(1, [8, 8, float("nan")]), "position is .*nan.*finite"),
                                (lambda: simulation.set_pose(2, [8, 24, 8]), "body 2 is fixed"),
                                (lambda: simulation.run(-1), "steps is -1; it must be at least 0")):
                with self.assertRaisesRegex(ValueError, words):
                    call()
            simulation.step()
            self.assertTrue((simulation.bodies.velocity == 0).all())  # of a force and a torque neither came
            simulation.set_pose(1, [8, 8, 3])  # on the floor
            simulation.set_velocity(1, [0.05, 0, 0], [0, 0.01, 0])
            simulation.run(5)
            self.assertNotEqual(simulation.hash(), before)

    def case_error(self, text):
        with self.assertRaises(silt.CaseError) as error:
            self.simulation(text)
        return str(error.exception)

    def test_a_place_that_moved_while_it_ran(self):
        """Bodies count where they are now, and a body that moves as its table says takes no velocity."""
        text = (domain_of([32, 32, 32]) + shape_of("ball", "sphere", "radius = 3") + body_of("ball", 2, "position = [8, 8, 8]") +
                body_of("ball", 2, 'name = "piston"\nmotion = { velocity = [0.5, 0, 0] }\nposition = [8, 24, 8]') + "[run]\nsteps = 10\n")
        simulation = self.simulation(text)
        with self.assertRaisesRegex(ValueError, r"overlaps body 2, at \[8, 24, 8\], by at least 6"):
            simulation.set_pose(1, [8, 24, 8])
        with self.assertRaisesRegex(ValueError, "body 2 moves as the table `motion` of 'piston' says"):
            simulation.set_velocity(2, [0, 0, 0])
        simulation.run(20)
        simulation.set_pose(1, [8, 24, 8])
        with self.assertRaisesRegex(ValueError, r"overlaps body 2, at \[18, 24, 8\], by at least 5"):
            simulation.set_pose(1, [17, 24, 8])

    def test_a_guard_stops_it(self):
        simulation = self.simulation(UNSTABLE)
        with self.assertRaisesRegex(silt.GuardStop, "step 2.*coupling.time"):
            simulation.run(60)

    def test_warnings(self):
        with warnings.catch_warnings(record=True) as found:
            warnings.simplefilter("always")
            silt.Simulation(self.case, set=["bodies[0].density=1e-2"])
        said = self.silt("check", self.case, "--set", "bodies[0].density=1e-2").stdout
        self.assertTrue(found and all(str(warning.message) in said for warning in found), (found, said))

    # ---- its page ----

    def test_the_program_of_its_page(self):
        """A sphere that its weight in the fluid is taken from stays where it is: let go, it falls 0.37 mm."""
        page = (ROOT / "silt/python/README.md").read_text()
        program = textwrap.dedent(re.search(r"\n\n((?:    .*\n|\n)+)", page[page.index("\n## A sphere held") :])[1])
        with contextlib.redirect_stdout(io.StringIO()) as said, contextlib.chdir(ROOT):
            exec(program, {})  # noqa: S102
        height, fastest = (float(line.split()[-1]) for line in said.getvalue().splitlines())
        self.assertAlmostEqual(height, 0.1275, delta=1e-8)
        self.assertLess(fastest, 1e-6)


if __name__ == "__main__":
    unittest.main()
