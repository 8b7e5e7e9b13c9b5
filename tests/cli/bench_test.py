# SPDX-License-Identifier: Apache-2.0
"""Proves that `bench accuracy` writes what its readers rely on: columns, JSON, a page that fetches nothing; that
errors repeat bit for bit and fall with K; that it refuses what it cannot do. Not that its times are right."""
import csv
import json
import pathlib
import re

from program import POINTS_HEADER, ProgramTest, main

COLUMNS = ["sweep", "curve", "setting", "sampler", "size", "rms_rel", "rms_low_rel", "rms_high_rel", "p50_rel",
           "p95_rel", "max_rel", "bias_rel", "block_rms_rel", "time_us", "look_us", "reads", "passes",
           "on_pareto_front"]
ERRORS = [name for name in COLUMNS if name.endswith("_rel")]
SAMPLERS = ["sum", "uniform", "precomputed", "pdis", "systematic", "cells"]
BENCH = ["bench", "accuracy"]


class Bench(ProgramTest):
    def make_inputs(self):
        self.make_lamp()
        points = "".join(f"{0.3 * i - 1.2},{0.1 * j - 0.5},{4 + i},0,0,-1\n" for i in range(9) for j in range(5))
        pathlib.Path("points.csv").write_text(f"{POINTS_HEADER}\n{points}")

    def bench(self, *arguments):
        return self.done(*BENCH, "lamp.luminaire.exr", "--receivers", "points.csv", "-o", "page.html",
                         "--csv", "table.csv", *arguments)

    def rows(self):
        with open("table.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_samplers_table_json_and_page(self):
        self.make_inputs()
        result = self.bench("--k", "16,1000", "--q", "4", "--repeats", "3", "--sweeps", "samplers", "--json")
        rows = self.rows()
        self.assertEqual(list(rows[0]), COLUMNS)
        self.assertEqual(sorted({row["sampler"] for row in rows}), sorted(SAMPLERS))
        self.assertEqual({row["sweep"] for row in rows}, {"samplers"})
        self.assertEqual([row["setting"] for row in rows if row["sampler"] == "sum"], ["Q = 4", "exact"])

        error = {(row["sampler"], row["setting"]): float(row["rms_rel"]) for row in rows}
        self.assertLess(error["sum", "exact"], 1e-5)
        for sampler in ("systematic", "cells", "uniform"):
            self.assertLess(error[sampler, "K = 1000"], 0.5 * error[sampler, "K = 16"], sampler)
        for row in rows:
            self.assertGreater(float(row["time_us"]), 0.0)
            self.assertGreater(float(row["reads"]), 0.0)
            self.assertLessEqual(float(row["p50_rel"]), float(row["p95_rel"]))
            self.assertLessEqual(float(row["p95_rel"]), float(row["max_rel"]))
        self.assertIn("1", [row["on_pareto_front"].replace("true", "1") for row in rows])

        report = json.loads(result.stdout)
        self.assertEqual((report["kind"], report["receivers"]), ("accuracy", 45))
        self.assertEqual([list(entry) for entry in report["results"]], [COLUMNS] * len(rows))
        self.assertEqual([entry["sampler"] for entry in report["summary"]], SAMPLERS)
        self.assertEqual([goal["error_rel"] for goal in report["summary"][0]["goals"]], [0.1, 0.01])

    def test_the_page_is_whole_and_fetches_nothing(self):
        self.make_inputs()
        self.bench("--k", "4,16", "--q", "4", "--repeats", "1")
        page = pathlib.Path("page.html").read_text()
        self.assertNotIn("<script", page.lower())
        self.assertNotRegex(page, r"""(?:src|href|xlink:href)\s*=\s*["'](?!data:)""")
        self.assertNotRegex(page, r"url\(\s*['\"]?(?!data:|#)")
        for text in ("What an error costs", "Basis", "Sequence", "On a wall", "Machine and command", "points.csv"):
            self.assertIn(text, page)
        self.assertGreater(page.count("data:image/"), 10)
        sweeps = {row["sweep"] for row in self.rows()}
        self.assertEqual(sweeps, {"samplers", "search", "k-max", "sequence", "precision", "shift", "basis", "texels"})

    def test_errors_do_not_depend_on_the_number_of_threads(self):
        self.make_inputs()
        tables = []
        for threads in ("1", "2"):
            self.bench("--k", "4,16", "--q", "4", "--repeats", "2", "--sweeps", "samplers,sequence", "--threads", threads)
            tables.append([[row[name] for name in ("curve", "setting", "reads", *ERRORS)] for row in self.rows()])
        self.assertEqual(tables[0], tables[1])

    def test_a_time_limit_leaves_the_costly_settings_out_and_says_so(self):
        self.make_inputs()
        result = self.bench("--k", "16,16000000", "--samplers", "uniform,sum", "--sweeps", "samplers",
                            "--time-limit-s", "2")
        self.assertIn("left out by --time-limit-s: 1\n", result.stderr)
        self.assertIn("the most costly ones: 1.", pathlib.Path("page.html").read_text())

    def test_refuses_what_it_cannot_do(self):
        for arguments, texts in (
                (["bench", "speed", "-o", "x.html"], ["accuracy", "'speed'"]),
                (BENCH, ["--output is required"]),
                ([*BENCH, "-o", "x.html", "--k", "16,0"], ["--k", "1 ... ", "'16,0'"]),
                ([*BENCH, "-o", "x.html", "--q", "x"], ["--q", "'x'"]),
                ([*BENCH, "-o", "x.html", "--samplers", "sum,magic"], ["--samplers", "systematic", "'sum,magic'"]),
                ([*BENCH, "-o", "x.html", "--sweeps", "none"], ["--sweeps", "basis", "'none'"]),
                ([*BENCH, "-o", "x.html", "--repeats", "0"], ["--repeats", "1 ... 1000", "'0'"]),
                ([*BENCH, "-o", "x.html", "--time-limit-s", "0"], ["--time-limit-s", "'0'"])):
            line = self.refused(2, *arguments)
            for text in texts:
                self.assertIn(text, line, arguments)
        self.make_lamp()
        pathlib.Path("behind.csv").write_text(f"{POINTS_HEADER}\n0,0,-9,0,0,-1\n")
        line = self.refused(1, *BENCH, "lamp.luminaire.exr", "--receivers", "behind.csv", "-o", "x.html")
        self.assertIn("expected light", line)
        self.assertNotIn("x.html", self.files())


if __name__ == "__main__":
    main()
