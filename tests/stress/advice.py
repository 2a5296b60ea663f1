#!/usr/bin/python3
"""advice SILT: what a guard advises, given with --set, cures the run that it stopped."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SILT = sys.argv.pop(1)

FLUID = """[units]
system = "lattice"
[domain]
size = [24, 24, 24]
boundary = "periodic"
[fluid]
relaxation_time = 0.8
"""
DRY = FLUID.split("[fluid]")[0]
BALL = """[[shapes]]
name = "ball"
type = "sphere"
radius = 3
[[bodies]]
shape = "ball"
density = {density}
position = [12.2, 12.1, 12]
"""
RUN = "[run]\nsteps = 300\n"
FALL = "[gravity]\nacceleration = [0, 0, -{g}]\n"
SI = """[units]
system = "si"
cell_size = 1e-3
time_step = 1e-3
[domain]
size = [24e-3, 24e-3, 24e-3]
boundary = "periodic"
[fluid]
density = 1000
kinematic_viscosity = 1e-4
body_force = [2, 0, 0]
"""
GAS = DRY + """[contacts]
restitution = 1
margin = 0.2
resolver = "ffd"
[[shapes]]
name = "ball"
type = "sphere"
radius = 1
""" + "".join(f'[[fill]]\nshape = "ball"\ndensity = 1\ncount = 40\ngap = 0.1\nvelocity = {v}\n' for v in (
    "[0.01, 0, 0]", "[-0.01, 5e-3, 0]", "[0, -0.01, 5e-3]", "[3e-3, 0, -0.01]")) + "[run]\nsteps = 1000\n"

# cause: the case, what is advised, the advice taken
ADVICE = {
    "flow of low viscosity": (
        FLUID.replace("0.8", "0.501\ninitial = { type = 'shear-layer', velocity = [0.1, 0, 0], steepness = 30 }").replace(
            "[24, 24, 24]", "[64, 64, 2]") + "[run]\nsteps = 1500\n",
        'use fluid.collision = "regularised"', ["fluid.collision=regularised"]),
    "flow driven too hard": (
        FLUID + "body_force = [2e-3, 0, 0]\n" + RUN,
        "lower what drives it (fluid.body_force)", ["fluid.body_force=[2e-4, 0, 0]"]),
    "flow too fast for the time step": (
        SI + "[run]\ntime = 0.3\n", "use a smaller units.time_step, or lower what drives it (fluid.body_force)", ["units.time_step=2e-4"]),
    "the same, with steps given by the relaxation time": (
        SI.replace("time_step = 1e-3", "relaxation_time = 0.8") + "[run]\ntime = 0.3\n", "use a smaller units.relaxation_time",
        ["units.relaxation_time=0.56"]),
    "the same, with steps given by a velocity": (
        SI.replace("time_step = 1e-3", "max_velocity = 0.05") + "[run]\ntime = 0.3\n", "use a larger units.max_velocity",
        ["units.max_velocity=0.25"]),
    "light body coupled explicitly": (
        FLUID + '[coupling]\ntime = "explicit"\n' + FALL.format(g="1e-4") + BALL.format(density=0.05) + RUN,
        'use coupling.time = "implicit"', ["coupling.time=implicit"]),
    "body that takes the fluid with it as it falls": (
        FLUID + FALL.format(g="1e-3") + BALL.format(density=20) + RUN.replace("300", "6000"),
        "gravity.acceleration", ["gravity.acceleration=[0, 0, -1e-4]"]),
    "body that falls too fast without a fluid": (
        DRY + FALL.format(g="2e-2") + BALL.format(density=1) + RUN.replace("300", "200"),
        "use contacts.substeps = 2", ["contacts.substeps=2"]),
    "contacts that make energy": (GAS, 'use "sffd"', ["contacts.resolver=sffd"]),
}


class Advice(unittest.TestCase):

    def run_case(self, text, *settings):
        with tempfile.TemporaryDirectory(prefix="silt-advice-") as folder:
            (pathlib.Path(folder) / "case.toml").write_text(text)
            done = subprocess.run([SILT, "run", folder, *(a for s in settings for a in ("--set", s))], capture_output=True,
                                  text=True, timeout=120)
            return done.returncode, done.stderr

    def test_every_advice_cures(self):
        for cause, (text, advised, settings) in ADVICE.items():
            with self.subTest(cause):
                code, errors = self.run_case(text)
                self.assertEqual(code, 3, errors)
                self.assertIn(advised, errors)
                code, errors = self.run_case(text, *settings)
                self.assertEqual(code, 0, errors)


if __name__ == "__main__":
    unittest.main()
