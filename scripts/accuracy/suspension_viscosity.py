"""Spheres as heavy as the fluid in plane shear: the viscosity of dilute and less dilute suspensions.

The mean shear stress on both walls, of the fluid and of spheres that touch them or have films with them, over that of the fluid alone, from
the strain FROM on (cases/sheared-suspension is the same scene). Reynolds number of the shear and the radius 0.15, no friction.
Laws, of the solid fraction phi:
    einstein   1 + 2.5 phi                                    dilute
    batchelor  1 + 2.5 phi + 5.2 phi^2                        G. K. Batchelor, J. T. Green, J. Fluid Mech. 56 (1972) 401: pairs, shear
    krieger    (1 - phi / 0.64)^(-1.6)                        I. M. Krieger, T. J. Dougherty, Trans. Soc. Rheology 3 (1959) 137
    zarraga    exp(-2.34 phi) / (1 - phi / 0.62)^3            I. E. Zarraga, D. A. Hill, D. T. Leighton, J. Rheology 44 (2000) 185
intrinsic is (viscosity - 1 - 5.2 phi^2) / phi, Einstein's 2.5. Walls keep spheres half a diameter away, so the fluid beside them is
thinner, and one suspension is not a mean over many. The shear spreads from the walls as exp(-4 pi^2 nu t / H^2), by e a strain: a
mean from a strain of 2 to 5 would be 6 % too high, that from 5 on is 0.1 %, that of the short form 0.7 %.
"""
import math

from case_text import case_text, sphere
from problem import Claim, Found, Goal, Run

DIAMETER, SIZE, SPEED, RELAXATION_TIME = 8, (40, 40, 64), 0.05, 1.0  # cells; of each wall, cells a step
COUNTS = (8, 19, 38, 76)
FROM, TO = 5, 20                             # strains
SHORT_FROM, SHORT_TO = 5, 7
STRAIN = SIZE[2] / (2 * SPEED)               # steps
LAWS = {"einstein": lambda phi: 1 + 2.5 * phi,
        "batchelor": lambda phi: 1 + 2.5 * phi + 5.2 * phi**2,
        "krieger": lambda phi: (1 - phi / 0.64) ** -1.6,
        "zarraga": lambda phi: math.exp(-2.34 * phi) / (1 - phi / 0.62) ** 3}


def solid_fraction(count):
    return count * math.pi / 6 * DIAMETER**3 / math.prod(SIZE)


GOALS = [Goal("accuracy.suspension_viscosity.n8.intrinsic", 12), Goal("accuracy.suspension_viscosity.n8.einstein", 1),
         Goal("accuracy.suspension_viscosity.n19.batchelor", 2), Goal("accuracy.suspension_viscosity.n19.krieger", 2),
         Goal("accuracy.suspension_viscosity.n38.krieger", 5), Goal("accuracy.suspension_viscosity.n76.krieger", 5),
         *(Goal(f"accuracy.suspension_viscosity.n{n}.zarraga", 3) for n in COUNTS[1:])]
SHORT_GOALS = [Goal("accuracy.suspension_viscosity.n19.short.batchelor", 4)]
SOURCES = {"einstein": dict(source="Einstein, Ann. Phys. 324 (1906) 289", doi="10.1002/andp.19063240204"),
           "batchelor": dict(source="Batchelor, Green, J. Fluid Mech. 56 (1972) 401", doi="10.1017/S0022112072002435"),
           "krieger": dict(source="Krieger, Dougherty, Trans. Soc. Rheology 3 (1959) 137, maximum 0.64", doi="10.1122/1.548848"),
           "zarraga": dict(source="Zarraga, Hill, Leighton, J. Rheology 44 (2000) 185, a fit to measurements", doi="10.1122/1.551083",
                           kind="experiment")}
NOTE = ("laws differ by 10 % at phi = 0.2: films between spheres and with the walls add 0.15; the fit to measurements of spheres in "
        "viscous liquids is met")
CLAIMS = {"accuracy.suspension_viscosity.n{N}.intrinsic": Claim(
    "intrinsic viscosity", "{N} spheres in shear, Re = 0.15", f"D = {DIAMETER}", **SOURCES["einstein"], expected=2.5)}
for name in LAWS:
    for form in ("n{N}", "n{N}.short"):
        CLAIMS[f"accuracy.suspension_viscosity.{form}.{name}"] = Claim(
            "viscosity over the fluid's", "{N} spheres in shear, Re = 0.15", f"D = {DIAMETER}", **SOURCES[name], note=NOTE,
            expected=lambda N, law=LAWS[name]: law(solid_fraction(int(N))))


def run_of(count, start=FROM, end=TO):
    wall = [dict(type="moving", velocity=[sign * SPEED, 0, 0]) for sign in (-1, 1)]
    text = case_text(
        f"{count} spheres in shear, {solid_fraction(count):.3f} solid", domain=dict(size=SIZE, boundary=dict(x="periodic", y="periodic", z=wall)),
        fluid=dict(relaxation_time=RELAXATION_TIME), contacts=dict(friction=0.0), shapes=[sphere(DIAMETER)],
        fill=[dict(shape="sphere", density=1, count=count, gap=0.3, seed=1)], run=dict(steps=round(end * STRAIN)),
        quantities=[dict(name="viscosity", type="relative-viscosity", axis="z", time=round(start * STRAIN))])
    return Run(f"n{count}" + ("" if end == TO else ".short"), text, dict(D=DIAMETER, count=count))


def runs(level):
    return [run_of(COUNTS[1], SHORT_FROM, SHORT_TO)] if level == "short" else [run_of(count) for count in COUNTS]


def measure(run, outcome):
    return dict(viscosity=outcome.quantity("viscosity"))


def figures(measured):
    found = {}
    for key, m in measured.items():
        phi, name = solid_fraction(int(key.split(".")[0][1:])), f"accuracy.suspension_viscosity.{key}"
        for law, value in LAWS.items():
            found[f"{name}.{law}"] = Found(100 * (m["viscosity"] / value(phi) - 1), (key,))
        intrinsic = (m["viscosity"] - 1 - 5.2 * phi**2) / phi
        found[f"{name}.intrinsic"] = Found(100 * (intrinsic / 2.5 - 1), (key,))
    return found
