#!/usr/bin/python3
"""Field files as VTK and h5py see them: reads_in_vtk.py TEST_PROGRAM. The values are those of mpi_field_file.cpp."""
import json
import os
import subprocess
import sys
import tempfile

import h5py
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from over_time import check
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkIOHDF import vtkHDFReader

CELLS, SPACING = (13, 8, 21), 0.5
ENVIRONMENT = dict(os.environ, OMPI_MCA_btl_vader_single_copy_mechanism="none",
                   OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")


def expected(component, dtype):
    z, y, x = np.meshgrid(*(np.arange(n) for n in reversed(CELLS)), indexing="ij")
    return (0.1 * x + 10 * y - 1000.0 / (z + 1) + 0.01 * component).astype(dtype)


def check_in_vtk(path, time=None):
    reader = vtkHDFReader()
    assert reader.CanReadFile(path)
    reader.SetFileName(path)
    if time is not None:
        reader.UpdateTimeStep(time)
    reader.Update()
    image = reader.GetOutput()
    assert image.GetDimensions() == CELLS, image.GetDimensions()
    assert image.GetSpacing() == (SPACING,) * 3
    assert image.GetOrigin() == (-1 + SPACING / 2, SPACING / 2, 2 + SPACING / 2), image.GetOrigin()
    points = image.GetPointData()
    assert points.GetNumberOfArrays() == 4
    z, y, x = np.meshgrid(*(np.arange(n) for n in reversed(CELLS)), indexing="ij")
    marks = vtk_to_numpy(points.GetArray("mark")).reshape(CELLS[::-1])
    assert marks.dtype == np.uint8 and (marks == (x + 3 * y + 7 * z) % 256).all(), path
    for name, components, dtype in (("density", 1, "f4"), ("velocity", 3, "f4"), ("pressure", 1, "f8")):
        values = vtk_to_numpy(points.GetArray(name)).reshape(CELLS[::-1] + (components,))
        assert values.dtype == np.dtype(dtype)
        for c in range(components):
            assert (values[..., c] == expected(c, dtype)).all(), (path, name, c)


def check_in_h5py(path):
    with h5py.File(path, "r") as f:
        assert f.attrs["time"] == 0.01 * f.attrs["step"]
        assert f["VTKHDF/PointData/velocity"].attrs["unit"] == b"m/s"
        assert (f["VTKHDF/PointData/velocity"][..., 2] == expected(2, "f4")).all()
        assert f["provenance"].attrs["commit"] == b"abc"
        assert f["provenance/case_text"][()] == b'title = "a title"\n'


def check_levels(path):
    """The coarsest level that has cells is the first; values lie box after box."""
    with h5py.File(path, "r") as f:
        head = f["VTKHDF"].attrs
        assert (head["Type"], head["GridDescription"], list(head["Origin"]), list(head["Version"])) == (b"OverlappingAMR", b"XYZ", [-1, 0, 2], [1, 0])
        assert sorted(f["VTKHDF"]) == ["Level0", "Level1"]
        for name, spacing, cells in (("Level0", 1, (6, 4, 4)), ("Level1", 0.5, (12, 8, 21))):
            level, found, begin = f["VTKHDF"][name], np.zeros(cells[::-1], int), 0
            assert sorted(level) == ["AMRBox", "CellData", "FieldData", "PointData"] and list(level.attrs["Spacing"]) == [spacing] * 3
            for box in level["AMRBox"][()]:
                (x0, x1), (y0, y1), (z0, z1) = box.reshape(3, 2)
                z, y, x = np.meshgrid(np.arange(z0, z1 + 1), np.arange(y0, y1 + 1), np.arange(x0, x1 + 1), indexing="ij")
                end = begin + x.size
                assert (level["CellData/mark"][begin:end] == ((x + 3 * y + 7 * z) % 256).ravel()).all()
                for c in range(3):
                    wanted = (0.1 * x + 10 * y - 1000.0 / (z + 1) + 0.01 * c).astype("f4")
                    assert (level["CellData/velocity"][begin:end, c] == wanted.ravel()).all()
                found[z, y, x] += 1
                begin = end
            assert begin == len(level["CellData/density"]) and (found[8 if name == "Level1" else 0:] == 1).all() and found.max() == 1
            assert level["CellData/velocity"].attrs["unit"] == b"m/s"


for ranks in (1, 4):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["mpirun", "--oversubscribe", "-np", str(ranks), sys.argv[1], "--act", "write_fields"], check=True, stdout=subprocess.DEVNULL, timeout=120,
                       env=dict(ENVIRONMENT, SILT_TEST_FOLDER=folder))
        with open(folder + "/fields.hdf.series") as f:
            series = json.load(f)["files"]
        assert np.allclose([entry["time"] for entry in series], [0, 0.5, 0.6, 0.7], rtol=1e-15)
        assert check(folder) == {"fields.vtkhdf": 4}
        if vtkVersion().GetVTKMajorVersion() * 100 + vtkVersion().GetVTKMinorVersion() >= 903:  # versions before know no times
            for entry in series:
                check_in_vtk(f"{folder}/fields.vtkhdf", entry["time"])
        check_levels(f"{folder}/levels.hdf")
        for entry in series:
            check_in_vtk(f"{folder}/{entry['name']}")
            check_in_h5py(f"{folder}/{entry['name']}")
print("vtkHDFReader and h5py read what was written")
