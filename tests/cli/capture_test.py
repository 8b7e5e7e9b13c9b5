# SPDX-License-Identifier: Apache-2.0
"""Captures over the wire from the virtual bench: whole, equal however often they are stopped, and honest about faults."""
import contextlib
import json
import os
import pathlib
import resource
import signal
import subprocess
import time

from killed import essence, frames, kill_and_resume
from program import PROGRAM, ProgramTest, main, run

SOURCE = pathlib.Path(__file__).resolve().parents[2]
# Loopback addresses of this process alone: GigE Vision's control port is the same for all.
ADDRESS = f"127.{64 + (os.getpid() >> 8) % 64}.{os.getpid() % 256}."


def small_bench(name="bench.json", **changes):
    """The near bench with few pixels and positions."""
    bench = json.loads((SOURCE / "sample_data" / "bench_near.json").read_text())
    bench["camera"]["size_px"] = [96, 80]
    for key in ("fx_px", "fy_px", "cx_px", "cy_px"):
        bench["camera"][key] *= 96 / 512
    bench["filter"]["grid"] = [3, 2]
    # Nothing that depends on when a frame is taken: captures of different moments are compared.
    bench["lamp"].update(warm_up_rel=0, walk_sigma_rel=0)
    bench["camera"].update(sensor_rise_c=0)
    for path, value in changes.items():
        part = bench
        *folders, last = path.split("__")
        for folder in folders:
            part = part[folder]
        part[last] = value
    pathlib.Path(name).write_text(json.dumps(bench))
    return name


def plan(address, name="plan.json", **changes):
    text = {"nearfield_plan": 1, "camera": {"device": address, "pixel_format": "Mono12"}, "stage": "camera",
            "filter": {"columns": 3, "rows": 2, "pitch_m": [0.016, 0.016], "basis": "bspline"},
            "exposures_us": [2000, 6000, 18000], "darks_per_exposure": 2, **changes}
    pathlib.Path(name).write_text(json.dumps(text))
    return name


@contextlib.contextmanager
def served(address, *options, bench="bench.json"):
    """The bench as a network camera."""
    server = subprocess.Popen([PROGRAM, "lab", "serve", bench, "--address", address, *map(str, options)],
                              stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        for line in server.stderr:
            if "Ctrl-C ends it" in line:
                break
        yield server
    finally:
        server.kill()
        server.communicate()


class CaptureTest(ProgramTest):
    def setUp(self):
        super().setUp()
        small_bench()

    def assert_equal_captures(self, one, other):
        self.assertEqual(essence(one), essence(other))

    def fails(self, code, *arguments, **options):
        """Expects the exit code, and remarks that end with an error; returns that."""
        result = run(*arguments, **options)
        self.assertEqual(result.returncode, code, result.stderr)
        line = result.stderr.splitlines()[-1]
        self.assertTrue(line.startswith("nearfield: error: "), result.stderr)
        return line

    def assert_complete(self, folder):
        info = json.loads(self.done("info", folder, "--verify", "--json").stdout)
        self.assertEqual((info["missing"], info["damaged"]), (0, []))
        self.assertEqual((info["provenance"]["command"], "reconnect_s" in info["provenance"]["options"]), ("capture", True))

    def test_a_capture_is_whole_and_described(self):
        with served(ADDRESS + "1", "--fast"):
            result = self.done("capture", plan(ADDRESS + "1"), "-o", "whole")
        self.assertIn("24 frames", result.stderr)
        self.assert_complete("whole")
        record = frames("whole")[10]
        self.assertIn("temperature_c", record)
        self.assertIn("reading_lx", record)
        self.refused(1, "capture", "plan.json", "-o", "whole")
        self.refused(2, "capture", "-o", "other")

    def test_without_a_wire_the_frames_are_the_same(self):
        kinds = {"filter_views": {"positions": [[0, 0], [2, 1]], "exposure_us": 30000},
                 "flats": {"count": 2, "exposures_us": [2000, 5000]},
                 "targets": {"board": {"kind": "charuco", "squares": [8, 6], "square_m": 0.03, "marker_m": 0.0225,
                                       "dictionary": "4x4_50"}, "views": ["screen", "screen", "screen", "filter"]}}
        with served(ADDRESS + "13", "--fast"):
            self.done("capture", plan(ADDRESS + "13", **kinds), "-o", "wire")
        self.done("capture", plan("bench:bench.json", "direct.json", **kinds), "-o", "direct")
        self.assert_equal_captures("wire", "direct")
        filters = [f for f in frames("direct").values() if f["shot"]["kind"] == "filter"]
        self.assertEqual([f["shot"]["position"] for f in filters], [[0, 0], [2, 1]])
        # The filter against its source: bright in its middle, and in another place for each position.
        self.assertGreater(min(f["mean_dn"] for f in filters), 52)
        self.assertNotEqual(filters[0]["xxh128"], filters[1]["xxh128"])
        self.assertIn("views      3 on the screen, 1 on the filter's plane, 0 free; 2 of the filter itself",
                      self.done("info", "direct").stdout)
        self.done("lab", "truth", "bench.json", "-o", "truth.json")
        self.assertTrue(json.loads(pathlib.Path("truth.json").read_text()))

    def test_lost_packets_lose_no_frame(self):
        with served(ADDRESS + "2", "--fast"):
            self.done("capture", plan(ADDRESS + "2"), "-o", "clean")
        with served(ADDRESS + "2", "--fast", "--drop", "0.02"):
            self.done("capture", "plan.json", "-o", "lossy")
        self.assert_equal_captures("clean", "lossy")

    def test_killed_at_random_moments_it_goes_on(self):
        with served(ADDRESS + "3", "--fast"):
            self.assertGreater(kill_and_resume(plan(ADDRESS + "3"), int(os.environ.get("NEARFIELD_KILLS", "5"))), 0)

    def test_memory_does_not_grow_with_the_plan(self):
        def peak_mib(folder, repeats):
            said = self.done("capture", plan(ADDRESS + "12", repeats=repeats), "-o", folder).stderr
            return float(said.split("peak memory ")[1].split()[0])
        with served(ADDRESS + "12", "--fast"):
            # 24 and 330 frames of 15 KiB: 4.7 MiB if they were kept.
            self.assertLess(peak_mib("long", 18), peak_mib("short", 1) + 3)

    def test_a_camera_that_dies_and_comes_back(self):
        with served(ADDRESS + "4", "--fast"):
            self.done("capture", plan(ADDRESS + "4"), "-o", "whole")
        with served(ADDRESS + "4", "--fast", "--die-after", "20") as dying:
            child = subprocess.Popen([PROGRAM, "capture", "plan.json", "-o", "parts"], stderr=subprocess.PIPE, text=True)
            dying.wait(timeout=60)
        with served(ADDRESS + "4", "--fast"):
            _, said = child.communicate(timeout=90)
        self.assertEqual(child.returncode, 0, said)
        self.assertIn("device lost", said)
        self.assertIn("device back", said)
        self.assert_equal_captures("whole", "parts")

    def test_exposure_that_is_ignored_is_named(self):
        with served(ADDRESS + "5", "--fast", "--ignore-exposure"):
            line = self.fails(1, "capture", plan(ADDRESS + "5"), "-o", "ignored")
        self.assertIn("ignores exposure", line)

    def test_a_late_exposure_is_waited_for(self):
        with served(ADDRESS + "6", "--fast"):
            self.done("capture", plan(ADDRESS + "6"), "-o", "prompt")
        with served(ADDRESS + "6", "--fast", "--exposure-latency", "2"):
            result = self.done("capture", "plan.json", "-o", "late")
        self.assertIn("camera 2 frames late", result.stderr)
        means = {number: record["mean_dn"] for number, record in frames("prompt").items()}
        for number, record in frames("late").items():
            self.assertAlmostEqual(record["mean_dn"], means[number], delta=0.01 * means[number], msg=number)

    def test_a_drifting_lamp_stops_it(self):
        small_bench("drifting.json", lamp__warm_up_rel=0.5, lamp__warm_up_s=20.0)
        with served(ADDRESS + "7", "--fast", bench="drifting.json"):
            line = self.fails(1, "capture", plan(ADDRESS + "7", drift={"every": 1, "limit_rel": 0.001}), "-o", "drifted")
        self.assertIn("drifts", line)
        self.assertTrue(frames("drifted"))

    def test_a_second_master_is_told_so(self):
        with served(ADDRESS + "8"):
            child = subprocess.Popen([PROGRAM, "capture", plan(ADDRESS + "8", repeats=50), "-o", "first"],
                                     stderr=subprocess.DEVNULL)
            while not pathlib.Path("first/log.jsonl").exists():
                time.sleep(0.05)
            line = self.refused(1, "preview", ADDRESS + "8")
            child.send_signal(signal.SIGINT)
            self.assertEqual(child.wait(timeout=60), 130)
        self.assertIn("another program controls it", line)

    def test_ctrl_c_does_not_wait_for_a_frame(self):
        with served(ADDRESS + "9"):
            exposures_us = [9.9e6, 1e7]
            for wait_s in (0.1, 0.6, 1.1, 3.0):
                child = subprocess.Popen([PROGRAM, "capture", plan(ADDRESS + "9", exposures_us=exposures_us), "-o",
                                          f"stopped{wait_s}"], stderr=subprocess.PIPE, text=True)
                time.sleep(wait_s)
                start_s = time.monotonic()
                child.send_signal(signal.SIGINT)
                _, said = child.communicate(timeout=60)
                # Less than half an exposure, however busy the machine is: it usually takes 0.1 s.
                self.assertLess(time.monotonic() - start_s, 4.5, said)
                self.assertIn(child.returncode, (130, -signal.SIGINT), said)

    def test_a_damaged_frame_is_taken_again(self):
        with served(ADDRESS + "10", "--fast"):
            self.done("capture", plan(ADDRESS + "10"), "-o", "whole")
            self.done("capture", "plan.json", "-o", "damaged")
            path = pathlib.Path("damaged", frames("damaged")[12]["file"])
            content = bytearray(path.read_bytes())
            content[len(content) // 2] ^= 1
            path.write_bytes(content)
            pathlib.Path("damaged", frames("damaged")[13]["file"]).unlink()
            result = run("info", "damaged", "--verify", "--json")
            self.assertEqual((result.returncode, json.loads(result.stdout)["damaged"]), (3, [12, 13]))
            said = self.done("capture", "-o", "damaged", "--resume").stderr
        self.assertIn("2 frames are missing or damaged", said)
        self.assert_complete("damaged")
        self.assert_equal_captures("whole", "damaged")

    def test_a_full_disk_keeps_what_was_taken(self):
        # Files may not grow beyond 20 KiB: the log hits that after some frames, as a full disk would.
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (20 << 10, resource.RLIM_INFINITY))
        with served(ADDRESS + "11", "--fast"):
            line = self.fails(1, "capture", plan(ADDRESS + "11", repeats=10), "-o", "full", preexec_fn=limit)
            self.assertIn("cannot write file", line)
            before = len(frames("full"))
            self.assertGreater(before, 5)
            self.done("capture", "-o", "full", "--resume")
        self.assert_complete("full")


if __name__ == "__main__":
    main()
