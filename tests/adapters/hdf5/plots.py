#!/usr/bin/python3
"""scripts/plot on a small run, whole and with parts missing: plots.py TEST_PROGRAM."""
import os
import pathlib
import subprocess
import sys
import tempfile

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
    result = subprocess.run([PLOT, case], capture_output=True, text=True)
    assert result.returncode != 0 and "run the case first" in result.stderr
    out.mkdir()
    assert pictures(case)[0] == set()
    for test in ("a_series", "fields"):
        subprocess.run([sys.argv[1], "--act", f"write_{test}"],
                       check=True, stdout=subprocess.DEVNULL, env=dict(ENVIRONMENT, SILT_TEST_FOLDER=str(out)))
    bodies = {"mean_height.png", "velocity.png", "bodies.png"}
    made, told = pictures(case)
    assert made == bodies | {"slice.png"} and "no report.json" in told, (made, told)
    (out / "report.json").write_text('{"stage_seconds": {"stream collide": {"min": 1, "avg": 2, "max": 3}}}')
    (case / "case.toml").write_text('title = "a case"\n[gravity]\nacceleration = [-9.81, 0, 0]\n')
    assert pictures(case)[0] == bodies | {"slice.png", "stages.png"}
    for field in out.glob("*.hdf"):
        field.unlink()
    assert pictures(case)[0] == bodies | {"stages.png"}
    (out / "bodies.h5").write_bytes((out / "bodies.h5").read_bytes()[:1000])
    made, told = pictures(case)
    assert made == {"stages.png"} and "cannot use" in told
print("pictures are made of what is there")
