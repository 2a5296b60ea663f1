#!/usr/bin/python3
"""cases_notice_faults.py SILT: what the short forms of cases compare deviates for a wrong value of what they
are about, a reference that cannot be compared is refused, and what is said of a comparison reads as it is
meant."""
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
from reference import Fault, check, told  # noqa: E402

FAULTS = [  # case, a wrong value, what must deviate
    ("segregation", "gravity.acceleration=[0, 0, -9]", "displacement.heavy_spheres"),
    ("segregation", "fill[0].density=780", "displacement.light_spheres"),
    ("wet-drum", "gravity.acceleration=[0, 0, -7]", "fall"),
    ("wet-drum", "walls[0].angular_velocity=1.1", "torque"),
    ("wet-drum", "fluid.kinematic_viscosity=5e-5", "torque"),
    ("sphere-in-shear", "fluid.relaxation_time=1.02", "angular_velocity"),
    ("segre-silberberg", "fluid.body_force_on_bodies=false", "sphere_velocity"),
    ("channel", "fluid.magic=0.25", "profile_error"),
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

QUANTITY = {"name": "h", "kind": "theory", "source": "somewhere"}
FIGURE, BOUNDS = {**QUANTITY, "value": 0.12, "tolerance": 0.02, "relative": True}, {**QUANTITY, "between": [0.0005, 0.0045]}
for sound in (FIGURE, BOUNDS, {**BOUNDS, "note": "why"}):
    check(sound, "reference.toml")
for faulty, said in (({**BOUNDS, "value": 1}, "both between and value"), ({**BOUNDS, "tolerance": 1}, "both between and tolerance"),
                     ({**QUANTITY, "between": [2, 1]}, "the lower one first"), ({**QUANTITY, "between": [1]}, "two numbers"),
                     (QUANTITY, "has no value; give value and tolerance, or between"), ({**FIGURE, "tolerence": 1}, "has 'tolerence'")):
    try:
        check(faulty, "reference.toml")
    except Fault as fault:
        assert said in str(fault), fault
    else:
        raise AssertionError(f"{faulty} is taken")

for quantity, found, unit, line in (
        (BOUNDS, 0.00154, "m", "h: 1.54 mm, between 0.5 and 4.5 mm: inside"),
        (BOUNDS, 0.0051, "m", "h: 5.1 mm, between 0.5 and 4.5 mm: outside"),
        (BOUNDS, None, "m", "h: missing, between 0.5 and 4.5 mm: outside"),
        (BOUNDS, 0.00154, "", "h: 0.00154, between 0.0005 and 0.0045: inside"),
        (FIGURE, 0.1212, "m/s", "h: 0.1212 m/s, theory 0.12 ± 0.0024 m/s (+1.00 %): ok"),
        (FIGURE, 0.13, "m/s", "h: 0.13 m/s, theory 0.12 ± 0.0024 m/s (+8.33 %): deviates"),
        ({**QUANTITY, "value": 0, "tolerance": 2e-6}, 1e-6, "m", "h: 1 µm, theory 0 ± 2 µm: ok"),
        ({**FIGURE, "note": "why"}, 0.1201, "m/s", "h: 0.1201 m/s, theory 0.12 ± 0.0024 m/s (+0.08 %): ok"),
        ({**FIGURE, "note": "why"}, 0.122, "m/s", "h: 0.122 m/s, theory 0.12 ± 0.0024 m/s (+1.67 %): ok (why)"),
        (FIGURE, None, "m/s", "h: missing, theory 0.12: deviates")):
    report = {"quantities": {"h": found}, "quantity_types": {"h": {"unit": unit}}}
    assert told(quantity, report) == line, (told(quantity, report), line)
