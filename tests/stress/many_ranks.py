#!/usr/bin/python3
"""many_ranks SILT: bodies in places that only many ranks have, and the state they lead to, the same to the
bit as that of one rank.

One that touches 27 ranks, one five times as large as a subdomain, eight in contact at a corner of eight
ranks, bodies that cross a subdomain in a few steps, ranks without a cell of fluid or a body; on equal cuts
and on those that load balance makes.
"""
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from silt_runs import run_text  # noqa: E402, I001
from case_text import case_text, cube, sphere  # noqa: E402

SILT = sys.argv.pop(1)


class ManyRanks(unittest.TestCase):
    def same(self, text, *ranks, balanced_on=0):
        alone = run_text(SILT, text)[1]
        for n, options in [(n, []) for n in ranks] + [(balanced_on, ["--set", "run.balance.every=7"])] * (balanced_on > 0):
            found = run_text(SILT, text, *options, ranks=n)[1]
            self.assertEqual(found["state_hash"], alone["state_hash"], f"{n} ranks")
            self.assertEqual(found["bodies"], alone["bodies"])
        return alone

    def test_one_body_touches_27_ranks_and_others_go_round_it(self):
        ring = [[x, y, z] for x in (3, 27) for y in (3, 27) for z in (3, 27)]
        text = case_text("A ball over 27 ranks", domain=cube(30), fluid=dict(relaxation_time=0.7),
                         shapes=[sphere(19, "large"), sphere(5, "small")],
                         bodies=[dict(shape="large", density=1.1, position=[15, 15, 15], velocity=[0.03, 0.02, 0.01],
                                      angular_velocity=[0, 0, 3e-3]),
                                 dict(shape="small", density=2, positions=ring, velocity=[-0.02, 0.01, 0.03])],
                         run=dict(steps=60))
        self.same(text, 64, balanced_on=27)

    def test_a_body_is_five_times_as_large_as_a_subdomain(self):
        text = case_text("A rod over many ranks", domain=dict(size=[60, 16, 16], boundary=dict(x="periodic", y="no-slip", z="no-slip")),
                         fluid=dict(relaxation_time=0.8), gravity=dict(acceleration=[0, 0, -1e-5]),
                         shapes=[dict(name="rod", type="capsule", radius=3, length=40)],
                         bodies=[dict(shape="rod", density=3, position=[30, 6, 9], orientation=[1, 0.05, 0.02], velocity=[0.02, 0, 0.01]),
                                 dict(shape="rod", density=3, motion="fixed", position=[30, 13, 3.5], orientation=[1, 0, 0])],
                         run=dict(steps=40))
        self.same(text, 27)

    def test_eight_bodies_meet_at_a_corner_of_eight_ranks(self):
        places = [[x, y, z] for x in (13, 19) for y in (13, 19) for z in (13, 19)]
        text = case_text("Eight balls at a corner", domain=cube(32), contacts=dict(restitution=0, friction=0.3),
                         shapes=[sphere(5.9)],
                         bodies=[dict(shape="sphere", density=2, position=p, velocity=[0.01 * (16 - x) for x in p],
                                      angular_velocity=[0.01, 0.002 * i, -0.01]) for i, p in enumerate(places)],
                         run=dict(steps=200))
        found = self.same(text, 64, balanced_on=8)
        self.assertGreater(found["contacts"], 200)

    def test_bodies_cross_a_subdomain_in_a_few_steps(self):
        text = case_text("Fast balls", domain=cube(32), contacts=dict(margin=4, restitution=0.9), shapes=[sphere(4)],
                         fill=[dict(shape="sphere", density=1, count=30, velocity=v) for v in ([1.5, 0.3, 0.2], [-1, -1.2, 0.5])],
                         run=dict(steps=100))
        self.same(text, 64)

    def test_ranks_without_fluid_or_bodies(self):
        text = case_text("A thin pipe in a large box", domain=dict(size=[40, 40, 8], boundary="periodic"),
                         fluid=dict(relaxation_time=0.8, body_force=[0, 0, 1e-5]),
                         walls=[dict(name="pipe", type="tube", radius=5, point=[20, 20, 0], axis=[0, 0, 1])],
                         shapes=[sphere(4)], bodies=[dict(shape="sphere", density=1.5, position=[20, 18, 4])], run=dict(steps=40))
        self.same(text, 25)


if __name__ == "__main__":
    unittest.main()
