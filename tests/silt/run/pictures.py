#!/usr/bin/python3
"""pictures.py SILT: scripts/render and scripts/plot on a run: no body is cut off by the frame, the scale bar
is as long as it says, a film shows the bodies where they were, walls are those of the run, what is solid is
no fluid at rest, and no label covers another."""
import os
import pathlib
import shutil
import subprocess
import unittest

import numpy as np
from PIL import Image
from silt_test import SCRIPTS, SiltTest, module_of, script
from silt_runs import domain_of, shape_of  # on the path by silt_test

RENDER = SCRIPTS / "render"
RADIUS, APART = 2.5, 17
# Two balls in a periodic box; a part of the left one, which moves, is beyond its side.
SCENE = (domain_of([24, 16, 16]) + "[contacts]\nmargin = 0.1\n" +
         shape_of("ball", "sphere", "radius = 2.5") +
         '[[bodies]]\nshape = "ball"\nname = "left"\ndensity = 1\npositions = [[1, 8, 8]]\n' +
         "velocity = [0.05, 0, 0]\n" +
         '[[bodies]]\nshape = "ball"\nname = "right"\ndensity = 1\npositions = [[18, 8, 8]]\n' +
         "[run]\nsteps = 40\n[output]\nbodies = { every = 10 }\n")
# A ball in an upright tube, with fluid.
TUBE = """
title = "a ball in a tube with a title that is longer than a line of a picture can be"
[units]
system = "si"
cell_size = 1e-5
time_step = 1e-6
[domain]
size = [2.4e-4, 2.4e-4, 6e-4]
boundary = { x = "no-slip", y = "no-slip", z = "periodic" }
[fluid]
density = 1000
kinematic_viscosity = 1e-5
[[walls]]
name = "tube"
type = "tube"
point = [1.2e-4, 1.2e-4, 0]
axis = "z"
radius = 1.1e-4
[[shapes]]
name = "ball"
type = "sphere"
radius = 3e-5
[[bodies]]
shape = "ball"
density = 1100
position = [1.2e-4, 1.2e-4, 3e-4]
[run]
steps = 20
[output]
bodies = { every = 10 }
fields = { every = 20, quantities = ["velocity"] }
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


def plotted(case, name):
    """Returns the figure that scripts/plot makes of a case under a name, as it is when it has been drawn."""
    plot = module_of("plot")
    plot.plt.close = lambda figure: None
    getattr(plot, name)(plot.Run(plot.silt_results.open(case)))
    figure = plot.plt.figure(plot.plt.get_fignums()[-1])
    figure.canvas.draw()
    return figure


class Walls(SiltTest):
    """The tube of the run, not of the case."""

    def setUp(self):
        super().setUp()
        self.write(TUBE)
        self.silt("run", self.case, "--set", "walls.0.radius=0.8e-4")
        (self.case / "case.toml").write_text(TUBE.replace("1.1e-4", "0.6e-4"))

    def test_render(self):
        script("render", self.case, "--size", "320", *FACING, "--no-caption")
        picture = np.asarray(opened(self.out / "render.png")).astype(int)
        ball = (picture[:, :, 2] > picture[:, :, 0] + 60).any(axis=0)
        tube = (np.abs(picture - [picture[-10, picture.shape[1] // 2]]).max(axis=2) < 60)[-10]  # below the ball
        self.assertAlmostEqual(tube.sum() / ball.sum(), 0.8e-4 / 3e-5, delta=0.15)

    def test_along_the_axis(self):
        """No half of the tube is in the way of an eye that looks along the axis: the ball is seen."""
        subprocess.run([RENDER, self.case, "--size", "320", "--elevation", "90"], check=True, capture_output=True)
        picture = np.asarray(opened(self.out / "render.png")).astype(int)
        self.assertTrue((picture[:, :, 2] > picture[:, :, 0] + 60).any())

    def test_what_is_solid_is_no_fluid_at_rest(self):
        """In the middle plane a third of the width is wall: 8 of 24 cells; the ball has the colour of its kind."""
        script("plot", self.case)
        picture = np.asarray(opened(self.out / "slice.png")).astype(int)
        row = picture[picture.shape[0] // 4]
        wall = (np.abs(row - 0xBB).max(axis=1) < 3).sum()
        fluid = ((row[:, 2] > row[:, 0] + 10) & (row.sum(axis=1) < 500))[:len(row) * 3 // 4].sum()  # dark blue, left of the bar
        self.assertAlmostEqual(wall / (wall + fluid), 8 / 24, delta=0.02)

    def test_labels_of_a_small_domain(self):
        """Micrometres, with room between the labels, in a narrow box too; nothing is wider than what can be
        read on a screen 390 pixels wide."""
        narrow = TUBE.replace("2.4e-4, 2.4e-4", "8e-5, 8e-5").replace("[1.2e-4, 1.2e-4, 3e-4]", "[4e-5, 4e-5, 3e-4]")
        narrow = narrow.replace("time_step = 1e-6", "time_step = 8e-4").replace("kinematic_viscosity = 1e-5", "kinematic_viscosity = 1.25e-8")
        self.write(narrow[:narrow.index("[[walls]]")] + narrow[narrow.index("[[shapes]]"):])
        self.silt("run", self.case, "--overwrite")
        for name in ("velocity_slice", "mean_height", "body_velocities", "bodies_picture", "stage_times"):
            figure = plotted(self.case, name)
            for axes in figure.axes:
                for along, axis in enumerate((axes.xaxis, axes.yaxis)):
                    low, high = sorted(axis.get_view_interval())
                    boxes = sorted(tuple(label.get_window_extent().get_points()[:, along]) for at, label in
                                   zip(axis.get_majorticklocs(), axis.get_majorticklabels()) if low <= at <= high and label.get_text())
                    for before, after in zip(boxes, boxes[1:]):
                        self.assertLess(before[1] + 5, after[0], name)
        self.assertEqual(plotted(self.case, "velocity_slice").axes[0].get_xlabel(), "x [µm]")
        for path in self.out.glob("*.png"):
            self.assertLessEqual(opened(path).size[0], 840, path.name)  # 150 a inch, letters of 10 points: 9 pixels high on 358


class Plots(SiltTest):
    """Seven balls apart from the middle plane, and a kind far from theirs."""

    def setUp(self):
        super().setUp()
        balls = TUBE[:TUBE.index("[[walls]]")] + TUBE[TUBE.index("[[shapes]]"):TUBE.index("[[bodies]]")]
        balls += "".join(f"""[[bodies]]
shape = "ball"
name = "{name}"
density = 1100
positions = [{places}]
""" for name, places in (("many", ", ".join(f"[{x}e-5, 5.2e-5, {z}e-5]" for x in (5, 19) for z in (5, 20, 35, 50)[:4 - (x > 5)])),
                         ("lone", "[1.2e-4, 1.9e-4, 5e-4]")))
        self.write(balls + TUBE[TUBE.index("[run]"):])
        self.silt("run", self.case)

    def test_slice_goes_through_most_bodies(self):
        axes = plotted(self.case, "velocity_slice").axes[0]
        self.assertIn("y = 65 µm", axes.get_title())
        self.assertEqual([text.get_text() for text in axes.get_legend().get_texts()], ["many"])

    def test_titles_say_what_is_drawn(self):
        self.assertIn("6 of 8 bodies", plotted(self.case, "body_velocities").axes[0].get_title())
        self.assertIn("box 240 × 240 × 600 µm", plotted(self.case, "bodies_picture")._suptitle.get_text())
        figure = plotted(self.case, "stage_times")
        self.assertIn("1 rank, 20 steps", figure._suptitle.get_text())
        title, drawn = figure._suptitle.get_window_extent(), figure.axes[0].get_tightbbox()
        self.assertAlmostEqual(title.x0 + title.x1, drawn.x0 + drawn.x1, delta=60)  # in the middle, names of the stages included


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

    def test_times_that_are_not_there(self):
        self.assertIn("render: --time 51: the bodies are there at 5 times from 0 to 40 steps", self.render("--time", "51", code=1))
        self.assertFalse((self.out / "render.png").exists())
        self.render("--time", "49")  # within an interval

    @unittest.skipUnless(shutil.which("ffmpeg"), "there is no ffmpeg")
    def test_film(self):
        said = self.render("--film")
        self.assertIn("film.mp4", said)
        self.assertRegex(said, r"drawing 5 pictures, which ffmpeg makes a film\none takes .* s, all about .* s")
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
        bare = dict(os.environ, PATH=str(folder))
        self.assertEqual(self.render("--film", code=1, env=bare), "render: a film needs ffmpeg (apt-get install ffmpeg)\n")


if __name__ == "__main__":
    unittest.main()
