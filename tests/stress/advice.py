#!/usr/bin/python3
"""advice SILT: what a guard advises, given with --set, cures the run that it stopped."""
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from silt_runs import body_of, domain_of, fill_of, run_text, shape_of  # noqa: E402

SILT = sys.argv.pop(1)

DRY = domain_of([24, 24, 24])
FLUID = DRY + "[fluid]\nrelaxation_time = 0.8\n"
RUN = "[run]\nsteps = 300\n"
SI = ('[units]\nsystem = "si"\ncell_size = 1e-3\ntime_step = 1e-3\n' +
      '[domain]\nsize = [24e-3, 24e-3, 24e-3]\nboundary = "periodic"\n' +
      "[fluid]\ndensity = 1000\nkinematic_viscosity = 1e-4\nbody_force = [2, 0, 0]\n")
GAS = (DRY + '[contacts]\nrestitution = 1\nmargin = 0.2\nresolver = "ffd"\n' + shape_of("ball", "sphere", "radius = 1") +
       "".join(fill_of("ball", 1, 40, "gap = 0.1", f"velocity = {v}")
               for v in ("[0.01, 0, 0]", "[-0.01, 5e-3, 0]", "[0, -0.01, 5e-3]", "[3e-3, 0, -0.01]")) + "[run]\nsteps = 1000\n")


def ball(density):
    return shape_of("ball", "sphere", "radius = 3") + body_of("ball", density, "position = [12.2, 12.1, 12]")


def fall(g):
    return f"[gravity]\nacceleration = [0, 0, -{g}]\n"


# cause: the case, what is advised, the advice taken
ADVICE = {
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
        FLUID + '[coupling]\ntime = "explicit"\n' + fall("1e-4") + ball(0.05) + RUN,
        'use coupling.time = "implicit"', ["coupling.time=implicit"]),
    "body that takes the fluid with it as it falls": (
        FLUID + fall("1e-3") + ball(20) + RUN.replace("300", "6000"),
        "gravity.acceleration", ["gravity.acceleration=[0, 0, -1e-4]"]),
    "body that falls too fast without a fluid": (
        DRY + fall("2e-2") + ball(1) + RUN.replace("300", "200"),
        "use contacts.substeps = 2", ["contacts.substeps=2"]),
    "contacts that make energy": (GAS, 'use "sffd"', ["contacts.resolver=sffd"]),
}


class Advice(unittest.TestCase):

    def test_every_advice_cures(self):
        for cause, (text, advised, settings) in ADVICE.items():
            with self.subTest(cause):
                self.assertIn(advised, run_text(SILT, text, code=3, timeout=120)[0].stderr)
                run_text(SILT, text, *(a for s in settings for a in ("--set", s)), timeout=120)


if __name__ == "__main__":
    unittest.main()
