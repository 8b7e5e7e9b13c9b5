# SPDX-License-Identifier: Apache-2.0
"""The viewer as a person uses it, in a window, with a mouse and a keyboard."""
import json
import os
import pathlib
import subprocess
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "cli"))
from driver import Display, Viewer, WAIT_S  # noqa: E402
from program import PROGRAM, ProgramTest, write_scene  # noqa: E402

SIZE = (1280, 720)


def lamps_of(path):
    return {node["name"]: node for node in json.loads(pathlib.Path(path).read_text())["nodes"]
            if "NEARFIELD_luminaire" in node.get("extensions", {})}


def position_of(node):
    return node["matrix"][12:15] if "matrix" in node else node["translation"]


class WindowTest(ProgramTest):
    def test_a_lamp_is_moved_typed_undone_dimmed_and_saved(self):
        self.make_scene()
        before = position_of(lamps_of("scene.gltf")["left"])
        with Display(SIZE) as display, self.viewer(display, "scene.gltf", "--dial", 0) as viewer:
            first = viewer.wait_for_frame()
            self.assertEqual((first["width"], first["height"]), SIZE)

            viewer.click("lamp left")
            left, top, _, _ = viewer.place("handle y")
            viewer.drag((left, top), (0, -60))
            viewer.type_into("x m", "0.5")
            viewer.key("space")  # off ...
            viewer.key("ctrl+z")  # ... and on again
            viewer.click("dim", at=0.25)
            viewer.click("dial", at=0.5)
            viewer.wait_for(lambda: viewer.last("request")["dial"] in (2, 3), "the dial's new position")
            viewer.wait_for_frame(after=first["serial"], is_final=False)
            autosave = pathlib.Path("scene.autosave.gltf")
            viewer.wait_for(lambda: autosave.exists() and position_of(lamps_of(autosave)["left"])[0] == 0.5, "autosave")
            viewer.key("ctrl+s")
            viewer.wait_for(lambda: not autosave.exists(), "the autosave's end")
            self.assertEqual(viewer.close(), 0)
        saved = lamps_of("scene.gltf")
        position = position_of(saved["left"])
        self.assertAlmostEqual(position[0], 0.5)
        self.assertGreater(position[1] - before[1], 0.02, position)
        self.assertAlmostEqual(position[2], before[2])
        extension = saved["left"]["extensions"]["NEARFIELD_luminaire"]
        self.assertAlmostEqual(extension["dim"], 0.5, delta=0.08)
        self.assertIs(extension.get("on", True), True)
        self.assertEqual(saved["right"], self.untouched)

        # Opened again it is that picture, which is the renderer's, byte by byte.
        with Display(SIZE) as display:
            subprocess.run([PROGRAM, "view", "scene.gltf", "--forget", "--size", "320x180", "--screenshot", "view.png",
                            "--exit"], env={**os.environ, "DISPLAY": display.name}, check=True, timeout=WAIT_S)
        self.done("render", "scene.gltf", "--device", "gl", "--show-lamps", "--width", 320, "--height", 180, "-o", "render.exr")
        self.assertEqual(pathlib.Path("view.png").read_bytes(), pathlib.Path("render.png").read_bytes())

    def test_still_it_sleeps(self):
        self.make_scene()
        with Display(SIZE) as display, self.viewer(display, "scene.gltf", "--dial", 0) as viewer:
            viewer.wait_for_frame()

            def share_of_a_cpu():
                before_s, start_s = viewer.cpu_s(), time.monotonic()
                time.sleep(2.0)
                return (viewer.cpu_s() - before_s) / (time.monotonic() - start_s)
            # What was under way at the last picture ends, however late on a busy machine.
            viewer.wait_for(lambda: share_of_a_cpu() < 0.01, "sleep")
            self.assertEqual(viewer.close(), 0)

    def test_a_broken_file_keeps_the_picture_and_says_why(self):
        self.make_scene()
        pathlib.Path("broken.gltf").write_text("{")
        with Display(SIZE) as display, self.viewer(display, "scene.gltf", "--dial", 0) as viewer:
            first = viewer.wait_for_frame()
            viewer.type_into("open path", "broken.gltf")
            viewer.click("open")
            viewer.wait_for(lambda: "broken.gltf: " in (viewer.last("message") or {"text": ""})["text"], "the reason")
            viewer.click("lamp right")  # of the scene that is still there
            viewer.type_into("x m", "-0.3")
            viewer.wait_for_frame(after=first["serial"])
            self.assertEqual(viewer.close(), 0)

    def viewer(self, display, *options):
        return Viewer(PROGRAM, display.name, "--size", f"{SIZE[0]}x{SIZE[1]}", *options)

    def make_scene(self):
        # Little work a pixel: what is tested here is the window.
        self.done("simulate", "headlight", "--grid", "2x1", "--texels", "8x6", "--basis", "box", "--channels", 1,
                  "-o", "lamp.lightfield.exr")
        self.done("pack", "lamp.lightfield.exr", "-o", "lamp.luminaire.exr")
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
