"""Makes films of pictures, by ffmpeg."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np


class NoFilm(Exception):
    """Raised where a film cannot be made; says why."""


def moments(times, most):
    """Returns at most so many of the times, evenly apart, with the first and the last."""
    return times[np.unique(np.linspace(0, len(times) - 1, min(most, len(times))).round().astype(int))]


def require_ffmpeg():
    """Raises NoFilm without ffmpeg."""
    if not shutil.which("ffmpeg"):
        raise NoFilm("a film needs ffmpeg (apt-get install ffmpeg)")


def duration(seconds):
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} minutes"


def write_film(path, count, draw, rate):
    """Lets draw(i, picture) draw so many pictures and makes them a film of `rate` a second (H.264, which browsers and
    slides show). Says how many there are, after the first how long all take, and every ten seconds how far it is. NoFilm
    without ffmpeg, or where it fails."""
    require_ffmpeg()
    print(f"drawing {count} pictures, which ffmpeg makes a film", file=sys.stderr, flush=True)
    with tempfile.TemporaryDirectory(prefix="silt-film-") as scratch:
        begun = said = time.monotonic()
        for i in range(count):
            draw(i, pathlib.Path(scratch) / f"{i:06}.png")
            if i == 0:
                each = time.monotonic() - begun
                print(f"one takes {each:.1f} s, all about {duration(count * each)} (less with fewer --frames or a smaller --size)",
                      file=sys.stderr, flush=True)
            elif time.monotonic() - said > 10:
                said = time.monotonic()
                print(f"drawn {i + 1} of {count} pictures", file=sys.stderr, flush=True)
        even = "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white"  # as H.264 wants it
        command = ["ffmpeg", "-v", "error", "-y", "-framerate", str(rate), "-i", f"{scratch}/%06d.png", "-vf", even,
                   "-c:v", "libx264", "-pix_fmt", "yuv420p", "-movflags", "+faststart", f"file:{path.resolve()}"]
        done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
        if done.returncode != 0:
            raise NoFilm(f"ffmpeg failed\n{done.stderr[-2000:]}")
