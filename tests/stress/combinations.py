#!/usr/bin/python3
"""combinations SILT [FIRST [COUNT]]: scenes put together at random from what cases can hold, one a seed.

Sides, fluid, heat, levels of cells, shapes, fills that go on, outflows, springs, locked axes, moving walls, changes over
time, contact laws, outputs: each scene that `silt run` accepts must end with the same state on 1 and on 3 ranks, after a
resume from its middle on 2, and as the device "host". Features that are right alone fail here together.
"""
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from silt_runs import report_of, run  # noqa: E402, I001
from case_text import case_text  # noqa: E402
from random_scene import REFUSED, STONE, STOPPED, Scene, mesh_text  # noqa: E402


def states(silt, scene, folder):
    """Returns the state that each way of running a scene ends with, or its error (nothing if the scene is refused), and its text."""
    text = case_text("A combination", **scene.tables())
    (folder / "case.toml").write_text(text)
    (folder / "stone.ply").write_text(mesh_text(*STONE))
    found = {}

    def state(way, command, out, *options, ranks=1):
        done = run(silt, command, folder, "--out", folder / out, *options, ranks=ranks, code=None)
        found[way] = f"exit code {done.returncode}: {done.stderr[-400:]}" if done.returncode else report_of(folder / out)["state_hash"]
        return done.returncode

    if state("1 rank", "run", "alone") in (REFUSED, STOPPED):
        return {}, text
    state("3 ranks", "run", "ranks", ranks=3)
    middle = folder / "alone" / f"checkpoint_{scene.steps // 2:012}.h5"
    state("resumed on 2 ranks", "resume", "alone", "--checkpoint", middle, ranks=2)
    if scene.fluid:
        state("device host, 2 ranks", "run", "host", "--device", "host", ranks=2)
    return found, text


def main():
    silt, first, count = sys.argv[1], *(int(n) for n in (sys.argv[2:] + ["0", "200"][len(sys.argv) - 2:]))
    compared, faults = 0, 0
    for seed in range(first, first + count):
        with tempfile.TemporaryDirectory(prefix="silt-combination-") as folder:
            found, text = states(silt, Scene(seed), pathlib.Path(folder))
        compared += bool(found)
        if len(set(found.values())) > 1 or "exit code" in found.get("1 rank", ""):
            faults += 1
            print(f"seed {seed}: {found}\n{text}", flush=True)
    print(f"{count} scenes, {compared} accepted and compared, {faults} with a fault")
    sys.exit(faults > 0 or compared == 0)


if __name__ == "__main__":
    main()
