# SPDX-License-Identifier: Apache-2.0
"""The sample benches, measured over the wire at their default noise: as near to the truth as a measurement should be."""
import json
import os
import pathlib
import subprocess

from program import PROGRAM, ProgramTest, main

SOURCE = pathlib.Path(__file__).resolve().parents[2]
ADDRESS = f"127.{64 + (os.getpid() >> 8) % 64}.{os.getpid() % 256}.10"


class Closure(ProgramTest):
    def closure(self, name):
        done = subprocess.run([PROGRAM, "demo", "--lab", "--bench", SOURCE / f"sample_data/bench_{name}.json",
                               "--plan", SOURCE / f"sample_data/plan_{name}.json", "--address", ADDRESS, "-o", name],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        closure = json.loads(pathlib.Path(name, "report.json").read_text())["closure"]
        self.assertLess(closure["irradiance_rms"], 0.02)
        self.assertGreaterEqual(closure["coverage_3sigma"], 0.99)
        self.assertLess(abs(closure["flux_rel"]), 0.003)
        return closure

    def test_the_planes_close_together(self):
        self.closure("near")

    def test_the_planes_far_apart(self):
        self.assertLess(self.closure("far")["cutoff_deg"], 0.05)


if __name__ == "__main__":
    main()
