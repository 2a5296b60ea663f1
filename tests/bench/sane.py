#!/usr/bin/python3
"""sane.py BENCH_FOLDER SILT

Runs each benchmark for a second (--quick) and looks whether its figures make sense: all there, finite, in a
range that no machine leaves. How fast they are gates nothing. Then the page and the plots of scripts/bench
all."""
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

bench, silt = map(pathlib.Path, sys.argv[1:3])
root = pathlib.Path(__file__).resolve().parents[2]
anything = (0, math.inf)
share = (1e-3, 3)
busy = (1e-6, 100)  # of two ranks: one may wait long for a core that others use
expected = {
    "fluid": {f"fluid.{p}.{k}": r for p in ("single", "double")
              for k, r in (("share", share), ("share_80", share), ("mlups", anything), ("two_rank_share", busy),
                           ("two_rank_efficiency", busy))} |
             {"fluid.two_rank_efficiency": busy},
    "coupled": {f"coupled.a.cli{body}.{k}": r for body in ("", ".box")
                for k, r in (("over_fluid", (0.5, 200)), ("ns_per_link", (-math.inf, math.inf)))},
    "links": {f"links.{scheme}.{k}": anything for scheme in ("bounce-back", "cli", "parabolic", "multireflection")
              for k in ("at_hand", "fetched", "waited_for")},
    "device": {f"device.unlike.{p}.{model}{force}": (-1e-15, 1e-15) for p in ("single", "double") for model in ("trt", "regularised")
               for force in ("", ".force")} | {f"device.{p}.48.mlups": anything for p in ("single", "double")},
    "bed": {f"bed.{n}.{p}.mlups": anything for n in (63, 225) for p in ("single", "double")},
    # what ranks send is what is counted on paper, to the byte
    "scaling": {"model.message_error": (-1e-15, 1e-15), "scaling.weak.fluid.n40": (1e-3, 20), "scaling.weak.b.n40": (1e-3, 20)},
    # populations alone: 76 bytes; a small block has much padding
    "memory": {"memory.bytes_per_cell": (76, 400), "memory.population_bytes_per_cell": (76, 200)},
}
if shutil.which("valgrind"):  # instructions are the same on every machine: here figures do gate
    rows = ["bodies", "fluid", "moving_bodies", "moved", "near_block", "solid_block", "non_spheres", "neighbour_ranks"]
    expected["skip"] = {f"skip.{row}.ratio": (0.95, 1.05) for row in rows} | \
                       {"skip.outputs.ratio": (0.98, 1.08)} | \
                       {f"skip.{row}.ratio": (0.95, 1.15) for row in ("contacts", "external_force")} | \
                       {"skip.friction.ratio": (0.5, 0.9)}
of_runs = {  # of whole runs of the program
    # the difference of two short runs: of either sign where other work disturbs them
    "output": {key: (-math.inf, math.inf) for key in ("output.share", "output.over_plain_write")},
    "rotor": {"rotor.mapping_over_fluid": (1e-3, 20), "rotor.over_fluid": (0.2, 50)},
}
only = {"skip": ["--instructions"], "coupled": ["--only", "coupled.a.cli$,coupled.a.cli.box$"]}

on_two_ranks = ["mpirun", "-n", "2", "--oversubscribe", "--quiet", *(["--allow-run-as-root"] if os.geteuid() == 0 else [])]
start = {"fluid": on_two_ranks}

table = {}
with tempfile.TemporaryDirectory() as scratch:
    folder = pathlib.Path(scratch)
    for name, keys in expected.items():
        program = [bench / "bench_device"] if name == "device" else [bench / "benchmarks", name]
        options = ["--quick", "--json", folder / f"{name}.json"]
        command = [*start.get(name, []), *program, *options]
        if name == "scaling":  # starts the benchmark itself, on 1 to 8 ranks
            command = [root / "tests" / "bench" / "scaling.py", bench / "benchmarks", *options, "--out", folder / name]
        subprocess.run([*command, *only.get(name, [])], check=True)
        result = json.loads((folder / f"{name}.json").read_text())
        figures, table[name] = result["figures"], result["table"]
        for key, (low, high) in keys.items():
            assert low < figures[key] < high, f"{key} is {figures[key]}"
    subprocess.run([root / "tests" / "bench" / "summary.py", folder], check=True)
    for name, keys in of_runs.items():
        found = folder / "runs.json"
        subprocess.run([root / "tests" / "bench" / f"{name}.py", silt, "--quick", "--json", found], check=True)
        figures = json.loads(found.read_text())["figures"]
        for key, (low, high) in keys.items():
            assert low < figures[key] < high, f"{key} is {figures[key]}"
    page = (folder / "README.md").read_text()
    for name, keys in expected.items():
        assert all(f"`{key}`" in page for key in keys), f"README.md lacks figures of {name}"
    assert "| as counted on paper |" in (folder / "scaling" / "README.md").read_text()
    for picture in "fluid.png", "bed.png", "coupled-stages.png", "scaling/stages.png", "scaling/traffic.png", "scaling/model.png":
        assert (folder / picture).stat().st_size > 1000, f"{picture} is empty"
    solid = {row["scene"]: row["solid"] for row in table["coupled"] if "solid" in row}
    assert all(abs(s - 0.063) < 0.002 for s in solid.values()), f"the paper's case A has 6.3 % solid, these have {solid}"
    for row in table["coupled"]:
        assert all(share[0] < row.get(k, 1) < share[1] for k in ("share_of_bound", "share_of_peak")), row
