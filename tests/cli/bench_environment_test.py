# SPDX-License-Identifier: Apache-2.0
"""Proves that `bench environment` measures what its page says: errors fall with samples, shadows with directions, light
taken apart is kept, the page fetches nothing, and it refuses what it cannot do. Not that its times are right."""
import csv
import json
import pathlib

from program import ProgramTest, main

BENCH = ["bench", "environment"]
COLUMNS = ["study", "subject", "method", "samples", "rms", "rms_mean", "rms_toned", "lab", "bias", "spark", "time_s"]


class BenchEnvironment(ProgramTest):
    def test_errors_follow_what_is_measured(self):
        report = json.loads(self.done(*BENCH, "-o", "out", "--quick", "--json").stdout)
        with open("out/environment.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), COLUMNS)
        self.assertEqual((report["kind"], len(report["results"])), ("environment", len(rows)))
        self.assertEqual({row["study"] for row in rows}, {"sphere", "mesh", "counts", "anisotropic", "suns", "visibility", "time"})
        found = {(row["study"], row["subject"], row["method"], int(row["samples"])):
                 {name: float(row[name]) for name in COLUMNS[4:]} for row in rows}

        for study in ("sphere", "mesh"):
            of = {key[2:]: row for key, row in found.items() if key[:2] == (study, "exponent 20")}
            for method in ("fis", "far lamps", "unfiltered"):
                self.assertLess(of[method, 64]["lab"], of[method, 8]["lab"], (study, method))
            self.assertLess(of["fis", 64]["lab"], of["far lamps", 64]["lab"], study)
            self.assertLess(of["fis, suns apart", 8]["rms_mean"], 0.5 * of["fis", 8]["rms_mean"], study)
        diffuse = {key[2:]: row for key, row in found.items() if key[0] == "visibility"}
        self.assertLess(diffuse["rays", 64]["lab"], 0.5 * diffuse["no shadows", 0]["lab"])
        self.assertLess(abs(diffuse["maps", 64]["lab"] - diffuse["rays", 64]["lab"]), 0.2)
        for key, row in found.items():
            if key[0] == "suns" and key[2] == "fis, suns apart" and not key[1].endswith("0.05"):
                self.assertLess(abs(row["bias"]), 0.01, key)
        self.assertEqual([row["map"] for row in report["maps"]], 3 * ["paraboloids", "cube"])
        for round_map, cube in zip(report["maps"][2::2], report["maps"][3::2]):  # coarse levels
            self.assertLess(round_map["jump_rms"], cube["jump_rms"])
        self.assertIn("resampled", {key[2] for key in found})
        for key, row in found.items():
            self.assertGreater(row["time_s"], 0.0, key)

        page = pathlib.Path("out/environment.html").read_text()
        self.assertNotIn("<script", page.lower())
        self.assertNotRegex(page, r"""(?:src|href|xlink:href)\s*=\s*["'](?!data:)""")
        for text in ("A quick run", "What follows", "Brushed metal", "Machine and command"):
            self.assertIn(text, page)

    def test_measures_what_is_asked_for_alone(self):
        report = json.loads(self.done(*BENCH, "-o", "some", "--quick", "--json", "--studies", "maps,counts").stdout)
        self.assertEqual({row["study"] for row in report["results"]}, {"counts"})
        self.assertEqual(len(report["maps"]), 6)
        self.assertIn("maps", self.refused(2, *BENCH, "-o", "x", "--studies", "sun"))

    def test_refuses_what_it_cannot_do(self):
        self.assertIn("--k", self.refused(2, *BENCH, "-o", "x", "--k", "16"))
        self.assertIn("--mesh", self.refused(2, "bench", "fit", "-o", "x", "--mesh", "a.gltf"))
        self.assertIn("none.hdr", self.refused(1, *BENCH, "none.hdr", "-o", "x", "--quick"))
        self.assertIn("none.gltf", self.refused(1, *BENCH, "-o", "x", "--quick", "--mesh", "none.gltf"))


if __name__ == "__main__":
    main()
