#!/usr/bin/python3
"""tutorial.py SILT [FOLDER]: cases/TUTORIAL.md runs as it stands, comes to the figures that it tells of, and
its notebook is made of it. FOLDER: where the module `silt` is; without it the part that needs it is left
out."""
import contextlib
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

MODULE = pathlib.Path(sys.argv.pop(2)).resolve() if len(sys.argv) > 2 else None
SILT = pathlib.Path(sys.argv.pop(1)).resolve()
ROOT = pathlib.Path(__file__).resolve().parents[3]
PAGE = (ROOT / "cases/TUTORIAL.md").read_text()
sys.path.insert(0, str(ROOT / "scripts"))

import matplotlib  # noqa: E402

matplotlib.use("Agg")


class Tutorial(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="silt-tutorial-")
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        (self.folder / "scripts").symlink_to(ROOT / "scripts")
        (self.folder / "build/release/bin").mkdir(parents=True)
        (self.folder / "build/release/bin/silt").symlink_to(SILT)
        if MODULE:
            (self.folder / "build/release/python").symlink_to(MODULE)

    def shell(self, text):
        words = f" --silt {SILT} --no-pictures" if re.match("scripts/(run|sweep) ", text) else ""
        done = subprocess.run(["bash", "-e", "-c", text + words], cwd=self.folder, capture_output=True, text=True, env=dict(os.environ, SILT_PLAIN="1"))
        self.assertEqual(done.returncode, 0, text + done.stdout + done.stderr)
        self.assertNotIn("warning", done.stdout + done.stderr)

    def test_it_comes_to_its_answer(self):
        names, said = {}, io.StringIO()
        with contextlib.chdir(self.folder), contextlib.redirect_stdout(said):
            for language, text in re.findall(r"^```(\w+)\n(.*?)^```$", PAGE, flags=re.M | re.S):
                if language == "bash":
                    self.shell(text.strip())
                elif language == "toml":
                    (self.folder / re.match("# (.*)", text)[1]).write_text(text)
                elif MODULE or "import silt\n" not in text:
                    exec(text, names)  # noqa: S102
        for picture in ("speed", "answer"):
            self.assertTrue((self.folder / f"bead/{picture}.png").exists())
        shares = [float(x) for x in re.findall(r"m2/s: [0-9.]+ mm/s, ([0-9.]+) of", said.getvalue())]
        told = [float(x) for x in re.search(r"down to ([0-9.]+), ([0-9.]+) and ([0-9.]+) of that speed", PAGE).groups()]
        self.assertTrue(all(abs(found - on_page) < 0.011 for found, on_page in zip(shares, told)) and len(shares) == 3, shares)
        drag = names["bead"]["drag"]
        weight = 160 * 3.14159 / 6 * 0.004**3 * 9.81
        self.assertAlmostEqual(drag[len(drag) // 2] / weight, 1, delta=0.02)  # at a steady speed
        if MODULE:
            self.assertGreater(names["lifted"]["velocity"][-1], 0.004)  # m/s, upwards

    def test_its_notebook_is_made_of_it(self):
        made = self.folder / "made.ipynb"
        subprocess.run([ROOT / "scripts/notebook", ROOT / "cases/TUTORIAL.md", made], check=True, capture_output=True)
        self.assertEqual(made.read_text(), (ROOT / "cases/tutorial.ipynb").read_text(), "make it anew: scripts/notebook cases/TUTORIAL.md cases/tutorial.ipynb")


if __name__ == "__main__":
    unittest.main()
