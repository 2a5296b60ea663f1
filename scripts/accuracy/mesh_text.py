"""Surfaces of scripts/make_mesh as the text of an OBJ file, for the files of a run."""
import importlib.machinery
import importlib.util
import pathlib

_program = str(pathlib.Path(__file__).resolve().parent.parent / "make_mesh")
_loader = importlib.machinery.SourceFileLoader("make_mesh", _program)
make_mesh = importlib.util.module_from_spec(importlib.util.spec_from_loader("make_mesh", _loader))
_loader.exec_module(make_mesh)


def obj(surface, **options):
    """Returns the text of a surface; options are those of make_mesh, with True for those that have no value."""
    words = [surface, "mesh.obj"]
    for name, x in options.items():
        words.append("--" + name.replace("_", "-"))
        words += [] if x is True else [str(v) for v in (x if isinstance(x, tuple) else (x,))]
    points, triangles = make_mesh.SURFACES[surface](make_mesh.options().parse_args(words))
    return make_mesh.obj_text(points, triangles)
