#!/usr/bin/python3
"""The problems of moving bodies read what they should out of series whose answer is known. One argument: the
source tree."""
import math
import pathlib
import sys
import tomllib
import unittest
from types import SimpleNamespace

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "scripts" / "accuracy"), str(ROOT / "scripts")]
import drafting_kissing_tumbling as dkt  # noqa: E402
import hindered_settling  # noqa: E402
import jeffery  # noqa: E402
import settling_array  # noqa: E402
import tencate  # noqa: E402
import wet_rebound  # noqa: E402


def outcome(step, time=None, **arrays):
    """Returns the outcome of a run whose bodies.h5 holds these columns [time, body, ...]."""
    return SimpleNamespace(bodies=SimpleNamespace(step=step, time=time, array=lambda name: arrays[name]))


class Jeffery(unittest.TestCase):
    def orbit(self, shape, reynolds):
        """Jeffery's own, from where the run starts: tan(angle) = r tan(G t r / (r^2 + 1))."""
        run = jeffery.run_of(shape, reynolds, 8)
        ratio, rate = jeffery.SHAPES[shape], jeffery.shear_rate(reynolds, 8)
        step = np.arange(0, run.settings["start"] + int(1.1 * jeffery.half_turn(ratio, rate)), 5)
        phase = math.atan(math.tan(0.3) / ratio) + rate * ratio / (ratio**2 + 1) * step
        angle = np.arctan2(ratio * np.sin(phase), np.cos(phase))
        half = (angle + 0) / 2
        # z turned from y by the angle towards x: first z to y (-90 degrees about x), then by -angle about z
        s = math.sqrt(0.5)
        orientation = np.stack([s * np.cos(half), -s * np.cos(half), s * np.sin(half), -s * np.sin(half)], -1)
        return run, outcome(step, orientation=orientation[:, None])

    def test_period_of_its_own_orbit(self):
        for shape in jeffery.SHAPES:
            run, series = self.orbit(shape, 0.2)
            self.assertLess(abs(jeffery.measure(run, series)["error"]), 0.02, shape)

    def test_drawn_out_to_no_inertia(self):
        measured = {f"oblate.d8.re{re:g}": dict(error=0.7 + 3 * re) for re in jeffery.REYNOLDS}
        found = jeffery.figures(measured)
        self.assertAlmostEqual(found["accuracy.jeffery.oblate.error"].value, 0.7)
        self.assertNotIn("accuracy.jeffery.prolate.error", found)


class HinderedSettling(unittest.TestCase):
    def test_exponent_of_a_law(self):
        measured = {}
        for count in hindered_settling.COUNTS:
            phi = hindered_settling.solid_fraction(count)
            measured[f"n{count}"] = dict(velocity=0.9 * (1 - phi)**5.0 - hindered_settling.larger_box(count))
        found = hindered_settling.figures(measured)
        self.assertAlmostEqual(found["accuracy.hindered_settling.exponent"].value, 5.0)
        self.assertAlmostEqual(found["accuracy.hindered_settling.exponent.prefactor"].value, 0.9)
        self.assertAlmostEqual(found["accuracy.hindered_settling.exponent.outside"].value, 5.0 - 4.88)

    def test_one_sphere_lacks_what_a_cubic_array_lacks(self):
        count, settling = 1, hindered_settling
        phi = settling.solid_fraction(count)
        self.assertAlmostEqual(settling.larger_box(count), 1.7601 * phi**(1 / 3), delta=0.02)

    def test_a_fifth_of_solid(self):
        # 1.7601 (0.2011 / 48)^(1/3) = 0.2838, structure factor 0.2109, viscosity 1.83 times the fluid's
        self.assertAlmostEqual(hindered_settling.larger_box(48), 0.2838 * 0.2109 / 1.83, delta=2e-4)


class SettlingArray(unittest.TestCase):
    def test_nothing_pulls_on_the_whole(self):
        for ratio in settling_array.RATIOS:
            case = tomllib.loads(settling_array.run_of(ratio, 1.0).case)
            fluid, body = (np.array(case[section][key]) for section, key in
                           (("fluid", "body_force"), ("gravity", "acceleration")))
            volume = math.pi / 6 * 8**3
            pull = (ratio - 1) * volume * body  # gravity acts on bodies less their buoyancy
            self.assertGreater(np.linalg.norm(pull), 1e-4)
            self.assertLess(np.linalg.norm(pull + (16**3 - volume) * fluid), 1e-12)


class WetRebound(unittest.TestCase):
    def bounce(self, start):
        """Free flight by tenths of the diameter: down at 1, up at 0.6."""
        time = np.arange(0, 2 * start, 0.03)
        gap = np.where(time < start, start - time, 0.6 * (time - start))
        return gap, np.where(time < start, -1.0, 0.6)

    def test_speeds_at_the_gap(self):
        before, after = wet_rebound.rebound(*self.bounce(1.0))
        self.assertAlmostEqual(before, 1.0)
        self.assertAlmostEqual(after, 0.6)

    def test_no_way_back(self):
        gap, velocity = self.bounce(1.0)
        shown = slice(0, int(np.argmin(gap)) + 2)
        self.assertEqual(wet_rebound.rebound(gap[shown], velocity[shown])[1], 0.0)

    def test_terminal_velocity_of_gondrets_ball(self):
        # Reynolds number 110 in the list of reference/04_wet_rebound.toml
        ball, diameter, density, mu = wet_rebound.BALLS["st90"]
        reynolds = density * wet_rebound.terminal_velocity(ball, diameter, density, mu) * diameter / mu
        self.assertAlmostEqual(reynolds, 110, delta=6)


class TenCate(unittest.TestCase):
    def test_worst_of_the_offsets(self):
        measured = {f"e4.d6.{k}": dict(velocity=1.0, error=e) for k, e in enumerate((0.3, -0.9, 0.5))}
        found = tencate.figures(measured)
        self.assertEqual(found["accuracy.tencate.e4.d6.error"].value, -0.9)
        self.assertAlmostEqual(found["accuracy.tencate.e4.d6.spread"].value, 1.4)

    def test_against_the_finest(self):
        found = tencate.figures({"e1.d24.0": dict(velocity=2.0, error=0), "e1.d9.0": dict(velocity=2.02, error=1)})
        self.assertAlmostEqual(found["accuracy.tencate.e1.d9.to_finest"].value, 1.0)


class DraftingKissingTumbling(unittest.TestCase):
    def series(self, overtakes):
        """The upper sphere faster by 0.02 m/s from 0.1 s on, until they touch at 0.2 s; then the line of
        centres turns."""
        time = np.arange(0, 0.65, 1e-3)
        d = dkt.PAPERS_START.diameter
        gap = 1.2 * d * np.clip(1 - (time - 0.1) / 0.1, 0, 1)
        angle = np.where(time > 0.2, 4 * (time - 0.2), 0) if overtakes else 0 * time
        apart = (d + np.where(time < 0.1, 1.2 * d, gap))[:, None] * np.stack([np.sin(angle), 0 * time, np.cos(angle)], -1)
        speed = np.stack([0.05 + 0.02 * ((time > 0.1) & (time < 0.2)), 0.05 + 0 * time], -1)
        zero = np.zeros_like(apart)
        return outcome(None, time, position=np.stack([apart, zero], 1),
                       velocity=np.stack([np.zeros_like(speed), np.zeros_like(speed), -speed], -1))

    def test_times_of_the_phases(self):
        m = dkt.measure(dkt.run_of(dkt.COARSE), self.series(True))
        self.assertAlmostEqual(m["drafting"], 0.101, places=6)
        self.assertAlmostEqual(m["kissing"], 0.2 - 0.1 * 0.05 / 1.2, delta=1.1e-3)
        self.assertAlmostEqual(m["tumbling"], 0.2 + math.pi / 16, delta=1.1e-3)
        self.assertEqual(dkt.figures({"d9": m, "d12": m})["accuracy.dkt.order"].value, 1)

    def test_no_tumbling_is_seen(self):
        m = dkt.measure(dkt.run_of(dkt.COARSE), self.series(False))
        self.assertEqual(dkt.figures({"d9": m, "d12": m})["accuracy.dkt.order"].value, 0)


if __name__ == "__main__":
    unittest.main()
