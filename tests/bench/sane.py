#!/usr/bin/python3
"""sane.py BENCH_FOLDER

Runs each benchmark for a second (--quick) and looks whether its figures make sense: all there, finite, in a range that no
machine leaves. How fast they are gates nothing. Then the page and the plots of scripts/bench all."""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

bench = pathlib.Path(sys.argv[1])
root = pathlib.Path(__file__).resolve().parents[2]
anything = (0, math.inf)
share = (1e-3, 3)
expected = {
    "fluid": {f"fluid.{p}.{k}": r for p in ("single", "double")
              for k, r in (("share", share), ("share_80", share), ("mlups", anything))},
    "coupled": {"coupled.a.cli.over_fluid": (1, 100)},
    "bed": {f"bed.{n}.{p}.mlups": anything for n in (63, 225) for p in ("single", "double")},
    # populations alone: 76 bytes; a small block has much padding
    "memory": {"memory.bytes_per_cell": (76, 400), "memory.population_bytes_per_cell": (76, 200)},
}
only = {"coupled": ["--only", "coupled.a.cli$"]}

with tempfile.TemporaryDirectory() as scratch:
    folder = pathlib.Path(scratch)
    for name, keys in expected.items():
        subprocess.run([bench / f"bench_{name}", "--quick", "--json", folder / f"{name}.json", *only.get(name, [])], check=True)
        figures = json.loads((folder / f"{name}.json").read_text())["figures"]
        for key, (low, high) in keys.items():
            assert low < figures[key] < high, f"{key} is {figures[key]}"
    subprocess.run([root / "tests" / "bench" / "summary.py", folder], check=True)
    page = (folder / "README.md").read_text()
    for name, keys in expected.items():
        assert all(f"`{key}`" in page for key in keys), f"README.md lacks figures of {name}"
    assert (folder / "fluid.png").stat().st_size > 1000 and (folder / "bed.png").stat().st_size > 1000
