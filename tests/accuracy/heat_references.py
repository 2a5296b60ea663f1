#!/usr/bin/python3
"""The computed references of heat against what others published."""
import csv
import pathlib
import sys
import unittest

ACCURACY = pathlib.Path(__file__).resolve().parent.parent.parent / "scripts" / "accuracy"
sys.path[:0] = [str(ACCURACY), str(ACCURACY.parent)]

import cavity_convection  # noqa: E402
import heat_laws  # noqa: E402
import lattice_conduction  # noqa: E402
import sphere_convection  # noqa: E402

# Sangani, Acrivos, Proc. R. Soc. A 386 (1983) 263: k = 1 - 3 phi / D, with c_1 to c_6 in
# D = -1/b_1 + phi + c_1 b_3 phi^(10/3) (1 + c_2 b_5 phi^(11/3)) / (1 - c_3 b_3 phi^(7/3))
#     + c_4 b_5 phi^(14/3) + c_5 b_7 phi^6 + c_6 b_9 phi^(22/3); b_n = 1 where spheres conduct, -n / (n + 1) where they insulate
SERIES = {"SC": (1.305, 0.231, 0.405, 0.0723, 0.153, 0.0105), "BCC": (0.129, -0.413, 0.764, 0.257, 0.0113, 0.00562),
          "FCC": (0.0753, 0.697, -0.741, 0.2419, 0.0231, 9.14e-7)}
# c_4 of the face-centred array is quoted as 0.0420 (Andrianov, Topol, arXiv 1106.1783). It goes as the square of a sum over the lattice times
# volume^(14/3), as those of the other two arrays do and 0.0420 does not.


def by_series(name, conducting, phi):
    c1, c2, c3, c4, c5, c6 = SERIES[name]
    b = {n: 1 if conducting else -n / (n + 1) for n in (1, 3, 5, 7, 9)}
    poles = c1 * b[3] * phi**(10 / 3) * (1 + c2 * b[5] * phi**(11 / 3)) / (1 - c3 * b[3] * phi**(7 / 3))
    return 1 - 3 * phi / (-1 / b[1] + phi + poles + c4 * b[5] * phi**(14 / 3) + c5 * b[7] * phi**6 + c6 * b[9] * phi**(22 / 3))


class Arrays(unittest.TestCase):
    def test_agree_with_the_published_series(self):
        with open(lattice_conduction.REFERENCE) as stream:
            rows = list(csv.DictReader(line for line in stream if not line.startswith("#")))
        self.assertEqual(len(rows), 30)
        for row in rows:
            phi = float(row["phi"])
            if phi < 0.35:
                series = by_series(row["array"], row["spheres"] == "conducting", phi)
                self.assertLess(abs(float(row["conductivity"]) / series - 1), 2e-6 if phi < 0.25 else 2e-4, row)

    def test_fourth_coefficients_go_as_sums_over_the_lattice(self):
        sums = {name: lattice_conduction.Array(name) for name in SERIES}
        scale = {name: array.lattice_sum(6, 0)**2 * array.volume**(14 / 3) for name, array in sums.items()}
        for name, series in SERIES.items():
            self.assertAlmostEqual(series[3] / SERIES["SC"][3] / (scale[name] / scale["SC"]), 1, places=2)

    def test_the_table_is_what_the_script_computes(self):
        array = lattice_conduction.Array("BCC")
        self.assertAlmostEqual(array.conductivity(0.2, False, 9), 0.72720255, places=7)
        self.assertAlmostEqual(array.conductivity(0.2, True, 9), 1.75071031, places=6)

    def test_sums_do_not_depend_on_where_they_are_parted(self):
        found = []
        for lattice_conduction.SPLIT in (1.8, 2.4):
            found.append(lattice_conduction.Array("FCC").lattice_sum(4, 4))
        self.assertAlmostEqual(*found, places=10)


class Sphere(unittest.TestCase):
    def test_drag_and_heat_at_reynolds_number_20(self):
        """Drag as Dennis, Walker (1971) and Le Clair et al. (1970) have it, 2.73 and 2.74; heat between laws."""
        flow = sphere_convection.Flow(sphere_convection.Grid(50, 36), 20)
        self.assertAlmostEqual(flow.drag(), 2.735, delta=0.05)
        laws = [law(20, 0.7) for law in heat_laws.LAWS.values()]
        self.assertTrue(min(laws) < flow.nusselt(0.7) < max(laws))

    def test_conduction_alone(self):
        flow = sphere_convection.Flow(sphere_convection.Grid(50, 36), 1)
        self.assertAlmostEqual(flow.nusselt(1e-4), 2, delta=0.04)


class Cavity(unittest.TestCase):
    def test_agrees_with_de_vahl_davis(self):
        cavity = cavity_convection.Cavity(16)
        cavity.solve(10**4)
        for found, published in zip(cavity.found(), cavity_convection.DE_VAHL_DAVIS[10**4]):
            self.assertLess(abs(found / published - 1), 2e-3)


if __name__ == "__main__":
    unittest.main()
