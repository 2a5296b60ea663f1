"""NAME.vtkhdf as VTK's specification of VTKHDF 2 has it (docs.vtk.org, VTKHDF format specification: temporal data), read in the way
of vtkHDFReader, against the files beside it. The tests share this, and after a run `over_time.py FOLDER` checks its results."""
import json
import pathlib
import sys

import h5py
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))
from silt_results.body_series import BodySeries  # noqa: E402


def steps_of(file, kind):
    """Checks the attributes; returns the group of steps and their times."""
    root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
    assert list(root.attrs["Version"]) == [2, 0] and root.attrs["Type"] == kind, dict(root.attrs)
    n = int(steps.attrs["NSteps"])
    times = steps["Values"][()]
    assert steps["Values"].shape == (n,), "VTK copies all of Values to a list of NSteps numbers, and past its end"
    assert n >= 2 and (np.diff(times) > 0).all(), times
    return steps, times


def offset_of(steps, name, k):
    return int(steps["PointDataOffsets"][name][k])


def check_images(path, paths):
    """The times are those of the first of these files, and so are the values. Returns how many."""
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        steps, times = steps_of(file, b"ImageData")
        assert set(root["PointData"]) == set(steps["PointDataOffsets"]) and len(root["PointData"]) > 0
        low, high = root.attrs["WholeExtent"].reshape(3, 2).T
        shape = tuple(high - low + 1)[::-1]
        assert len(times) <= len(paths), (path, times)
        for k, one in enumerate(paths[:len(times)]):
            with h5py.File(one) as alone:
                assert alone.attrs["time"] == times[k] and alone.attrs["step"] == file["step"][k], (path, k)
                for name in ("Origin", "Spacing", "Direction", "WholeExtent"):
                    assert (alone["VTKHDF"].attrs[name] == root.attrs[name]).all(), (path, name)
                for name, data in root["PointData"].items():
                    values = data[offset_of(steps, name, k)]
                    expected = alone["VTKHDF/PointData"][name]
                    assert values.shape[:3] == shape and data.dtype == expected.dtype and data.attrs["unit"] == expected.attrs["unit"]
                    assert values.tobytes() == expected[()].tobytes(), (path, k, name)
        check_in_vtk(path, times, lambda k: {name: data[offset_of(steps, name, k)] for name, data in root["PointData"].items()})
    return len(times)


def check_bodies(path, series):
    """Each body is a point, and a vertex, with the columns of its row. Returns how many times there are."""
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        steps, times = steps_of(file, b"PolyData")
        assert len(times) <= len(series) and (times == series.time[:len(times)]).all(), (path, times)
        assert set(root["PointData"]) == set(steps["PointDataOffsets"]) == set(series.columns) - {"position"}
        for k in range(len(times)):
            rows = series.at(k)
            part, parts, first = (int(steps[name][k]) for name in ("PartOffsets", "NumberOfParts", "PointOffsets"))
            n = int(root["NumberOfPoints"][part])
            assert parts == 1 and n == series.count[k], (path, k)
            assert np.array_equal(root["Points"][first:first + n], rows["position"]), (path, k)
            for name, data in root["PointData"].items():
                at = offset_of(steps, name, k)
                assert np.array_equal(data[at:at + n], rows[name], equal_nan=True), (path, k, name)
            for number, topology in enumerate(("Vertices", "Lines", "Polygons", "Strips")):
                cells, ids = (int(root[topology][name][part]) for name in ("NumberOfCells", "NumberOfConnectivityIds"))
                at, of_ids = (int(steps[name][k, number]) for name in ("CellOffsets", "ConnectivityIdOffsets"))
                before = np.cumsum(root[topology]["NumberOfCells"][:part]) - root[topology]["NumberOfCells"][:part]
                assert (before < at).all(), "later versions of VTK count only the parts before it whose cells do not reach the offset"
                offsets, connectivity = root[topology]["Offsets"][at + part:at + part + cells + 1], root[topology]["Connectivity"][of_ids:of_ids + ids]
                expected = n if topology == "Vertices" else 0
                assert cells == ids == expected and (offsets == np.arange(expected + 1)).all(), (path, k, topology)
                assert (connectivity == np.arange(expected)).all(), (path, k, topology)
        check_in_vtk(path, times, series.at)
    return len(times)


def check_in_vtk(path, times, values_at):
    """VTK, where it is new enough to read times, reads these, and at the k-th the arrays that values_at(k) returns by name."""
    try:
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
        from vtkmodules.vtkIOHDF import vtkHDFReader
    except ImportError:
        return
    reader = vtkHDFReader()
    if not hasattr(reader, "GetNumberOfSteps"):  # before 9.3
        return
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    assert list(reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())) == list(times), path
    for k, time in enumerate(times):
        reader.UpdateTimeStep(time)
        reader.Update()
        data, expected = reader.GetOutputDataObject(0), values_at(k)
        names = {data.GetPointData().GetArrayName(i) for i in range(data.GetPointData().GetNumberOfArrays())}
        assert names == set(expected) - {"position"}, (path, k, names)
        n = len(expected["position"]) if "position" in expected else data.GetNumberOfPoints()
        assert data.GetNumberOfPoints() == n and ("position" not in expected or data.GetNumberOfVerts() == data.GetNumberOfCells() == n), (path, k)
        for name, values in expected.items():
            read = data.GetPoints().GetData() if name == "position" else data.GetPointData().GetArray(name)
            assert n == 0 or vtk_to_numpy(read).tobytes() == values.tobytes(), (path, k, name)


def check(folder, whole=True):
    """Checks the files over time of a folder. Of a run that was killed they may lack the last time, of bodies the last 64th of the times.
    Returns how many times they have."""
    folder, found = pathlib.Path(folder), {}

    def expect(path, n, check_of):
        found[path.name] = check_of() if path.exists() else 0
        least = n if whole else n - 1 - n // 64
        assert found[path.name] >= (least if least > 1 else 0), f"{path}: {found[path.name]} times of {n}"
    for listed in sorted([*folder.glob("fields.hdf.series"), *folder.glob("slice_*.hdf.series")]):
        files = [folder / entry["name"] for entry in json.loads(listed.read_text())["files"]]
        with h5py.File(files[0]) as file:
            if file["VTKHDF"].attrs["Type"] != b"ImageData":
                continue
        path = folder / listed.name.replace(".hdf.series", ".vtkhdf")
        expect(path, len(files), lambda path=path, files=files: check_images(path, files))
    if (folder / "bodies.h5").exists():
        series = BodySeries(folder / "bodies.h5")
        expect(folder / "bodies.vtkhdf", len(series), lambda: check_bodies(folder / "bodies.vtkhdf", series))
    return found


if __name__ == "__main__":
    print(check(sys.argv[1]))
