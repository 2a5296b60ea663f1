"""The scenes of the map: each a case for a collision model, tau - 1/2 and a velocity in cells a step, long enough for what grows to show."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "accuracy"))

from case_text import case_text, sphere  # noqa: E402


def fluid(model, excess, u, **initial):
    return dict(relaxation_time=0.5 + excess, collision=model, initial=dict(velocity=[u, 0, 0], **initial))


def layer(model, excess, u):
    """A double shear layer, a 30th of the box thick, that rolls up."""
    return case_text("Double shear layer", domain=dict(size=[64, 64, 2], boundary="periodic"),
                     fluid=fluid(model, excess, u, type="shear-layer", steepness=30), run=dict(steps=round(4 * 64 / u)))


def vortices(model, excess, u):
    """The Taylor-Green vortices in three dimensions, until their eddies have decayed."""
    return case_text("Taylor-Green vortices", domain=dict(size=[32, 32, 32], boundary="periodic"),
                     fluid=fluid(model, excess, u, type="taylor-green-3d"), run=dict(steps=round(100 / u)))


def cavity(model, excess, u):
    """A box with half-way walls whose lid moves."""
    return case_text("Lid-driven slab", domain=dict(size=[32, 32, 2], boundary=dict(
        x=[dict(type="moving", velocity=[0, u, 0]), "no-slip"], y="no-slip", z="periodic")),
        fluid=dict(relaxation_time=0.5 + excess, collision=model), run=dict(steps=round(20 * 32 / u)))


def ball(motion, **more):
    return dict(shapes=[sphere(8)], bodies=[dict(name="sphere", shape="sphere", density=1, motion=motion, position=[16.3, 16.1, 16.2], **more)])


def stream(model, excess, u):
    """A sphere of 8 cells held in a stream between an inlet and an outlet."""
    sides = [dict(type="velocity-inlet", velocity=[u, 0, 0]), dict(type="pressure-outlet")]
    return case_text("Sphere in a stream", domain=dict(size=[64, 32, 32], boundary=dict(x=sides, y="periodic", z="periodic")),
                     fluid=fluid(model, excess, u, type="uniform", noise=u / 50), run=dict(steps=round(3 * 64 / u)), **ball("fixed"))


def towed(model, excess, u):
    """Pulls the sphere through fluid at rest, obliquely to the lattice."""
    return case_text("Towed sphere", domain=dict(size=[48, 32, 32], boundary="periodic"),
                     fluid=dict(relaxation_time=0.5 + excess, collision=model), run=dict(steps=round(2 * 48 / u)),
                     **ball("prescribed", velocity=[0.9 * u, 0.4 * u, 0.17 * u]))


SCENES = {f.__name__: f for f in (layer, vortices, cavity, stream, towed)}
MODELS = ("trt", "bgk", "regularised")
EXCESSES = (1e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 1, 2)  # tau - 1/2
VELOCITIES = (0.01, 0.03, 0.06, 0.1, 0.2)
FASTEST = 3  # times the velocity given: more is wrong


def cell_reynolds(excess, u):
    return 3 * u / excess
