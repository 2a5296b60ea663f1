#!/usr/bin/env pvpython
"""opens_in_paraview.py OUT [PICTURE]: ParaView reads every field, slice and surface in a folder of results at
every time, with its columns, and shows them as the state OUT/paraview.py says. Not among the tests: Debian's
python3-paraview and python3-vtk9 cannot both be installed. Run by `pvpython --force-offscreen-rendering`."""
import pathlib
import sys

from paraview.simple import Delete, GetActiveView, OpenDataFile, SaveScreenshot, UpdatePipeline

out = pathlib.Path(sys.argv[1])
files = sorted([*out.glob("*.hdf.series"), *out.glob("bodies.pvd"), *out.glob("walls.pvd")])
for path in files:
    reader = OpenDataFile(str(path))
    times = list(reader.TimestepValues)
    assert times, path
    for time in times:
        UpdatePipeline(time=time, proxy=reader)
        columns = [data.GetArray(i) for data in (reader.PointData, reader.CellData) for i in range(data.GetNumberOfArrays())]
        assert columns and reader.GetDataInformation().GetNumberOfPoints() > 0, (path, time)
        assert all(column.GetRange(c)[0] <= column.GetRange(c)[1] for column in columns for c in range(column.GetNumberOfComponents())), (path, time)
    print(f"{path.name}: {len(times)} times; {', '.join(column.Name for column in columns)}")
    Delete(reader)
assert files, f"{out}: nothing for ParaView"
state = out / "paraview.py"
if state.exists():
    exec(compile(state.read_text(), str(state), "exec"), {"__file__": str(state)})
    if len(sys.argv) > 2:
        SaveScreenshot(sys.argv[2], GetActiveView())
