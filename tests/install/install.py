#!/usr/bin/python3
"""install.py BUILD: installs what was built; a program of its own is built on that by find_package(silt) and
runs, another tree takes the library by add_subdirectory, a Debian package names what it needs, and a build
without engines is configured and says so."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]


def done(*command, **options):
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    assert result.returncode == 0, f"{command}\n{result.stdout}{result.stderr}"
    return result.stdout


class Install(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory(prefix="silt-install-")
        self.folder = pathlib.Path(self.scratch.name)

    def tearDown(self):
        self.scratch.cleanup()

    def test_installed(self):
        prefix, build = self.folder / "prefix", self.folder / "build"
        done("cmake", "--install", BUILD, "--prefix", prefix)
        done("cmake", "-S", HERE, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}", "-DCMAKE_BUILD_TYPE=Release")
        done("cmake", "--build", build)
        # a metre of fall takes (2 h / g)^(1/2) = 0.4515 s; the case is of steps of half a millisecond: after
        # 1000 it is on its way up
        said = done(build / "falling_ball", ROOT / "cases" / "bouncing-ball")
        rebound = 0.8 * (2 * 9.81 * 1) ** 0.5
        since = 0.5 - (2 / 9.81) ** 0.5
        self.assertAlmostEqual(0.1 * float(said.split()[-2]), 0.05 + rebound * since - 9.81 * since**2 / 2, delta=2e-3)
        self.assertIn("cells", done(prefix / "bin" / "silt", "check", prefix / "share" / "silt" / "cases" / "bouncing-ball"))
        modules = prefix / "lib/python3/dist-packages"
        for module in ["silt_results"] + ["silt"] * any(modules.glob("silt.*.so")):
            done("/usr/bin/python3", "-c", f"import {module}; print({module})", env=dict(os.environ, PYTHONPATH=str(modules)))

    def test_package(self):
        if not shutil.which("dpkg-shlibdeps"):  # a package would depend on nothing
            return self.assertIn('set(CPACK_GENERATOR "TGZ")', (BUILD / "CPackConfig.cmake").read_text())
        done("cpack", "-B", self.folder, cwd=BUILD)
        (package,) = self.folder.glob("silt_*.deb")
        depends = done("dpkg-deb", "-f", package, "Depends")
        for library in ("libopenmpi", "libhdf5-openmpi", "libqhull", "libbullet", "libfcl"):
            self.assertIn(library, depends)

    def test_as_a_folder(self):
        build = self.folder / "build"
        done("cmake", "-S", HERE, "-B", build, "-G", "Ninja", f"-DSILT={ROOT}", "-DSILT_WITH_FCL=OFF", "-DSILT_WITH_BULLET=OFF")
        targets = done("ninja", "-C", build, "-t", "targets", "all")
        self.assertIn("falling_ball", targets)
        self.assertNotIn("gtest", targets)
        self.assertNotIn("silt_fcl", targets)
        done("ninja", "-C", build, "silt_toml")  # one small library of it


if __name__ == "__main__":
    unittest.main()
