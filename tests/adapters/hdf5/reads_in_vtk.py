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
from vtkmodules.vtkIOHDF import vtkHDFReader

CELLS, SPACING = (13, 8, 21), 0.5
ENVIRONMENT = dict(os.environ, OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_btl_vader_single_copy_mechanism="none",
                   OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")


def expected(component, dtype):
    z, y, x = np.meshgrid(*(np.arange(n) for n in reversed(CELLS)), indexing="ij")
    return (0.1 * x + 10 * y - 1000.0 / (z + 1) + 0.01 * component).astype(dtype)


def check_in_vtk(path):
    reader = vtkHDFReader()
    assert reader.CanReadFile(path)
    reader.SetFileName(path)
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
        assert f.attrs["time"] in (0, 0.5) and f.attrs["step"] == 100
        assert f["VTKHDF/PointData/velocity"].attrs["unit"] == b"m/s"
        assert (f["VTKHDF/PointData/velocity"][..., 2] == expected(2, "f4")).all()
        assert f["provenance"].attrs["commit"] == b"abc"
        assert f["provenance/case_text"][()] == b'title = "a title"\n'


for ranks in (1, 4):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["mpirun", "--oversubscribe", "-np", str(ranks), sys.argv[1], "--act", "write_fields"], check=True, stdout=subprocess.DEVNULL, timeout=120,
                       env=dict(ENVIRONMENT, SILT_TEST_FOLDER=folder))
        with open(folder + "/fields.hdf.series") as f:
            series = json.load(f)["files"]
        assert [entry["time"] for entry in series] == [0, 0.5]
        for entry in series:
            check_in_vtk(f"{folder}/{entry['name']}")
            check_in_h5py(f"{folder}/{entry['name']}")
print("vtkHDFReader and h5py read what was written")
