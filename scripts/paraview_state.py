"""Opens a run in ParaView (5.10 or later): File > Load State, or paraview --script=OUT/paraview.py. scripts/surfaces puts it into the
folder of results. Shown are the fluid's speed in the middle plane, where there is fluid, the bodies by kind, and walls of triangles."""
import pathlib

from paraview import simple

FOLDER, UP = "{folder}", {up}  # the folder of results, the axis against gravity

here = pathlib.Path(globals().get("__file__", "")).resolve().parent
folder = here if (here / "scene.h5").exists() else pathlib.Path(FOLDER)
view = simple.GetActiveViewOrCreate("RenderView")
depth = 1 if UP != 1 else 2
coloured = []


def opened(name):
    """Returns what ParaView makes of a file of the folder, with a name in its pipeline; None without the file."""
    path = folder / name
    if not path.exists():
        return None
    source = simple.OpenDataFile(str(path))
    simple.RenameSource(name, source)
    source.UpdatePipeline()
    return source


def middle_plane(fluid):
    """Shows the speed where there is fluid."""
    bounds = fluid.GetDataInformation().GetBounds()
    plane = simple.Slice(registrationName="middle plane", Input=fluid)
    plane.SliceType.Normal = [float(axis == depth) for axis in range(3)]
    plane.SliceType.Origin = [(bounds[2 * axis] + bounds[2 * axis + 1]) / 2 for axis in range(3)]
    of, data = ("POINTS", fluid.PointData) if fluid.PointData.GetNumberOfArrays() else ("CELLS", fluid.CellData)
    names = [data.GetArray(k).Name for k in range(data.GetNumberOfArrays())]
    if "solid" in names:
        plane = simple.Threshold(registrationName="fluid in the middle plane", Input=plane, Scalars=[of, "solid"],
                                 ThresholdMethod="Between", LowerThreshold=0, UpperThreshold=0)
    shown = simple.Show(plane, view)
    if "velocity" in names:
        simple.ColorBy(shown, (of, "velocity", "Magnitude"))
        shown.SetScalarBarVisibility(view, True)
        coloured.append(shown)
    simple.Show(fluid, view, "OutlineRepresentation")


if fluid := opened("fields.hdf.series"):
    middle_plane(fluid)
for path in sorted(folder.glob("slice_*.hdf.series")):
    simple.Hide(opened(path.name), view)
if bodies := opened("bodies.pvd"):
    simple.ColorBy(simple.Show(bodies, view), ("CELLS", "kind"))
if walls := opened("walls.pvd"):
    simple.Show(walls, view).Opacity = 0.3
simple.GetAnimationScene().UpdateAnimationUsingDataTimeSteps()
simple.GetAnimationScene().GoToLast()
for shown in coloured:
    shown.RescaleTransferFunctionToDataRange(False, True)
view.CameraPosition, view.CameraFocalPoint = [-float(axis == depth) for axis in range(3)], [0, 0, 0]
view.CameraViewUp = [float(axis == UP) for axis in range(3)]
simple.ResetCamera(view)
