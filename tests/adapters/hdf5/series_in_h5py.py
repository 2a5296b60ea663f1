#!/usr/bin/python3
"""bodies.h5 as h5py sees it: series_in_h5py.py TEST_PROGRAM. The program's writer is started on one rank and on three.
What a killed writer leaves is tested by tests/stress/kills.py."""
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np
import over_time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))
from silt_results.body_series import BodySeries  # noqa: E402

program = sys.argv[1]
ENVIRONMENT = dict(os.environ, OMPI_MCA_btl_vader_single_copy_mechanism="none",
                   OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")


def check(series):
    """Every time of the series holds what the writer makes of its number."""
    assert (series.step == 10 * np.arange(len(series))).all()
    assert (series.time == 0.5 * np.arange(len(series))).all()
    for t in {*range(min(len(series), 20)), *range(max(0, len(series) - 20), len(series))}:
        rows, ids = series.at(t), np.arange(1, 21 + t % 3)
        assert (rows["id"] == ids).all() and (rows["kind"] == ids % 2).all()
        assert (rows["image"] == np.column_stack([0 * ids, -ids, 0 * ids + t])).all()
        assert (rows["position"] == ids[:, None] + 0.1 * np.arange(3) + 0.001 * t).all()
        assert np.allclose(rows["velocity"], np.sin((ids * t)[:, None] + np.arange(3)), rtol=0, atol=1e-15)
        assert (rows["force"] == -ids[:, None] * np.arange(3)).all() and (rows["torque"] == 0).all()
        assert (rows["orientation"][:, 3] == 1e-3 * t).all()
        assert (rows["mass"] == 0.5 * ids).all() and (rows["contact_force"][:, 1] == ids).all()
        assert (rows["contact_torque"][:, 1] == -t).all() and "buoyancy" not in rows


for ranks in (1, 3):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["mpirun", "--oversubscribe", "-np", str(ranks), program, "--act", "write_a_series"], check=True,
                       env=dict(ENVIRONMENT, SILT_TEST_FOLDER=folder), stdout=subprocess.DEVNULL, timeout=60)
        series = BodySeries(folder + "/bodies.h5")
        check(series)
        assert over_time.check(folder) == {"bodies.vtkhdf": len(series)}
        assert len(series) == 10 and series.unit("velocity") == "m/s" and series.unit("torque") == "N m"
        assert series.kinds == ["light", "heavy \u2605", "without a mesh"] and series.provenance["title"] == "\u00e4"
        assert [len(parts) for parts in series.meshes] == [1, 2, 0]
        for height, part in zip((1, 1, 1.5), series.meshes[0] + series.meshes[1]):
            assert (part["vertices"] == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, height]]).all()
            assert (part["triangles"] == [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).all()
            assert np.allclose(part["normals"][:, 0], [0, 0, 3**-0.5, -1]) and len(part["normals"]) == 4
            assert (part["triangle_normals"] == np.arange(4)[:, None]).all()
        with h5py.File(folder + "/bodies.h5") as f:  # the file says what its numbers mean
            assert f.attrs["format_version"] == 4 and f["kinds/vertex"].attrs["unit"] == b"m"
            assert f["kinds/density"].attrs["unit"] == b"kg/m3"
            assert all(len(data.attrs["meaning"]) > 10 for data in f["kinds"].values())
        assert len(series.of_body(21, "position")[0]) == 6
        try:
            series.array("position")
            sys.exit("array() of a changing number of bodies")
        except ValueError:
            pass
