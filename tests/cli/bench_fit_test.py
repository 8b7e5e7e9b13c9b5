# SPDX-License-Identifier: Apache-2.0
"""Proves that `bench fit` compares fits with a lamp that is known: errors fall with frames and grow with the planes'
nearness as they must, the solver agrees with general ones, the page fetches nothing, numbers repeat, and it refuses
what it cannot do. Not that its times are right."""
import csv
import json
import pathlib

from program import ProgramTest, main

BENCH = ["bench", "fit"]
COLUMNS = ["sweep", "setting", "value", "positions", "lambda", "noise_rms", "basis_rms", "total_rms", "flux_rel",
           "coverage", "chi_square", "kkt_worst", "factorizations", "texel_us"]
SWEEPS = {"positions", "missing", "exposures", "frames", "filter", "basis", "delta", "lambda", "model-error"}


class BenchFit(ProgramTest):
    def test_errors_follow_what_is_measured(self):
        report = json.loads(self.done(*BENCH, "-o", "out", "--quick", "--json").stdout)
        with open("out/fit.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), COLUMNS)
        self.assertEqual({row["sweep"] for row in rows}, SWEEPS)
        self.assertEqual((report["kind"], len(report["results"])), ("fit", len(rows)))
        found = {(row["sweep"], row["setting"]): {name: float(row[name]) for name in COLUMNS[2:]} for row in rows}
        for key, row in found.items():
            self.assertLess(row["kkt_worst"], 1e-9, key)
            self.assertLess(row["noise_rms"], row["basis_rms"], key)  # texels are coarse
            self.assertLess(abs(row["flux_rel"]), 0.6, key)  # of so few texels and coarse nodes
            unknown_to_sigma = key in (("exposures", "1"), ("lambda", "0.1"))
            self.assertTrue((0.5 if unknown_to_sigma else 0.8) <= row["coverage"] <= 1, key)
            self.assertGreater(row["texel_us"], 0, key)

        # Sigma is noise alone. What it does not know: how noise adds up that coefficients >= 0 cut off (one exposure), and
        # that rough noise moves a texel's factor where smoothing rules (lambda 0.1).
        for key in (("frames", "1"), ("exposures", "5"), ("missing", "0"), ("delta", "3 m"), ("model-error", "0.1")):
            self.assertGreaterEqual(found[key]["coverage"], 0.95, key)
        # 64 frames have an eighth of the noise.
        self.assertLess(found["frames", "64"]["noise_rms"], 0.5 * found["frames", "1"]["noise_rms"])
        # A fifteenth of the directions' blur.
        self.assertLess(found["delta", "3 m"]["basis_rms"], 0.5 * found["delta", "0.1 m"]["basis_rms"])
        # One exposure leaves the dark to read noise.
        self.assertLess(found["exposures", "5"]["noise_rms"], 0.5 * found["exposures", "1"]["noise_rms"])
        self.assertEqual(found["missing", "0.2"]["positions"], 99 - 20)
        self.assertEqual(found["lambda", "0.1"]["lambda"], 0.1)
        self.assertEqual(found["positions", "5 x 4"]["positions"], 20)

        solvers = report["solvers"]
        self.assertEqual([solver["times_ours"] for solver in solvers][0], 1)
        for solver in solvers[1:]:
            self.assertLess(solver["difference"], 1e-6, solver)
            self.assertGreater(solver["times_ours"], 1, solver)
        self.assertEqual(len(report["wholes"]), 4)

        page = pathlib.Path("out/fit.html").read_text()
        self.assertNotIn("<script", page.lower())
        self.assertNotRegex(page, r"""(?:src|href|xlink:href)\s*=\s*["'](?!data:)""")
        for text in ("Number of positions", "The solver&#39;s time", "Distance of the planes", "Machine and command"):
            self.assertIn(text, page)

        self.done(*BENCH, "-o", "again", "--quick")
        with open("again/fit.csv", newline="") as file:
            again = list(csv.DictReader(file))
        for row, other in zip(rows, again, strict=True):
            for name in COLUMNS[:-1]:
                self.assertEqual(row[name], other[name])

    def test_refuses_what_it_cannot_do(self):
        for arguments, texts in (
                ([*BENCH, "lamp.luminaire.exr", "-o", "out"], ["it makes its lamp"]),
                ([*BENCH, "-o", "out", "--trials", "3"], ["--trials", "bench calibration"])):
            line = self.refused(2, *arguments)
            for text in texts:
                self.assertIn(text, line, arguments)
        self.assertNotIn("out", self.files())


if __name__ == "__main__":
    main()
