#!/usr/bin/python3
"""pages.py ROOT: the pages keep their form. The README is short and quotes a program that compiles; lines of prose have at most
120 characters; tables have no cell of more than 200 characters and as many cells in every row; links, with the headings that they
name, and the commands and source files in backquotes lead to places that are there; a table of the files of a room has all of them;
an equation has one number, and comments quote numbers that are there."""
import fnmatch
import pathlib
import re
import sys

LONGEST_README, LONGEST_CELL, LONGEST_LINE = 100, 200, 120
root = pathlib.Path(sys.argv[1]).resolve()
rooms = ("cpu", "device", "parallel", "lbm", "rigid", "adapters", "coupler", "silt")
folders = ("docs", *rooms, "cases", "scripts", "tests")
pages = sorted([*root.glob("*.md"), *(page for folder in folders for page in (root / folder).rglob("*.md"))])
sources = [source for folder in (*rooms, "tests", "scripts") for name in ("*.?pp", "*.cu", "*.py") for source in (root / folder).rglob(name)]
faults = []


def cells(line):
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", re.sub(r"`[^`]*`", lambda m: m[0].replace("|", "!"), line))[1:-1]]


def places(page):
    """Returns the names that links give to the headings of a page."""
    return {re.sub(r"[^\w\- ]", "", line.lstrip("# ").lower()).replace(" ", "-") for line in page.read_text().splitlines() if line.startswith("#")}


for page in pages:
    name, columns, fenced = page.relative_to(root), None, False
    text = page.read_text()
    for number, line in enumerate(text.splitlines(), 1):
        fenced ^= line.startswith("```")
        if len(line) > LONGEST_LINE and not fenced and not line.startswith(("|", "    ")):
            faults.append(f"{name}:{number}: a line has {len(line)} characters; at most {LONGEST_LINE}")
        row = cells(line) if line.startswith("|") else None
        if row is None:
            columns = None
            continue
        columns = columns or len(row)
        if len(row) != columns:
            faults.append(f"{name}:{number}: {len(row)} cells in a table of {columns} columns")
        if max(map(len, row), default=0) > LONGEST_CELL:
            faults.append(f"{name}:{number}: a cell has {max(map(len, row))} characters; at most {LONGEST_CELL}: split the row")
    for target, place in re.findall(r"\]\(([^)#\s]*)#?([^)\s]*)\)", text):
        goal = page.parent / target if target else page
        if "://" not in target and not (goal.exists() and (not place or place in places(goal))):
            faults.append(f"{name}: the link {target}{place and '#' + place} leads nowhere")
    for command in re.findall(r"`(scripts/[a-z_/.-]+)", text):
        if not (root / command).exists():
            faults.append(f"{name}: there is no {command}")
    if page.name not in ("CHANGELOG.md", "OUTPUT.md", "coming-from.md"):  # of the past, of a run, of other programs
        for file in re.findall(r"`([\w/*.-]+\.(?:[hc]pp|cu|py))`", text):
            if "NAME" not in file and not any(fnmatch.fnmatch(f"/{source.relative_to(root)}", f"*/{file}") for source in sources):
                faults.append(f"{name}: there is no {file}")
    tables = re.findall(r"^\| file.*\n\|.*\n((?:\|.*\n)+)", text, re.M) if name.parts[0] in rooms else []
    listed = [file for table in tables for row in table.splitlines() for file in re.findall(r"`([^`]+)`", cells(row)[0])]
    here = [source for source in sources if tables and source.parent == page.parent]
    found = {file: {source for source in here if source.stem == file or fnmatch.fnmatch(source.name, file)} for file in listed}
    faults += [f"{name}: there is no {file} in the folder" for file in listed if not found[file]]
    faults += [f"{name}: the table of files lacks {source.name}" for source in sorted(set(here).difference(*found.values()))]

equation = r"^    .*(?<=  )\((\d+[ab]?)\)$|^    \(([A-Z]\d+a?)\)  |^\|.*\| \((\d+)\) \|$"
numbers = ["".join(number) for page in root.glob("docs/method-*.md") for number in re.findall(equation, page.read_text(), re.M)]
for number in sorted({number for number in numbers if numbers.count(number) > 1}):
    faults.append(f"docs: two equations have the number {number}")
for source in sources:
    for number in re.findall(r"method\.md,[\s/]*equations? (\d+[ab]?)", source.read_text()):
        if number not in numbers:
            faults.append(f"{source.relative_to(root)}: no page of the method has an equation {number}")
readme = (root / "README.md").read_text()
if len(readme.splitlines()) > LONGEST_README:
    faults.append(f"README.md has {len(readme.splitlines())} lines; at most {LONGEST_README}")
program = (root / "tests/library_example.cpp").read_text()
if "\n".join(("    " + line).rstrip() for line in program.splitlines()) not in readme:
    faults.append("README.md: the program is not tests/library_example.cpp, with its includes")
variables = {name for folder in rooms for source in (root / folder).rglob("*.cpp")
             for name in re.findall(r'getenv\("(SILT_\w+)"', source.read_text())}
told = set(re.findall(r"^\| `(SILT_\w+)` \|", (root / "cases/README.md").read_text(), re.M))
for name in sorted(variables ^ told):
    faults.append(f"cases/README.md: the table of environment variables and the program do not agree on {name}")
cases = {case.parent.name for case in root.glob("cases/*/case.toml")}
for case in sorted(cases - set(re.findall(r"`([a-z0-9-]+)`", (root / "cases/README.md").read_text()))):
    faults.append(f"cases/README.md: the case {case} is not in the table")

setup = re.split(r"[\s()]+", (root / "scripts/setup").read_text())
for package in sorted(set(re.findall(r"`((?:lib|python3-)[a-z0-9+-]+)`", (root / "INSTALL.md").read_text())) - set(setup)):
    faults.append(f"INSTALL.md: scripts/setup does not install {package}")

print("\n".join(faults))
sys.exit(1 if faults or not pages else 0)
