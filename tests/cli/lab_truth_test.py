# SPDX-License-Identifier: Apache-2.0
"""Both sample benches, captured and calibrated at their default noise: within three predicted sigmas of the truth, which no stage reads."""
import json
import math
import pathlib

from program import ProgramTest, main

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def transposed(a):
    return [list(row) for row in zip(*a)]


def times(a, v):
    return [sum(a[i][k] * v[k] for k in range(3)) for i in range(3)]


def plus(a, b, factor=1.0):
    return [x + factor * y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(dot(a, a))
    return [x / length for x in a]


def pose(json_pose):
    r = json_pose["rotation"]
    return [r[0:3], r[3:6], r[6:9]], json_pose["translation_m"]


def true_slab(truth):
    """The slab's frame as docs/calibration.md defines it, in the bench's; delta, pitch, tilt, skew."""
    bench = truth["bench"]
    screen, on_s = pose(truth["bench_from_screen"])
    u, on_u = pose(truth["bench_from_filter"])
    places = [plus(times(u, [x, y, 0.0]), on_u) for x, y in truth["position_m"]]
    middle = [sum(p[k] for p in places) / len(places) for k in range(3)]
    z = [row[2] for row in screen]
    stage_x = [row[0] for row in u]
    x = unit(plus(stage_x, z, -dot(z, stage_x)))
    y = cross(z, x)
    delta = dot(z, plus(on_s, middle, -1.0))
    normal = [row[2] for row in u]
    scale, pitch = bench["filter"]["stage_scale"], bench["filter"]["pitch_m"]
    return {"rotation": transposed([x, y, z]), "origin": plus(middle, z, delta), "delta_m": delta,
            "u_tilt_x_rad": math.asin(-dot(y, normal)), "u_tilt_y_rad": math.atan2(dot(x, normal), dot(z, normal)),
            "pitch_x_m": pitch[0] * scale[0], "pitch_y_m": pitch[1] * scale[1],
            "skew_rad": math.radians(bench["filter"]["stage_skew_deg"])}


class SampleBenches(ProgramTest):
    def check(self, name):
        bench = SOURCE / f"sample_data/bench_{name}.json"
        plan = json.loads((SOURCE / f"sample_data/plan_{name}.json").read_text())
        plan["camera"]["device"] = f"bench:{bench}"
        pathlib.Path("plan.json").write_text(json.dumps(plan))
        for command in (("capture", "plan.json", "-o", name),
                        ("calibrate", name, "-o", f"{name}.json", "--report", f"{name}.html"),
                        ("lab", "truth", bench, "-o", f"{name}.truth.json")):
            self.done(*command)
        rig = json.loads(pathlib.Path(f"{name}.json").read_text())
        truth = json.loads(pathlib.Path(f"{name}.truth.json").read_text())
        expected = true_slab(truth)
        camera, camera_at = pose(truth["bench"]["camera"]["bench_from_camera"])
        origin_camera = times(transposed(camera), plus(expected["origin"], camera_at, -1.0))
        expected.update(zip(("slab_x_m", "slab_y_m", "slab_z_m"), origin_camera))
        # Small turns of the rig's slab against the true one, about the slab's axes.
        found, _ = pose(rig["planes"]["camera_from_slab"])
        turn = product(transposed(product(transposed(camera), expected["rotation"])), found)
        turns = {"slab_turn_x_rad": turn[2][1], "slab_turn_y_rad": turn[0][2], "slab_turn_z_rad": turn[1][0]}
        compared = 0
        report = []
        for parameter in rig["parameters"]:
            key, sigma = parameter["name"], parameter["sigma"]
            if key in turns:
                off = turns[key]
            elif key in expected:
                off = parameter["value"] - expected[key]
            else:
                continue
            report.append(f"{key}: {off / sigma:+.2f} sigma")
            self.assertLess(abs(off), 3 * sigma, f"{key} is off by {off:.3g}, sigma {sigma:.3g}")
            compared += 1
        self.assertEqual(compared, 12, report)
        self.assertLess(abs(rig["planes"]["delta_m"] / expected["delta_m"] - 1), 1e-3)
        print(name, f"delta {100 * (rig['planes']['delta_m'] / expected['delta_m'] - 1):+.4f} %;", "; ".join(report))
        self.check_radiometry(rig, truth["bench"]["camera"])

    def check_radiometry(self, rig, camera):
        sigma = {parameter["name"]: parameter["sigma"] for parameter in rig["parameters"]}
        radiometry = rig["radiometry"]
        self.assertLess(abs(radiometry["gain_e_per_dn"] - camera["gain_e_per_dn"]), 3 * sigma["gain_e_per_dn"])
        self.assertAlmostEqual(radiometry["veil_share"] / camera["veil_share"], 1, delta=0.1)
        self.assertTrue(radiometry["is_absolute"])

    def test_near(self):
        self.check("near")

    def test_far(self):
        self.check("far")


if __name__ == "__main__":
    main()
