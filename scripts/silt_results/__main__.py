"""python3 -m silt_results FILE...

Says what is in a file of results (bodies.h5, *.vtkhdf, fields_*.hdf, slice_*.hdf, mean_*.hdf, scene.h5, checkpoint_*.h5): where it came from, the
attributes of its groups, its data sets with their shapes and units. The text of the case is left out.
"""
import sys

import h5py
import numpy as np

from . import text


def said(value):
    return ", ".join(text(one) if isinstance(one, (bytes, str)) else f"{one:.10g}" for one in np.atleast_1d(value).ravel())


def lines_of(path):
    """Yields what is said of a file."""
    yield str(path)
    with h5py.File(path, "r") as f:
        objects = {"/": f}
        f.visititems(lambda name, thing: objects.update({"/" + name: thing}))
        for name, group in objects.items():
            if isinstance(group, h5py.Group) and len(group.attrs):
                yield f"  {name}"
                yield from (f"    {key}: {said(value)}" for key, value in group.attrs.items())
        for name, data in objects.items():
            if isinstance(data, h5py.Dataset):
                unit = f", {text(data.attrs['unit'])}" if "unit" in data.attrs else ""
                yield f"  {name} [{' x '.join(map(str, data.shape))}] {'text' if data.dtype.kind in 'SO' else data.dtype}{unit}"


def main():
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    for path in sys.argv[1:]:
        try:
            print("\n".join(lines_of(path)))
        except OSError as error:
            sys.exit(f"{path}: {error}")


main()
