# SPDX-License-Identifier: Apache-2.0
"""Proves that `bench papers` measures every figure that it promises, keeps its page and its table apart from the
network, and that its errors order as they must: more samples come nearer, the exact sum is exact, uniform samples are
behind those of the paper. Not that its times are right, nor that small lamps say anything about large ones."""
import csv
import pathlib
import re

from program import ProgramTest, main

BENCH = ["bench", "papers"]
FIGURES = ["tables", "5", "7", "8", "9", "11", "12", "13", "all", "2", "10"]


class BenchPapers(ProgramTest):
    def rows(self):
        with open("out/papers.csv", newline="") as file:
            return list(csv.DictReader(file))

    def lab(self, rows, figure, method, setting, view=None):
        found = [float(row["lab"]) for row in rows
                 if (row["figure"], row["method"], row["setting"]) == (figure, method, setting)
                 and view in (None, row["view"])]
        self.assertEqual(len(found), 1, (figure, method, setting, view))
        return found[0]

    def test_a_quick_run_measures_every_figure(self):
        self.done(*BENCH, "-o", "out", "--quick")
        rows = self.rows()
        self.assertEqual(sorted({row["figure"] for row in rows}), sorted(FIGURES))
        self.assertEqual({row["lamp"] for row in rows}, {"9x7", "5x5", "11x9", "2 x 11x9"})

        for row in rows:
            if row["method"] == "sum" and row["lab"]:
                self.assertLess(float(row["lab"]), 0.001, row)  # float against double: 1e-5 of the light
            if row["time_s"]:
                # A pass of figure 10 may have nothing to do in a frame.
                self.assertTrue(float(row["time_s"]) > 0 or row["figure"] == "10", row)
        for view in ("driver", "bird"):
            self.assertLess(self.lab(rows, "13", "systematic", "K = 400", view),
                            self.lab(rows, "13", "systematic", "K = 100", view))
        self.assertLess(self.lab(rows, "12", "pdis", "K = 252"), self.lab(rows, "12", "uniform", "K = 252"))
        self.assertLess(self.lab(rows, "5", "pdis", "bisection, to the end"),
                        self.lab(rows, "5", "pdis", "bisection, depth 1"))
        self.assertLess(self.lab(rows, "7", "eye", "cell"), self.lab(rows, "7", "none", "no shadows at all"))
        halton, independent = ([float(row["lab"]) for row in rows
                                if (row["figure"], row["setting"], row["samples"]) == ("8", setting, "100")]
                               for setting in ("halton", "independent"))
        self.assertLess(halton[0], independent[0])
        for device in {row["device"] for row in rows if row["figure"] == "10"}:
            for method in ("sum", "pdis", "systematic"):
                share = sum(float(row["share"]) for row in rows
                            if (row["figure"], row["device"], row["method"]) == ("10", device, method))
                self.assertAlmostEqual(share, 1.0, places=6)

        page = pathlib.Path("out/papers.html").read_text()
        self.assertNotIn("<script", page.lower())
        self.assertNotRegex(page, r"""(?:src|href|xlink:href)\s*=\s*["'](?!data:)""")
        for text in ("quick run", "Figure 5", "Figure 10", "Figure 13", "1.12 Lab", "513 ms", "Machine and command",
                     "nearfield bench papers --output out --quick"):
            self.assertIn(text, page)
        self.assertIsNone(re.search(r"\bnan\b|\binf\b", page))
        self.assertGreater(page.count("data:image/png"), 20)
        self.assertIn("figure12_uniform_252.png", [path.name for path in pathlib.Path("out").iterdir()])
        self.done("render", "out/5x5.gltf", "--width", "16", "-o", "again.exr")  # its scenes are there to be rendered

    def test_refuses_what_it_cannot_do(self):
        for arguments, texts in (
                (BENCH, ["--output is required"]),
                ([*BENCH, "-o", "out", "--k", "16"], ["--k", "bench accuracy"]),
                ([*BENCH, "-o", "out", "--maps", "4"], ["--maps", "bench shadows"]),
                (["bench", "accuracy", "-o", "x.html", "--quick"], ["--quick", "bench papers"]),
                ([*BENCH, "lamp.luminaire.exr", "-o", "out"], ["neither a file nor --json"]),
                ([*BENCH, "-o", "out", "--json"], ["neither a file nor --json"])):
            line = self.refused(2, *arguments)
            for text in texts:
                self.assertIn(text, line, arguments)
        pathlib.Path("taken").write_text("a file")
        self.assertIn("taken", self.refused(1, *BENCH, "-o", "taken", "--quick"))
        self.assertEqual(self.files(), ["taken"])


if __name__ == "__main__":
    main()
