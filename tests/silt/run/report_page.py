#!/usr/bin/python3
"""report_page.py SILT: scripts/report puts a run on one page that needs nothing else, says what is true and
in which units, and fits a phone."""
import html.parser
import os
import re
import shutil
import subprocess
import time
import unittest
import urllib.parse

from silt_test import CASE, ENVIRONMENT, SCRIPTS, SILT, UNSTABLE, SiltTest

from run_script import run_script  # on the path by silt_test

BROWSER = next((path for name in ("chromium", "chromium-browser", "google-chrome") if (path := shutil.which(name))), None)
REFERENCE = """
[[quantity]]
name = "height"
value = {value}
tolerance = 0.1
kind = "theory"
source = "somewhere"
"""


class Outline(html.parser.HTMLParser):
    """Checks that elements are closed in order, and collects what they refer to."""
    VOID = {"meta", "img", "br", "path", "use", "rect", "link", "input"}

    def __init__(self, text):
        super().__init__()
        self.open, self.targets, self.links, self.text = [], [], [], ""
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        if tag not in self.VOID:
            self.open.append(tag)
        self.handle_startendtag(tag, attributes)

    def handle_startendtag(self, tag, attributes):
        (self.links if tag == "a" else self.targets).extend(value for name, value in attributes if name in ("src", "href", "xlink:href"))

    def handle_endtag(self, tag):
        if tag in self.VOID:
            return
        assert self.open and self.open[-1] == tag, (tag, self.open)
        self.open.pop()

    def handle_data(self, data):
        self.text += data


class Page(SiltTest):
    def page(self, case=CASE, value=8.0, code=0, plot=False):
        self.write(case.replace("[output]", "[output]\nreport = { every = 10 }"))
        (self.case / "reference.toml").write_text(REFERENCE.format(value=value))
        self.silt("run", self.case, "--overwrite", code=code)
        if plot:
            run_script(SCRIPTS / "plot", self.case).check_returncode()
        return self.told(), (self.out / "report.html").read_text()

    def told(self):
        done = run_script(SCRIPTS / "report", self.case)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def test_is_whole_and_alone_and_fits_a_phone(self):
        said, text = self.page(plot=True)
        self.assertNotIn("http-equiv", text)  # it has ended
        (self.out / "film.mp4").write_bytes(b"a film")
        self.told()
        self.assertIn('<video controls src="film.mp4">', (self.out / "report.html").read_text())
        outline = Outline(text)
        self.assertEqual(outline.open, [])
        for target in outline.targets:
            self.assertRegex(target, r"^(data:image/png;base64,|#)")
        for word in ("Completed", "stream collide", "change over its mass", "kinematic viscosity", self.report()["state_hash"],
                     "pairs asked for", "body force"):
            self.assertIn(word, outline.text)
        times = text[text.index("Where the time went"):text.index("<h2>Contacts")]
        parts = [float(seconds) for seconds in re.findall(r">([0-9.e+-]+) s</td>", times)]
        self.assertAlmostEqual(sum(parts), self.report()["wall_seconds"], delta=0.005 * sum(parts))
        self.assertIn("output, between the steps", times)
        self.assertEqual(text.count("<img "), len(list(self.out.glob("*.png"))))
        for link in outline.links:
            self.assertTrue((self.out / urllib.parse.unquote(link)).exists(), link)
        self.assertTrue({"../case.toml", "report.json", "series.csv", "bodies.h5", "fields_000000000060.hdf"} <= set(outline.links))
        if BROWSER:
            self.fits_a_phone(text)

    def fits_a_phone(self, text):
        probe = "<script>document.title = document.documentElement.scrollWidth + ' of ' + window.innerWidth</script></body>"
        wide = self.case / "wide.html"
        wide.write_text(text.replace("</body>", probe))
        done = subprocess.run([BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--window-size=500,800", "--dump-dom", wide.as_uri()],
                              capture_output=True, text=True, timeout=60)
        width, of = map(int, re.search(r"<title>(\d+) of (\d+)", done.stdout).groups())
        self.assertLessEqual(width, of)
        self.assertLessEqual(of, 500)

    def test_each_curve_and_explanation_once(self):
        """A quantity of series.csv and of a series of its own is drawn from the finer one; quantities of one type share what is said."""
        quantity = '[[quantities]]\nname = "{}"\ntype = "mean-height"\naxis = "{}"\n'
        for every, title in ((2, "across (own)"), (30, "across")):
            series = f'[[output.series]]\nname = "own"\nevery = {every}\ncolumns = ["across"]\n'
            text = self.page(CASE + quantity.format("across", "x") + quantity.format("aside", "y") + series)[1]
            letters = re.findall(r"<text[^>]*>([^<]*)</text>", text)
            self.assertEqual([t for t in letters if t.startswith("across")], [title])
            self.assertEqual(text.count("mean coordinate of the bodies"), 1)
            self.assertIn("height, across, aside: mean coordinate", text)

    def test_units_and_sources(self):
        """Every axis has its unit, in letters that a phone shows, every quantity too; where a reference is
        from is told, and so are the speeds of each kind."""
        kinds = CASE.replace("positions = [[6, 8, 8], [18, 8, 9]]", 'name = "slow ones"\nposition = [6, 8, 8]\n[[bodies]]\nname = "fast ones"\n'
                             'shape = "ball"\ndensity = 2\nvelocity = [0.03, 0, 0]\nposition = [18, 8, 9]')
        for system, time, length, speed in (("lattice", "steps", "cells", "cells/step"), ("si", "s", "m", "m/s")):
            case = kinds if system == "lattice" else kinds.replace('"lattice"', '"si"\ncell_size = 1.0\ntime_step = 1.0').replace(
                "[fluid]", "[fluid]\ndensity = 1.0").replace("relaxation_time = 0.8", "kinematic_viscosity = 0.1")
            self.write(case)
            text = self.page(case)[1]
            figures = re.findall(r"<figure>(<svg.*?</svg>)", text, flags=re.S)
            for figure in figures:
                letters = re.findall(r"<text[^>]*>([^<]*)</text>", figure)
                self.assertIn(f"time [{time}]", letters)
                self.assertEqual(len([t for t in letters if re.fullmatch(r"\[.+\]", t)]), 1, letters)
                width = float(re.search(r'width="([0-9.]+)pt"', figure)[1])
                sizes = [float(size) for size in re.findall(r"font:[^;\"]*?([0-9.]+)px", figure)]
                self.assertGreater(min(sizes) * min(1.33, 358 / width), 9)  # pixels, on a page 390 wide less its margins
            self.assertTrue(any("slow ones" in f and "fast ones" in f and f"[{speed}]" in f for f in figures))
            self.assertTrue(any("height" in f and f"[{length}]" in f for f in figures))
            self.assertRegex(Outline(text).text, f"height[-0-9.]+80.1{length}")  # found, reference, tolerance, unit
            self.assertIn("height from theory: somewhere", Outline(text).text)

    def test_is_seen_while_it_goes_on(self):
        self.write(CASE.replace("steps = 60", "steps = 1000000").replace("fields = { every = 20 }", "report = { every = 10 }"))
        run = subprocess.Popen([SCRIPTS / "run", self.case, "--overwrite", "--silt", SILT, "--follow", "1.5", "--no-pictures"], stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL, env=ENVIRONMENT)
        try:
            while not (self.out / "report.html").exists():
                self.assertIsNone(run.poll())
                time.sleep(0.05)
            text = (self.out / "report.html").read_text()
            self.assertIn("<meta http-equiv=refresh content=2>", text)
            self.assertIn("Running:", text)
            self.assertRegex(run_script(SCRIPTS / "watch", self.case).stdout, r"two balls: running\n(no step|step \d+/1000000 )[^\n]*\n\n"
                             r"  height  [0-9.]+ cells  [▁▂▃▄▅▆▇█]{2,40}\n\n[^\n]*warning: bodies\[0\].shape: shape 'ball' is 5 cells across")
            reader, terminal = os.openpty()
            watch = subprocess.Popen([SCRIPTS / "watch", self.out, "--every", "0.1"], stdout=terminal)
            os.close(terminal)
            seen = b""
            while seen.count(b"\033[H") < 2:
                seen += os.read(reader, 1000)
        finally:
            run.terminate()
            run.wait()
        self.assertEqual(watch.wait(timeout=30), 1)  # interrupted
        os.close(reader)
        text = (self.out / "report.html").read_text()
        self.assertIn("Interrupted", text)
        self.assertNotIn("http-equiv", text)

    def test_verdict(self):
        found = self.page()[0]
        height = self.report()["quantities"]["height"]
        self.assertRegex(found, rf"height: {height:.4g}[^,]*, theory 8 ± 0.1[^(]* \({re.escape(f'{100 * height / 8 - 100:+.2f}')} %\): "
                         + ("ok" if abs(height - 8) <= 0.1 else "deviates"))
        said, text = self.page(value=12.0)
        self.assertIn(": deviates", said)
        self.assertIn("class=bad>deviates", text)

    def test_bounds_are_no_theory(self):
        """The page says that what is found is between them, and by no deviation from their middle."""
        for bounds, word in (("[7.5, 8.5]", "inside"), ("[8.5, 9.5]", "outside")):
            self.write(CASE)
            (self.case / "reference.toml").write_text(REFERENCE.replace("value = {value}\ntolerance = 0.1", f"between = {bounds}"))
            self.silt("run", self.case, "--overwrite")
            low, high = bounds.strip("[]").split(", ")
            said = self.told()
            self.assertRegex(said, rf"^height: [0-9.]+[^,%]*, between {low} and {high}[^,%]*: {word}\n")

    def test_a_reference_may_be_another_quantity(self):
        two = CASE + '[[quantities]]\nname = "other"\ntype = "mean-height"\n'
        said = self.page(two, value='"other"')[0]
        height = self.report()["quantities"]["height"]
        self.assertRegex(said, f"height: {height:.4g}[^,]*, theory {height:.4g} ")
        self.assertIn(": ok", said)
        self.assertIn(": deviates", self.page(CASE, value='"nobody"')[0])

    def test_a_length_in_seconds_is_judged(self):
        case = CASE.replace("steps = 60", "time = 60.0")
        self.assertNotEqual(case, CASE)
        self.assertIn("height: ", self.page(case)[0])

    def test_other_physics_is_not_judged(self):
        self.page()
        self.silt("run", self.case, "--overwrite", "--set", "gravity.acceleration=[0, 0, -2e-4]")
        self.assertNotIn("theory", self.told())
        self.silt("run", self.case, "--overwrite", "--set", "output.bodies={ every = 30 }", "--backend", "fcl")
        self.assertIn("theory", self.told())

    def test_a_shorter_run_is_not_judged(self):
        self.page()
        self.silt("run", self.case, "--overwrite", "--steps", 30)
        self.assertNotIn("theory", self.told())

    def test_a_title_is_text(self):
        text = self.page(CASE.replace("two balls", r"<b>two</b> & $\\frac{1}$"))[1]
        self.assertIn(r"<h1>&lt;b&gt;two&lt;/b&gt; &amp; $\frac{1}$</h1>", text)

    def test_a_stopped_run_says_why(self):
        text = self.page(UNSTABLE, code=3)[1]
        self.assertIn("Stopped by a guard", text)
        self.assertRegex(text, r"<p class=warning>step \d+: ")

    def test_without_results(self):
        for script, text in (("report", "report: .*report.json: not there; a run writes it"), ("watch", "watch: .*run.log: not there; a run writes it")):
            done = run_script(SCRIPTS / script, self.case)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, text)


if __name__ == "__main__":
    unittest.main()
