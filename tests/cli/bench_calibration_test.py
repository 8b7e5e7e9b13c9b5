# SPDX-License-Identifier: Apache-2.0
"""Proves that `bench calibration` compares calibrations with a truth: errors and their predictions grow with noise,
fall with boards, a bend or tilt that is ignored costs what it must, errors repeat bit for bit; that its page fetches
nothing, and that it refuses what it cannot do. Not that its times are right."""
import csv
import math
import pathlib
import re
import statistics

from program import ProgramTest, main

BENCH = ["bench", "calibration"]
COLUMNS = ["sweep", "series", "setting", "value", "trial", "delta_rel", "delta_sigma_rel", "focal_rel",
           "focal_sigma_rel", "projection_px", "projection_predicted_px", "direction_rad", "direction_parallel_rad",
           "corner_sigma_px", "rms_px", "held_out_px", "halves_ratio", "bend_significance", "time_s", "refused"]


def read_rows(folder):
    with open(f"{folder}/calibration.csv", newline="") as file:
        return list(csv.DictReader(file))


class BenchCalibration(ProgramTest):
    def median(self, rows, name, sweep, setting, series=None):
        """Of a number's size over the trials of a setting."""
        values = [abs(float(row[name])) for row in rows
                  if (row["sweep"], row["setting"]) == (sweep, setting) and series in (None, row["series"])]
        self.assertEqual(len(values), 3, (sweep, setting, series))
        return statistics.median(values)

    def test_errors_follow_what_is_wrong(self):
        self.done(*BENCH, "-o", "out", "--quick")
        rows = read_rows("out")
        self.assertEqual(list(rows[0]), COLUMNS)
        # Eight numbers of distortion of which five would do: such a fit may end anywhere, and be refused.
        rows = [row for row in rows if row["setting"] != "Brown8"]
        self.assertEqual([row["refused"] for row in rows], [""] * len(rows))
        self.assertEqual({row["sweep"] for row in rows}, {"noise", "boards", "bend", "tilt", "lens"})
        for row in rows:
            self.assertGreater(float(row["time_s"]), 0.0)
            self.assertEqual(row["held_out_px"] != "", row["sweep"] == "lens" or row["series"] == "bend ignored")

        # Ten times the noise: the same trials, so in proportion but for the fixed noise of stage and filter.
        for name, low in (("focal_rel", 7), ("focal_sigma_rel", 9), ("projection_px", 7),
                          ("projection_predicted_px", 9), ("corner_sigma_px", 9.9)):
            ratio = self.median(rows, name, "noise", "0.2 px") / self.median(rows, name, "noise", "0.02 px")
            self.assertTrue(low < ratio < 14, (name, ratio))
        # 24 views instead of 8: sqrt(3) were they all as good, and the free ones are better.
        for name in ("focal_sigma_rel", "projection_predicted_px"):
            ratio = self.median(rows, name, "boards", "4") / self.median(rows, name, "boards", "20")
            self.assertTrue(1.7 < ratio < 6, (name, ratio))
        # Sigmas are of the errors' order: three trials say no more.
        for row in rows:
            if row["sweep"] in ("noise", "boards", "tilt") or row["series"] == "bend estimated":
                self.assertLess(abs(float(row["delta_rel"])), 4 * float(row["delta_sigma_rel"]), row)
                self.assertLess(abs(float(row["focal_rel"])), 4 * float(row["focal_sigma_rel"]), row)
                self.assertLess(float(row["projection_px"]), 3 * float(row["projection_predicted_px"]), row)

        self.expect_that_what_the_model_leaves_out_costs(rows)
        self.expect_a_whole_page()

    def expect_that_what_the_model_leaves_out_costs(self, rows):
        ignored, estimated = (self.median(rows, "delta_rel", "bend", "1 mm", series)
                              for series in ("bend ignored", "bend estimated"))
        self.assertGreater(ignored, 10 * estimated)
        self.assertGreater(ignored, 5 * self.median(rows, "delta_sigma_rel", "bend", "1 mm", "bend ignored"))
        self.assertGreater(self.median(rows, "bend_significance", "bend", "1 mm", "bend ignored"), 5)
        self.assertLess(self.median(rows, "bend_significance", "bend", "0 mm", "bend ignored"), 3)

        # One degree lifts positions by up to 0.1 m sin(1 degree), 0.8 mm RMS; over 0.2 m, for rays some 0.4 off the
        # normal, that is 1.5 mrad and more.
        self.assertGreater(self.median(rows, "direction_parallel_rad", "tilt", "1 degree"),
                           1.3 * self.median(rows, "direction_rad", "tilt", "1 degree"))
        found = [self.median(rows, "direction_rad", "tilt", setting) for setting in ("0 degrees", "1 degree")]
        self.assertLess(abs(math.log(found[0] / found[1])), 0.1)

        right = self.median(rows, "projection_px", "lens", "fisheye", "fisheye")
        self.assertGreater(self.median(rows, "projection_px", "lens", "Brown5", "fisheye"), 4 * right)

    def expect_a_whole_page(self):
        page = pathlib.Path("out/calibration.html").read_text()
        self.assertNotIn("<script", page.lower())
        self.assertNotRegex(page, r"""(?:src|href|xlink:href)\s*=\s*["'](?!data:)""")
        for text in ("quick run", "Noise of corners", "A bent board", "Planes that are not parallel",
                     "The wrong lens model", "Machine and command", "nearfield bench calibration --output out --quick"):
            self.assertIn(text, page)
        self.assertIsNone(re.search(r"\bnan\b|\binf\b", page))
        self.assertGreaterEqual(page.count("data:image/"), 8)

    def test_errors_are_those_of_trial_and_seed(self):
        tables = []
        for folder, arguments in (("a", []), ("b", ["--trials", "2"]), ("c", ["--trials", "2", "--seed", "5"])):
            self.done(*BENCH, "-o", folder, "--quick", *arguments)
            tables.append([[row[name] for name in COLUMNS if name != "time_s"] for row in read_rows(folder)
                           if int(row["trial"]) < 2])
        self.assertEqual(tables[0], tables[1])
        delta = COLUMNS.index("delta_rel")
        for row, other in zip(tables[1], tables[2]):
            if row[delta]:
                self.assertNotEqual(row[delta], other[delta])

    def test_refuses_what_it_cannot_do(self):
        for arguments, texts in (
                (BENCH, ["--output is required"]),
                ([*BENCH, "-o", "out", "--trials", "1"], ["--trials", "'1'"]),
                ([*BENCH, "-o", "out", "--k", "16"], ["--k", "bench accuracy"]),
                ([*BENCH, "-o", "out", "--frame-px", "32"], ["--frame-px", "bench papers"]),
                (["bench", "papers", "-o", "out", "--trials", "3"], ["--trials", "bench calibration"]),
                (["bench", "shadows", "-o", "x.html", "--seed", "3"], ["--seed", "bench accuracy"]),
                ([*BENCH, "capture", "-o", "out"], ["neither a file nor --json"]),
                ([*BENCH, "-o", "out", "--json"], ["neither a file nor --json"])):
            line = self.refused(2, *arguments)
            for text in texts:
                self.assertIn(text, line, arguments)
        pathlib.Path("taken").write_text("a file")
        self.assertIn("taken", self.refused(1, *BENCH, "-o", "taken", "--quick"))
        self.assertEqual(self.files(), ["taken"])


if __name__ == "__main__":
    main()
