#!/usr/bin/python3
"""Linear analysis: no wall scheme amplifies, and what does is seen to; uniform flow at the default magics."""
import pathlib
import sys
import unittest
import unittest.mock

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent / "scripts" / "accuracy"))

import numpy as np  # noqa: E402

import linear_modes as modes  # noqa: E402

MAGIC = 2 / 15  # of multireflection by default
DISTANCES = ((0.02, 0.02), (0.5, 0.5), (0.8, 0.8), (1, 1), (1, 0.1))


class Growth(unittest.TestCase):
    def expect_none(self, scheme, magic, taus):
        """At each relaxation time with two pairs of wall distances, in turn."""
        for k, tau in enumerate(taus):
            for distances in (DISTANCES[k % 5], DISTANCES[(k + 2) % 5]):
                with self.subTest(scheme=scheme, magic=magic, tau=tau, distances=distances):
                    self.assertLess(modes.growth(scheme, tau, magic, distances), 1e-12)

    def test_none_with_any_scheme(self):
        for scheme, magic in (("cli", 1 / 6), ("parabolic", 1 / 16), ("multireflection", MAGIC), ("multireflection", 1 / 6)):
            self.expect_none(scheme, magic, (0.502, 0.52, 0.53, 0.55, 0.7, 0.77, 1, 3))

    def test_none_where_the_collision_is_regularised(self):
        for scheme in ("cli", "parabolic", "multireflection"):
            self.expect_none(scheme, modes.REGULARISED, (0.5005, 0.523, 0.55, 0.58, 0.9, 3))

    def test_is_seen_where_all_of_multireflection_is_taken_at_low_viscosity(self):
        self.assertGreater(modes.growth("multireflection", 0.6, MAGIC, (0.3, 0.3), share=1), 1e-3)

    def test_is_seen_where_the_excess_goes_by_weights_alone(self):
        with unittest.mock.patch.object(modes, "without_excess", lambda tau: (-modes.W, np.eye(19))):
            self.assertGreater(modes.growth("cli", 0.505, 1 / 6, (0.8, 0.8)), 1e-3)

    def test_walls_keep_mass(self):
        for keeps, largest in ((True, 1e-13), (False, None)):
            matrix = modes.step("cli", 0.6, MAGIC, (0.3, 0.8), (0, 0), 5, keeps_mass=keeps)
            change = np.abs(matrix.sum(axis=0) - 1).max()
            self.assertLess(change, largest) if keeps else self.assertGreater(change, 0.1)

    def test_is_seen_below_the_magic(self):
        with unittest.mock.patch.object(modes, "EXCESS", -0.05):
            self.assertGreater(modes.growth("cli", 1, MAGIC, (0.02, 0.02)), 1e-3)

FAST = np.array((0.1, 0, 0))


class ShearWaves(unittest.TestCase):

    def test_feel_what_equation_21_says(self):
        for magic in (1 / 16, MAGIC, 1 / 6):
            for direction, velocity, slope in (((1, 0, 0), (0, 1, 0), 2 / 3), ((1, 1, 0), (0, 0, 1), 1 / 6),
                                               ((1, 1, 1), (1, 1, -2), 2 / 3)):
                self.assertAlmostEqual(modes.shear_wave(direction, velocity, magic), 1 / 18 + (1 / 6 - magic) * slope, delta=2e-4)

    def test_matrices_keep_mass(self):
        for model in (MAGIC, modes.REGULARISED):
            self.assertTrue(np.allclose(modes.collision(0.8, model).sum(axis=0), 1))

    def test_feel_with_regularised_what_its_magic_says(self):
        for tau in (0.51, 0.55, 0.7, 1):
            magic = modes.magic_of(modes.REGULARISED, tau)
            self.assertAlmostEqual(modes.shear_wave((1, 0, 0), (0, 1, 0), modes.REGULARISED, tau),
                                   1 / 18 + (1 / 6 - magic) * 2 / 3, delta=2e-4)


class UniformFlow(unittest.TestCase):

    def test_is_stable_at_a_cell_reynolds_number_of_20_with_the_magic_of_multireflection(self):
        for flow in modes.FLOWS:
            self.assertLess(modes.uniform_growth(flow, 20, MAGIC), modes.NOTICED, flow)

    def test_is_stable_at_3000_where_the_collision_is_regularised(self):
        for flow in modes.FLOWS:
            self.assertLess(modes.uniform_growth(flow, 3000, modes.REGULARISED), modes.NOTICED, flow)

    def test_is_not_with_that_of_parabolic(self):
        for flow in modes.FLOWS:
            self.assertGreater(modes.uniform_growth(flow, 20, 1 / 16), modes.NOTICED, flow)


class Outlets(unittest.TestCase):

    def test_let_waves_out_at_any_viscosity(self):
        for flow, number in ((FAST, 20), (FAST, 200), (FAST / 2, 2000), (np.array((0.07, 0.07, 0)), 200)):
            self.assertLess(modes.outlet_growth(flow, number), modes.NOTICED, (flow, number))

    def test_of_anti_bounce_back_do_not(self):
        self.assertGreater(modes.outlet_growth(FAST, 20, 1), 1e-3)
        self.assertLess(modes.outlet_growth(FAST, 15, 1), modes.NOTICED)


if __name__ == "__main__":
    unittest.main()
