#!/usr/bin/python3
"""cases_notice_faults.py SILT: what the short forms of cases compare deviates for a wrong value of what they are about."""
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
FAULTS = [  # case, a wrong value, what must deviate
    ("segregation", "gravity.acceleration=[0, 0, -9]", "displacement.heavy_spheres"),
    ("segregation", "fill[0].density=780", "displacement.light_spheres"),
    ("wet-drum", "gravity.acceleration=[0, 0, -7]", "fall"),
    ("wet-drum", "walls[0].angular_velocity=1.1", "torque"),
    ("wet-drum", "fluid.kinematic_viscosity=5e-5", "torque"),
    ("sphere-in-shear", "fluid.relaxation_time=1.02", "angular_velocity"),
    ("segre-silberberg", "fluid.body_force_on_bodies=false", "sphere_velocity"),
]


def regress(*arguments):
    return subprocess.run([ROOT / "scripts/regress", "--silt", sys.argv[1], "--short", *arguments], capture_output=True, text=True)


for case, fault, quantity in FAULTS:
    done = regress(case, "--set", fault)
    rows = [line.split() for line in done.stdout.splitlines()]
    deviating = [row[1] for row in rows if row and row[-1] == "DEVIATES"]
    print(f"{case} with {fault}: {', '.join(deviating) or 'nothing'} deviates")
    assert done.returncode == 1 and quantity in deviating, done.stdout + done.stderr

# A case that compares nothing is no test: it is refused before it runs.
with tempfile.TemporaryDirectory() as folder:
    shutil.copy(ROOT / "cases/channel/case.toml", folder)
    done = regress(folder)
    assert done.returncode == 1 and "compares nothing" in done.stderr, done
