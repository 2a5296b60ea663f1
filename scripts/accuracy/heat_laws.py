"""Published laws of the Nusselt number of a sphere in a stream, over its diameter; Re and Pr of the stream.

At Re of 20 to 100 they differ by up to 10 % from one another.
"""


def whitaker(Re, Pr):
    """Whitaker, AIChE J. 18 (1972) 361, with one viscosity; for Re of 3.5 to 7.6e4, Pr of 0.71 to 380; measured to 30 %."""
    return 2 + (0.4 * Re**(1 / 2) + 0.06 * Re**(2 / 3)) * Pr**0.4


def feng_michaelides(Re, Pr):
    """Feng, Michaelides, Int. J. Heat Mass Transfer 43 (2000) 219: fitted to computed flows."""
    return 0.922 + (Re * Pr)**(1 / 3) * (1 + 0.1 * Re**(1 / 3))


def ranz_marshall(Re, Pr):
    """Ranz, Marshall, Chem. Eng. Prog. 48 (1952) 141: fitted to evaporating drops, Re up to 200."""
    return 2 + 0.6 * Re**(1 / 2) * Pr**(1 / 3)


LAWS = {"Whitaker 1972": whitaker, "Feng, Michaelides 2000": feng_michaelides, "Ranz, Marshall 1952": ranz_marshall}
