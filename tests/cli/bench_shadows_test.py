# SPDX-License-Identifier: Apache-2.0
"""Proves that `bench shadows` compares pictures by shadow maps with traced ones: the differences are those that maps
of such sizes must have, the page fetches nothing, and it refuses what it cannot do. Not that its times are right."""
import json
import pathlib

from program import ProgramTest, main, write_scene

BENCH = ["bench", "shadows", "-o", "page.html"]


class BenchShadows(ProgramTest):
    def make_scene(self):
        """Seen from the side, so that the post does not hide its own shadow. Returns the scene."""
        self.make_lamp()
        write_scene("scene.gltf", "lamp.luminaire.exr")
        scene = json.loads(pathlib.Path("scene.gltf").read_text())
        scene["nodes"][2]["translation"] = [3, 0.5, -1]
        pathlib.Path("scene.gltf").write_text(json.dumps(scene))
        return scene

    def test_finer_maps_come_nearer_to_rays(self):
        self.make_scene()
        result = self.done(*BENCH, "scene.gltf", "--width", "48", "--rays", "256", "--runs", "1", "--maps", "1",
                           "--map-px", "16,512", "--json")
        report = json.loads(result.stdout)
        self.assertEqual((report["kind"], report["width"], report["height"]), ("shadows", 48, 32))
        lab = {(entry["sweep"], entry["setting"]): entry["lab"] for entry in report["results"]}
        self.assertEqual(sorted(lab), sorted([
            ("eye", "cell"), ("eye", "paper"), ("maps", "1"), ("maps", "all"), ("map-px", "16"), ("map-px", "512"),
            ("pcf", "1"), ("pcf", "4"), ("pcf", "9"), ("pcf", "16")]))
        self.assertLess(lab["map-px", "512"], 0.5 * lab["map-px", "16"])
        self.assertLess(lab["map-px", "512"], 0.5 * report["lab_without_shadows"])
        self.assertLess(report["lab_noise"], 0.5 * report["lab_without_shadows"])
        for entry in report["results"]:
            self.assertGreater(entry["maps_s"], 0.0)
            self.assertGreater(entry["light_s"], 0.0)
            self.assertGreater(entry["bytes"], 0.0)

        page = pathlib.Path("page.html").read_text()
        self.assertNotIn("<script", page.lower())
        self.assertNotRegex(page, r"""(?:src|href|xlink:href)\s*=\s*["'](?!data:)""")
        for text in ("Number of maps", "Size of a map", "Filter", "scene.gltf", "Machine and command"):
            self.assertIn(text, page)

    def test_refuses_what_it_cannot_do(self):
        for arguments, texts in (
                (BENCH, ["a scene is required"]),
                ([*BENCH, "scene.gltf", "--k", "16"], ["--k", "bench accuracy"]),
                (["bench", "accuracy", "-o", "x.html", "--map-px", "16"], ["--map-px", "bench shadows"]),
                ([*BENCH, "scene.gltf", "--map-px", "0"], ["--map-px", "1 ... 16384", "'0'"])):
            line = self.refused(2, *arguments)
            for text in texts:
                self.assertIn(text, line, arguments)
        scene = self.make_scene()
        del scene["scenes"][0]["nodes"][1]  # the post
        pathlib.Path("open.gltf").write_text(json.dumps(scene))
        self.assertIn("no shadows", self.refused(1, *BENCH, "open.gltf", "--width", "24"))
        self.assertNotIn("page.html", self.files())


if __name__ == "__main__":
    main()
