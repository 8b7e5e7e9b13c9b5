# SPDX-License-Identifier: Apache-2.0
"""Captures by every kind of camera and instrument from one virtual bench: the same pixels, and other programs see the devices too."""
import os
import pathlib
import shutil
import subprocess
import unittest

from capture_test import SOURCE, plan, served, small_bench
from killed import SAME, frames
from program import PROGRAM, ProgramTest, main, run

# Loopback addresses of this process alone, beside those of capture_test.
ADDRESS = f"127.{128 + (os.getpid() >> 8) % 64}.{os.getpid() % 256}.1"

KINDS = {"filter": {"columns": 3, "rows": 2, "pitch_m": [0.02, 0.0216667], "basis": "bspline"},
         "filter_views": {"positions": [[0, 0], [2, 1]], "exposure_us": 30000},
         "flats": {"count": 2, "exposures_us": [2000, 5000]},
         "targets": {"board": {"kind": "charuco", "squares": [8, 6], "square_m": 0.03, "marker_m": 0.0225,
                               "dictionary": "4x4_50"}, "views": ["screen", "screen", "screen", "filter"]}}
INSTRUMENTS = {"stage": {"device": "/dev/ttyUSB0", "first_position_mm": [-150, -150], "feed_mm_per_min": 30000},
               "luxmeter": {"device": "NFLUX01"},
               "supply": {"device": "NFPSU01", "voltage_v": 12, "current_limit_a": 6, "warm_limit_rel": 0.05,
                          "warm_window_s": 0.3}}


def run_plain(*command):
    return subprocess.run(command, capture_output=True, text=True)


class LabDevicesTest(ProgramTest):
    def setUp(self):
        super().setUp()
        small_bench()

    def among_devices(self, *command):
        return self.done("lab", "devices", "bench.json", "--fast", "--", *command)

    def assert_same_as_over_the_network(self, camera):
        with served(ADDRESS, "--fast"):
            self.done("capture", plan(ADDRESS, "network.json", **KINDS), "-o", "network")
        self.among_devices(PROGRAM, "capture", plan(camera, "devices.json", instruments=INSTRUMENTS, **KINDS), "-o", "devices")
        network, devices = frames("network"), frames("devices")
        self.assertEqual(network.keys(), devices.keys())
        self.assertEqual(len(network), 4 + 4 + 2 + 5 * 2 + 6 * 3)
        for number, record in network.items():
            for key in SAME:
                self.assertEqual(record[key], devices[number][key], (number, key))
        return devices

    def test_v4l2_and_instruments_take_the_network_cameras_pixels(self):
        for record in self.assert_same_as_over_the_network("/dev/video0").values():
            is_on = record["shot"]["kind"] != "dark"
            self.assertEqual(record["lamp_voltage_v"], 12 if is_on else 0)
            self.assertAlmostEqual(record["lamp_current_a"], 4.5 if is_on else 0, delta=0.01)
            column, row = record["shot"]["position"]
            if record["shot"]["kind"] == "light":
                self.assertAlmostEqual(record["stage_mm"][0], -150 + 20 * column, delta=0.02)
                self.assertAlmostEqual(record["stage_mm"][1], -150 + 21.6667 * row, delta=0.02)
                self.assertGreater(record["reading_lx"], 0)
        info = self.done("info", "devices", "--verify").stdout
        self.assertIn("luxmeter: NEARFIELD,VLUX,NFLUX01,1", info)
        self.assertIn("stage: Grbl 1.1h", info)

    def test_usb3_vision_and_instruments_take_the_network_cameras_pixels(self):
        self.assert_same_as_over_the_network("NFU3V01")

    def test_all_devices_are_listed(self):
        lines = self.among_devices(PROGRAM, "devices").stdout.splitlines()
        for words in (("USB3Vision", "NFU3V01"), ("V4L2", "/dev/video0"), ("USBTMC", "NFLUX01"), ("USBTMC", "NFPSU01"),
                      ("serial", "/dev/ttyUSB0")):
            self.assertTrue(any(all(word in line for word in words) for line in lines), (words, lines))

    def test_a_preview_by_each_camera(self):
        for camera in ("/dev/video0", "NFU3V01"):
            self.assertIn("96 x 80 Mono12", self.among_devices(PROGRAM, "preview", camera, "--exposure-us", "5000").stdout)

    def test_other_programs_see_them(self):
        self.assertIn("cafe:0101", self.among_devices("lsusb").stdout)
        listed = self.among_devices("v4l2-ctl", "-d", "/dev/video0", "--all", "--list-formats").stdout
        for word in ("nearfield virtual bench", "'Y12 '", "exposure_time_absolute", "96/80"):
            self.assertIn(word, listed)
        self.among_devices("v4l2-ctl", "-d", "/dev/video0", "--set-ctrl=auto_exposure=1,exposure_time_absolute=50",
                           "--stream-mmap=3", "--stream-count=5", "--stream-to=raw.bin")
        self.assertEqual(pathlib.Path("raw.bin").stat().st_size, 5 * 96 * 80 * 2)

    def test_killed_at_random_moments_it_goes_on(self):
        kills = os.environ.get("NEARFIELD_KILLS", "5")
        for camera in ("/dev/video0", "NFU3V01"):
            name = plan(camera, "killed.json", instruments=INSTRUMENTS)
            result = subprocess.run([PROGRAM, "lab", "devices", "bench.json", "--fast", "--", "/usr/bin/python3",
                                     SOURCE / "tests/cli/killed.py", name, kills], capture_output=True, text=True)
            self.assertEqual(result.returncode, 0, result.stderr)
            if int(kills) >= 5:
                self.assertGreater(int(result.stdout), 0)
            shutil.rmtree("whole")

    def test_the_udev_rules_open_usb_devices(self):
        """By udev's own simulation, in a namespace whose /run it may write to."""
        script = ("mount -t tmpfs tmpfs /run && mount -t tmpfs tmpfs /dev/char && mkdir -p /run/udev/rules.d && "
                  "cp \"$1\" /run/udev/rules.d/ && udevadm test \"/sys/devices/pci0000:00/0000:00:14.0/usb1/1-$2\" 2>&1")
        own_root = ["unshare", "--map-root-user", "--mount"]
        if shutil.which("udevadm") is None or run_plain(*own_root, "mount", "-t", "tmpfs", "tmpfs", "/run").returncode != 0:
            raise unittest.SkipTest("no udevadm, or no mount namespaces")
        rules = SOURCE / "scripts/60-nearfield.rules"
        for device in ("2", "3", "4"):  # camera, luxmeter, supply
            said = self.among_devices(*own_root, "sh", "-c", script, "sh", rules, device).stdout
            self.assertRegex(said, r"60-nearfield.rules:\d+ GROUP \d+\n")
            self.assertRegex(said, r"60-nearfield.rules:\d+ MODE 0660\n")
            self.assertRegex(said, r"\nTAGS=\S*:uaccess:")
            self.assertNotRegex(said, "60-nearfield.rules.*([Ii]nvalid|[Uu]nknown|[Ii]gnor|[Ff]ail)")

    def test_the_commands_exit_code_is_passed_on(self):
        result = run("lab", "devices", "bench.json", "--", "nearfield", "preview", "/dev/video7")
        self.assertEqual(result.returncode, 1)
        self.assertIn("cannot open camera", result.stderr)
        self.assertEqual(run("lab", "devices", "bench.json", "--", "sh", "-c", "exit 7").returncode, 7)


if __name__ == "__main__":
    main()
