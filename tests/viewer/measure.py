#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the viewer by the clock: first picture, feedback to a drag, processor time of a still window.

    tests/viewer/measure.py build/release/nearfield out/scene.gltf "left headlight"

Without --display in Xvfb, where OpenGL is a rasterizer on the CPU; with it (":0") on a screen, by the graphics card."""
import argparse
import os
import pathlib
import statistics
import tempfile
import time

from driver import Display, Viewer

SIZE = (1280, 720)
MOVES, STEP_PX, PAUSE_S = 100, 2, 0.03  # of the mouse in a drag: 30 a second


def first_picture_s(viewer):
    start = viewer.wait_for(lambda: viewer.last("start"), "the start")
    frame = viewer.wait_for(lambda: next(iter(viewer.all_of("frame")), None), "a picture")
    return start["clock_s"] + frame["t_ms"] / 1000 - viewer.start_s, frame


def drag_feedback(viewer, lamp):
    """Frames that answered a drag of the lamp's handle, from when it began to when the button was let go."""
    viewer.click(f"lamp {lamp}")
    left, top, _, _ = viewer.place("handle x")
    viewer.move_to(left, top)
    viewer.press(True)
    before = len(viewer.all_of("frame"))
    for k in range(MOVES):
        there_and_back = STEP_PX * min(k, MOVES - k)
        viewer.xdo("mousemove", "--window", viewer.window, round(left + there_and_back), round(top))
        time.sleep(PAUSE_S)
    frames = viewer.all_of("frame")[before:]
    viewer.press(False)
    return [frame for frame in frames if "feedback_ms" in frame]


def idle_share(viewer, for_s=10.0):
    viewer.move_to(SIZE[0] / 2, SIZE[1] - 80)
    time.sleep(1.0)
    before_s, start_s = viewer.cpu_s(), time.monotonic()
    time.sleep(for_s)
    return (viewer.cpu_s() - before_s) / (time.monotonic() - start_s)


def measure(program, scene, lamp, display_name, waits):
    with Viewer(program, display_name, scene, "--size", f"{SIZE[0]}x{SIZE[1]}", "--dial", 0) as viewer:
        first_s, frame = first_picture_s(viewer)
        viewer.wait_for_frame()  # programs are compiled then
        print(f"first picture        {first_s:6.2f} s after the start, {frame['width']} x {frame['height']}")
        frames = drag_feedback(viewer, lamp)
        feedback_ms = sorted(frame["feedback_ms"] for frame in frames)
        sizes = sorted({frame["width"] for frame in frames})
        print(f"feedback to a drag   {statistics.median(feedback_ms):6.0f} ms median, {feedback_ms[-1]:.0f} ms worst of "
              f"{len(feedback_ms)}, {sizes[0]} to {sizes[-1]} pixels wide")
        if waits:
            viewer.wait_for_frame(after=frames[-1]["serial"] - 1)
            print(f"a still window       {100 * idle_share(viewer):6.2f} % of a processor")
        viewer.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scene")
    parser.add_argument("lamp", help="its name in the scene")
    parser.add_argument("--display", help="an X display with nobody at its mouse")
    parser.add_argument("--no-idle", action="store_true", help="do not wait for the refined picture")
    options = parser.parse_args()
    paths = [pathlib.Path(path).resolve() for path in (options.program, options.scene)]
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        if options.display:
            measure(*paths, options.lamp, options.display, not options.no_idle)
            return
        with Display(SIZE) as display:
            measure(*paths, options.lamp, display.name, not options.no_idle)


if __name__ == "__main__":
    main()
