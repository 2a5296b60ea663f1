#!/usr/bin/python3
"""scripts/plot on a small run, whole and with parts missing: plots.py TEST_PROGRAM."""
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py

PLOT = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "plot"
ENVIRONMENT = dict(os.environ, OMPI_MCA_btl_vader_single_copy_mechanism="none")


def pictures(case):
    result = subprocess.run([PLOT, case], capture_output=True, text=True, timeout=120)
    assert result.returncode == 0, result.stderr
    made = {p.name for p in (case / "out").glob("*.png")}
    for name in made:
        (case / "out" / name).unlink()
    return made, result.stdout


with tempfile.TemporaryDirectory() as folder:
    case, out = pathlib.Path(folder), pathlib.Path(folder) / "out"
    (case / "case.toml").write_text("")
    result = subprocess.run([PLOT, case], capture_output=True, text=True)
    assert result.returncode != 0 and "run the case first" in result.stderr
    out.mkdir()
    assert pictures(case)[0] == set()
    for test in ("a_series", "fields"):
        subprocess.run([sys.argv[1], "--act", f"write_{test}"],
                       check=True, stdout=subprocess.DEVNULL, env=dict(ENVIRONMENT, SILT_TEST_FOLDER=str(out)))
    bodies = {"mean_height.png", "velocity.png", "bodies.png"}
    made, told = pictures(case)
    assert made == bodies | {"slice.png"} and "no report.json" in told and "no scene.h5" in told, (made, told)
    (out / "report.json").write_text('{"stage_seconds": {"stream collide": {"min": 1, "avg": 2, "max": 3}}}')
    with h5py.File(out / "scene.h5", "w") as scene:
        scene.attrs.update(title="a case", length_unit="m", time_unit="s", domain_upper=[1.0, 1.0, 1.0], gravity=[-9.81, 0.0, 0.0],
                           sides=["no-slip"] * 6)
        scene.create_group("walls")
    assert pictures(case)[0] == bodies | {"slice.png", "stages.png"}
    for field in out.glob("*.hdf"):
        field.unlink()
    assert pictures(case)[0] == bodies | {"stages.png"}
    (out / "bodies.h5").write_bytes((out / "bodies.h5").read_bytes()[:1000])
    made, told = pictures(case)
    assert made == {"stages.png"} and "cannot use" in told
print("pictures are made of what is there")
