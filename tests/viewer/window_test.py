# SPDX-License-Identifier: Apache-2.0
"""The viewer as a person uses it: a window on a display without a screen (Xvfb), a mouse and a keyboard (XTest,
by xdotool). Places of widgets and times come from --trace."""
import json
import os
import pathlib
import subprocess
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "cli"))
from program import PROGRAM, ProgramTest, write_scene  # noqa: E402

WIDTH, HEIGHT = 1280, 720
WAIT_S = 240  # the machine may be busy: nothing here is a limit on speed


class Display:
    """Xvfb with a display number that is free."""

    def __enter__(self):
        read, write = os.pipe()
        self.process = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", f"{WIDTH}x{HEIGHT}x24",
                                         "-noreset"], pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as stream:
            self.name = ":" + stream.readline().strip()
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()


class Viewer:
    """A running viewer, driven by events."""

    def __init__(self, display, scene, *options):
        self.environment = {**os.environ, "DISPLAY": display.name}
        self.trace_path = pathlib.Path("trace.jsonl")
        self.trace_path.unlink(missing_ok=True)
        self.errors = open("viewer.err", "w+")
        self.process = subprocess.Popen([PROGRAM, "view", scene, "--forget", "--size", f"{WIDTH}x{HEIGHT}",
                                         "--trace", str(self.trace_path), *options],
                                        env=self.environment, stderr=self.errors)
        self.window = self.wait_for(self.find_window, "a window")
        self.xdo("windowfocus", self.window)  # no window manager does

    def xdo(self, *arguments):
        return subprocess.run(["xdotool", *map(str, arguments)], env=self.environment, capture_output=True,
                              text=True, timeout=60).stdout.strip()

    def find_window(self):
        return self.xdo("search", "--onlyvisible", "--name", "nearfield").split("\n")[-1]

    def wait_for(self, find, what):
        end = time.monotonic() + WAIT_S
        while time.monotonic() < end:
            found = find()
            if found:
                return found
            if self.process.poll() is not None:
                self.errors.seek(0)
                raise AssertionError(f"the viewer ended before {what}: {self.errors.read()}")
            time.sleep(0.05)
        raise AssertionError(f"{what} did not come")

    def events(self, kind):
        if not self.trace_path.exists():
            return []
        lines = self.trace_path.read_text().splitlines()
        found = []
        for line in lines:
            try:
                event = json.loads(line)
            except ValueError:
                continue  # the last line may be half there
            if event["event"] == kind:
                found.append(event)
        return found

    def wait_for_final(self, after=0):
        """The last frame, refined, with a serial number above `after`."""
        def find():
            frames = self.events("frame")
            return frames and frames[-1]["final"] and frames[-1]["serial"] > after and frames[-1]
        return self.wait_for(find, "a refined picture")

    def place(self, name):
        def find():
            places = self.events("places")
            return places and places[-1]["places"].get(name)
        left, top, right, bottom = self.wait_for(find, f"the widget '{name}'")
        return 0.5 * (left + right), 0.5 * (top + bottom)

    def move_to(self, x, y):
        self.xdo("mousemove", "--window", self.window, round(x), round(y))
        time.sleep(0.15)

    def click(self, name, at=0.5):
        def find():
            places = self.events("places")
            return places and places[-1]["places"].get(name)
        left, top, right, bottom = self.wait_for(find, f"the widget '{name}'")
        self.move_to(left + at * (right - left), 0.5 * (top + bottom))
        self.xdo("mousedown", 1)
        time.sleep(0.1)
        self.xdo("mouseup", 1)
        time.sleep(0.15)

    def key(self, name):
        self.xdo("keydown", *[name]) if "+" not in name else None
        time.sleep(0.05)
        self.xdo("keyup", name) if "+" not in name else self.xdo("key", "--delay", "60", name)
        time.sleep(0.15)

    def type_into(self, name, text):
        self.click(name, at=0.1)
        self.key("ctrl+a")
        self.xdo("type", "--delay", "60", text)
        self.key("Return")

    def drag(self, start, by, steps=8):
        self.move_to(*start)
        self.xdo("mousedown", 1)
        time.sleep(0.1)
        for k in range(1, steps + 1):
            self.xdo("mousemove", "--window", self.window, round(start[0] + by[0] * k / steps),
                     round(start[1] + by[1] * k / steps))
            time.sleep(0.08)
        self.xdo("mouseup", 1)
        time.sleep(0.2)

    def close(self):
        self.key("ctrl+q")
        return self.process.wait(timeout=WAIT_S)


def lamps_of(path):
    return {node["name"]: node for node in json.loads(pathlib.Path(path).read_text())["nodes"]
            if "NEARFIELD_luminaire" in node.get("extensions", {})}


def position_of(node):
    return node["matrix"][12:15] if "matrix" in node else node["translation"]


class WindowTest(ProgramTest):
    def test_a_lamp_is_moved_typed_undone_dimmed_and_saved(self):
        self.make_scene()
        before = position_of(lamps_of("scene.gltf")["left"])
        with Display() as display:
            viewer = Viewer(display, "scene.gltf")
            first = viewer.wait_for_final()
            self.assertEqual((first["width"], first["height"]), (WIDTH, HEIGHT))

            viewer.click("lamp left")
            viewer.drag(viewer.place("handle x"), (60, 0))
            viewer.type_into("y m", "0.9")
            viewer.key("space")  # off ...
            viewer.key("ctrl+z")  # ... and on again
            viewer.click("dim", at=0.25)
            viewer.click("dial", at=0.45)
            viewer.wait_for_final(after=first["serial"])
            viewer.key("ctrl+s")
            self.assertEqual(viewer.close(), 0)
        saved = lamps_of("scene.gltf")
        position = position_of(saved["left"])
        self.assertGreater(abs(position[0] - before[0]), 0.02, position)
        self.assertAlmostEqual(position[1], 0.9)
        self.assertAlmostEqual(position[2], before[2])
        extension = saved["left"]["extensions"]["NEARFIELD_luminaire"]
        self.assertAlmostEqual(extension["dim"], 0.5, delta=0.08)
        self.assertIs(extension.get("on", True), True)
        self.assertEqual(saved["right"], self.untouched)

        # Opened again it is that picture, which is the renderer's, byte by byte.
        with Display() as display:
            subprocess.run([PROGRAM, "view", "scene.gltf", "--forget", "--size", "320x180", "--screenshot", "view.png",
                            "--exit"], env={**os.environ, "DISPLAY": display.name}, check=True, timeout=WAIT_S)
        self.done("render", "scene.gltf", "--device", "gl", "--width", 320, "--height", 180, "-o", "render.exr")
        self.assertEqual(pathlib.Path("view.png").read_bytes(), pathlib.Path("render.png").read_bytes())

    def test_still_it_sleeps(self):
        self.make_scene()
        with Display() as display:
            viewer = Viewer(display, "scene.gltf")
            viewer.wait_for_final()
            time.sleep(2.0)

            def cpu_s():
                fields = pathlib.Path(f"/proc/{viewer.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
                return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
            before = cpu_s()
            time.sleep(5.0)
            self.assertLess(cpu_s() - before, 0.05)  # 1 %
            viewer.close()

    def test_a_broken_file_keeps_the_picture(self):
        self.make_scene()
        pathlib.Path("broken.gltf").write_text("{")
        with Display() as display:
            viewer = Viewer(display, "scene.gltf")
            first = viewer.wait_for_final()
            viewer.type_into("open path", "broken.gltf")
            viewer.click("open")
            time.sleep(0.5)
            self.assertIsNone(viewer.process.poll())
            viewer.click("lamp right")
            viewer.type_into("x m", "-0.3")
            viewer.wait_for_final(after=first["serial"])
            self.assertEqual(viewer.close(), 0)

    def make_scene(self):
        self.make_lamp()
        write_scene("scene.gltf", "lamp.luminaire.exr")
        scene = json.loads(pathlib.Path("scene.gltf").read_text())
        lamp = scene["nodes"].pop()
        for name, x in (("left", 0.6), ("right", -0.6)):
            scene["nodes"].append({**lamp, "name": name, "translation": [x, 0.1, 0.0]})
        scene["scenes"][0]["nodes"] = list(range(len(scene["nodes"])))
        scene["nodes"][2]["translation"] = [0.0, 0.5, -3.0]
        pathlib.Path("scene.gltf").write_text(json.dumps(scene))
        self.untouched = lamps_of("scene.gltf")["right"]


if __name__ == "__main__":
    unittest.main()
