"""Published drag laws of random arrays of equal spheres: K = F / (6 pi mu a U), F with the mean pressure gradient's share.

U is the superficial velocity, Re = 2 a U / nu. Formulas, sources, ranges and the conventions of the papers are in
reference/02_random_array_drag.toml. At Re = 0 the laws differ by 7 to 16 %, at Re = 100 by some 25 %.
"""
import math


def hill_koch_ladd(phi, Re=0.0):
    """Hill, Koch and Ladd (2001), as Benyahia, Syamlal and O'Brien (2006) extend it."""
    R, F0, F2 = Re / 2, hill_polynomial(phi, 17.14, -8.48, 8.16), hill_polynomial(phi, 17.89, -11.03, 15.41)
    F1 = 0.11 + 0.00051 * math.exp(11.6 * phi) if phi >= 0.1 else math.sqrt(2 / phi) / 40
    F3 = 0.0673 + 0.212 * phi + 0.0232 / (1 - phi)**5
    change = (F3 + math.sqrt(F3**2 - 4 * F1 * (F0 - F2))) / (2 * F1)
    return F0 + F1 * R**2 if change >= R else F2 + F3 * R


def hill_polynomial(phi, linear, square, cube):
    if phi >= 0.4:
        return 10 * phi / (1 - phi)**3
    w = math.exp(-10 * (0.4 - phi) / phi)
    dilute = (1 + 3 * math.sqrt(phi / 2) + 135 / 64 * phi * math.log(phi) + linear * phi) / (
        1 + 0.681 * phi + square * phi**2 + cube * phi**3)
    return (1 - w) * dilute + w * 10 * phi / (1 - phi)**3


def beetstra(phi, Re=0.0):
    """Beetstra, van der Hoef and Kuipers (2007); at Re = 0 van der Hoef, Beetstra and Kuipers (2005)."""
    slow = 10 * phi / (1 - phi)**3 + (1 - phi) * (1 + 1.5 * math.sqrt(phi))
    if Re == 0:
        return slow
    rise = (1 / (1 - phi) + 3 * phi * (1 - phi) + 8.4 * Re**-0.343) / (1 + 10**(3 * phi) * Re**(-(1 + 4 * phi) / 2))
    return slow + 0.413 * Re / (24 * (1 - phi)**3) * rise


def tenneti(phi, Re=0.0):
    """Tenneti, Garg and Subramaniam (2011)."""
    return (1 + 0.15 * Re**0.687 + 5.81 * phi) / (1 - phi)**3 + 0.48 * phi**(1 / 3) / (1 - phi)**4 + (
        phi**3 * Re * (0.95 + 0.61 * phi**3 / (1 - phi)**2))


LAWS = (hill_koch_ladd, beetstra, tenneti)


def between(phi, Re=0.0):
    """Returns the least and largest K of the laws."""
    found = [law(phi, Re) for law in LAWS]
    return min(found), max(found)
