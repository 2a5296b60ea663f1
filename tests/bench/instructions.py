#!/usr/bin/python3
"""instructions.py BENCHMARKS RECORD [--record]

Counts instructions a cell, a link and a pair of cylinders (benchmarks instructions, by callgrind) and compares
them with those in RECORD. More than `tolerance` above the record fails: something became dearer. As much
below it fails too, so that the record follows. --record writes the record anew."""
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

bench, record = sys.argv[1], pathlib.Path(sys.argv[2])
with tempfile.TemporaryDirectory() as folder:
    out = pathlib.Path(folder) / "figures.json"
    subprocess.run([bench, "instructions", "--json", out], check=True)
    found = json.loads(out.read_text())["figures"]

known = tomllib.loads(record.read_text())
if sys.argv[3:] == ["--record"]:
    lines = [line for line in record.read_text().splitlines() if line.startswith(("#", "compiler", "tolerance"))]
    lines += ["", "[figures]"] + [f'"{key}" = {value:.2f}' for key, value in found.items()]
    record.write_text("\n".join(lines) + "\n")
    sys.exit()

bad = 0
for key, value in found.items():
    before = known["figures"].get(key)
    change = value / before - 1 if before else float("inf")
    if abs(change) > known["tolerance"]:
        bad += 1
        print(f"{key}: {value:.2f}, on record {before}: {100 * change:+.1f} %, allowed {100 * known['tolerance']:.0f} %")
if missing := set(known["figures"]) - set(found):
    sys.exit(f"on record, but not counted: {', '.join(sorted(missing))}")
if bad:
    sys.exit(f"if this is meant: {sys.argv[0]} {bench} {record} --record")
