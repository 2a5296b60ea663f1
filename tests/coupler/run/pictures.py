#!/usr/bin/python3
"""pictures.py SILT: scripts/render on a run: no body is cut off by the frame, the scale bar is as long as it says, and a film shows the bodies
where they were."""
import os
import pathlib
import shutil
import subprocess
import unittest

import numpy as np
from PIL import Image
from silt_test import SiltTest

RENDER = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "render"
RADIUS, APART = 2.5, 17
# Two balls in a periodic box; a part of the left one, which moves, is beyond its side.
SCENE = """
[units]
system = "lattice"
[domain]
size = [24, 16, 16]
boundary = "periodic"
[contacts]
margin = 0.1
[[shapes]]
name = "ball"
type = "sphere"
radius = 2.5
[[bodies]]
shape = "ball"
name = "left"
density = 1
positions = [[1, 8, 8]]
velocity = [0.05, 0, 0]
[[bodies]]
shape = "ball"
name = "right"
density = 1
positions = [[18, 8, 8]]
[run]
steps = 40
[output]
bodies = { every = 10 }
"""
FACING = ("--azimuth", "0", "--elevation", "0", "--no-edges", "--colours", "0000ff", "ff0000")


def opened(path):
    with Image.open(path) as picture:
        return picture.convert("RGB")


def centres(picture):
    """Returns where the blue and the red ball are along the picture, and how wide they are, in pixels."""
    colours = np.asarray(picture).astype(int)
    found = []
    for own, other in ((2, 0), (0, 2)):
        columns = np.flatnonzero((colours[:, :, own] > colours[:, :, other] + 60).any(axis=0))
        found.append(((columns[0] + columns[-1] + 1) / 2, columns[-1] + 1 - columns[0]))
    return found


class Pictures(SiltTest):
    def setUp(self):
        super().setUp()
        self.write(SCENE)
        self.silt("run", self.case)

    def render(self, *arguments, code=0, **options):
        done = subprocess.run(["/usr/bin/python3", RENDER, self.case, "--size", "320", *FACING, *arguments], capture_output=True, text=True, **options)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout + done.stderr

    def test_whole_bodies_and_a_true_scale(self):
        self.render("--time", "0")
        picture = opened(self.out / "render.png")
        (left, left_width), (right, right_width) = centres(picture)
        cell = (right - left) / APART
        for width in (left_width, right_width):
            self.assertAlmostEqual(width, 2 * RADIUS * cell, delta=2)
        dark = np.asarray(picture).astype(int).max(axis=2) < 90
        longest = max(len(run) for row in dark[-30:] for run in "".join("x" if d else " " for d in row).split() or [""])
        self.assertAlmostEqual(longest, 5 * cell, delta=2)  # 5 cells: the largest of 1, 2, 5, 10 below a quarter of the width
        self.render("--time", "0", "--no-caption")
        self.assertLess(opened(self.out / "render.png").size[1], picture.size[1])

    @unittest.skipUnless(shutil.which("ffmpeg"), "there is no ffmpeg")
    def test_film(self):
        self.assertIn("film.mp4", self.render("--film"))
        frames = pathlib.Path(self.scratch.name)
        subprocess.run(["ffmpeg", "-v", "error", "-i", self.out / "film.mp4", frames / "%d.png"], check=True)
        self.assertEqual(len(list(frames.glob("*.png"))), 5)  # times 0 to 40, each 10 steps
        (left, _), (right, _) = centres(opened(frames / "1.png"))
        (moved, _), (fixed, _) = centres(opened(frames / "5.png"))
        self.assertAlmostEqual((moved - left) / (right - left), 40 * 0.05 / APART, delta=0.02)
        self.assertAlmostEqual(fixed, right, delta=2)
        self.silt("run", self.case, "--overwrite")
        self.assertFalse((self.out / "film.mp4").exists())  # a result like the others

    def test_without_ffmpeg(self):
        povray = shutil.which("povray")
        folder = pathlib.Path(self.scratch.name) / "bin"
        folder.mkdir()
        (folder / "povray").symlink_to(povray)
        self.assertIn("apt-get install ffmpeg", self.render("--film", code=1, env=dict(os.environ, PATH=str(folder))))


if __name__ == "__main__":
    unittest.main()
