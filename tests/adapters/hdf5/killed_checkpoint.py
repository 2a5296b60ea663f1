#!/usr/bin/python3
"""A run killed while it writes a checkpoint leaves a usable one: killed_checkpoint.py TEST_PROGRAM [KILLS]."""
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time

program, kills = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 8
cut_off = 0
with tempfile.TemporaryDirectory() as folder:
    environment = dict(os.environ, OMPI_MCA_btl_vader_single_copy_mechanism="none", SILT_TEST_FOLDER=folder)
    for _ in range(kills):
        newest = max(pathlib.Path(folder).glob("*.h5"), default=None)
        writer = subprocess.Popen([program, "--act", "write_checkpoints_without_end"],
                                  env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for _ in range(2000):  # until it has written one
            if max(pathlib.Path(folder).glob("*.h5"), default=None) != newest:
                break
            time.sleep(0.005)
        time.sleep(0.05 * random.random())
        assert writer.poll() is None, "the writer ended by itself"
        writer.kill()
        writer.wait()
        cut_off += len(list(pathlib.Path(folder).glob("*.part")))
        subprocess.run([program, "--act", "read_the_newest_checkpoint"], env=environment, check=True,
                       stdout=subprocess.DEVNULL)
        assert 1 <= len(list(pathlib.Path(folder).glob("*.h5"))) <= 3
print(f"{kills} kills, {cut_off} of them in the middle of a checkpoint: the newest one was whole every time")
