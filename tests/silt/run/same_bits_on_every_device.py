#!/usr/bin/python3
"""same_bits_on_every_device.py SILT CASES: the passes of a device, run on the processor on any number of
ranks, give the state of its kernels, and a run goes on from one's checkpoint on the other, to the bit. What
is not there is refused by name. All cases: scripts/hashes --device host."""
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))
from silt_runs import report_of, run  # noqa: E402

silt, cases = sys.argv[1], pathlib.Path(sys.argv[2])


def silt_run(*words, **options):
    return run(silt, *words, **options)


def state(out):
    report = report_of(out)
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

    refused = silt_run("run", case, "--out", out, "--device", "gup", code=2)
    assert 'must be one of cpu, host, gpu; did you mean' in refused.stderr, refused.stderr
    asked = silt_run("run", case, "--out", out, "--overwrite", "--steps", 2, "--device", "gpu", code=None)
    if asked.returncode:
        assert asked.returncode == 2 and 'run.device is "gpu"' in asked.stderr and 'use run.device = "cpu"' in asked.stderr, asked.stderr
