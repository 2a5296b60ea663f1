#!/usr/bin/python3
"""same_bits_on_every_device.py SILT CASES: the passes of a device, run on the processor, give the state of its kernels, and a run
goes on from one's checkpoint on the other, to the bit. What is not there is refused by name."""
import json
import pathlib
import subprocess
import sys
import tempfile

silt, cases = sys.argv[1], pathlib.Path(sys.argv[2])


def silt_run(*words):
    done = subprocess.run([silt, *map(str, words)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done


def state(out):
    report = json.loads((out / "report.json").read_text())
    return report["device"], report["state_hash"]


with tempfile.TemporaryDirectory() as folder:
    out = pathlib.Path(folder) / "out"
    for case, steps, *more in [("segregation", 20), ("settling-sphere", 40, "--set", "fluid.precision=double"), ("channel", 40),
                               ("sphere-in-stream", 16, "--set", "run.balance.every=0")]:
        found = []
        for device in ("cpu", "host"):
            silt_run("run", cases / case, "--out", out, "--overwrite", "--steps", steps, "--device", device, *more)
            ran, hashed = state(out)
            assert ran == device, (ran, device)
            found.append(hashed)
        print(case, *found)
        assert found[0] == found[1], f"{case}: the state depends on the device"

    case = cases / "settling-sphere"
    silt_run("run", case, "--out", out, "--overwrite", "--steps", 40)
    whole = state(out)[1]
    silt_run("run", case, "--out", out, "--overwrite", "--steps", 20, "--device", "host", "--set", "output.checkpoint.every=20")
    silt_run("resume", case, "--out", out, "--steps", 40, "--device", "cpu")
    assert state(out) == ("cpu", whole), (state(out), whole)

    refused = subprocess.run([silt, "run", case, "--out", out, "--device", "gup"], capture_output=True, text=True)
    assert refused.returncode == 2 and 'must be one of cpu, host, gpu; did you mean' in refused.stderr, refused.stderr
    asked = subprocess.run([silt, "run", case, "--out", out, "--overwrite", "--steps", "2", "--device", "gpu"], capture_output=True, text=True)
    if asked.returncode:
        assert asked.returncode == 2 and 'run.device is "gpu"' in asked.stderr and 'use run.device = "cpu"' in asked.stderr, asked.stderr
