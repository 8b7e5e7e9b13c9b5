# SPDX-License-Identifier: Apache-2.0
"""Kills captures at random moments and goes on with them: each must become what one that was left alone is.

Also a program, for a shell among simulated devices: killed.py PLAN KILLS."""
import json
import pathlib
import random
import shutil
import subprocess
import sys
import time

from program import PROGRAM, run

SAME = ("shot", "exposure_us", "gain_db", "pixel_format", "size_px", "bits", "xxh128")


def frames(folder):
    """What a reader of the log sees: the last line of every shot, and the frame's bytes."""
    kept = {}
    for line in pathlib.Path(folder, "log.jsonl").read_text().splitlines():
        record = json.loads(line)
        if record["record"] == "frame":
            kept[record["shot"]["number"]] = record
        elif record["record"] == "reject":
            for number in record["shots"]:
                kept.pop(number)
    return kept


def essence(folder):
    return {number: [record[key] for key in SAME] for number, record in frames(folder).items()}


def done(*arguments):
    result = run(*arguments)
    if result.returncode != 0:
        raise AssertionError(f"{arguments}: {result.stderr}")
    return result.stdout


def kill_and_resume(plan, kills):
    """How many captures of so many were killed late enough to go on with. Raises AssertionError where one is not as it should be."""
    random.seed(3)
    start_s = time.monotonic()
    done("capture", plan, "-o", "whole")
    whole_s = time.monotonic() - start_s
    resumed = 0
    for k in range(kills):
        child = subprocess.Popen([PROGRAM, "capture", plan, "-o", "killed"], stderr=subprocess.DEVNULL)
        time.sleep(random.uniform(0, whole_s))
        child.kill()
        child.wait()
        if pathlib.Path("killed/capture.json").exists():
            done("capture", "-o", "killed", "--resume")
            info = json.loads(done("info", "killed", "--verify", "--json"))
            if (info["missing"], info["damaged"]) != (0, []) or essence("killed") != essence("whole"):
                raise AssertionError(f"kill {k}: not what a capture is that was left alone")
            resumed += 1
        shutil.rmtree("killed", ignore_errors=True)
    return resumed


if __name__ == "__main__":
    print(kill_and_resume(sys.argv[1], int(sys.argv[2])))
