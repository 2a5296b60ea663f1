#!/usr/bin/python3
"""same_bits_on_every_device.py SILT CASES: the passes of a device, run on the processor on any number of ranks, give the state of its
kernels, and a run goes on from one's checkpoint on the other, to the bit. What is not there is refused by name. All cases:
scripts/hashes --device host."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

silt, cases = sys.argv[1], pathlib.Path(sys.argv[2])


def silt_run(*words, ranks=1):
    launcher = ["mpirun", "--oversubscribe", "--allow-run-as-root", "--quiet", "-np", str(ranks)] if ranks > 1 else []
    done = subprocess.run([*launcher, silt, *map(str, words)], capture_output=True, text=True,
                          env=dict(os.environ, OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_rmaps_base_oversubscribe="1"))
    assert done.returncode == 0, done.stderr
    return done


def state(out):
    report = json.loads((out / "report.json").read_text())
    return report["device"], report["state_hash"]


with tempfile.TemporaryDirectory() as folder:
    out = pathlib.Path(folder) / "out"
    # The last one has three levels, an inlet, an outlet and sides that let slip.
    for case, steps, ranks, *more in [("segregation", 20, (4,)), ("settling-sphere", 40, (1,), "--set", "fluid.precision=double"),
                                      ("channel", 40, (2,)), ("sphere-in-stream", 16, (1, 2, 4), "--set", "run.balance.every=0")]:
        found = []
        for device, n in [("cpu", 1), *(("host", n) for n in ranks)]:
            silt_run("run", cases / case, "--out", out, "--overwrite", "--steps", steps, "--device", device, *more, ranks=n)
            ran, hashed = state(out)
            assert ran == device, (ran, device)
            found.append(hashed)
        print(case, *found)
        assert len(set(found)) == 1, f"{case}: the state depends on the device or on the number of ranks"

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
