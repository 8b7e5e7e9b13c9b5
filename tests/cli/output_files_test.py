# SPDX-License-Identifier: Apache-2.0
"""Proves that an output is the old file or the new one, whole, and that nothing else is left, whatever ends
the program: a full disk, Ctrl-C, kill -9, a reader that goes away."""
import os
import pathlib
import resource
import signal
import subprocess
import time

from program import PROGRAM, POINTS_HEADER, ProgramTest, main, run, write_scene

# 57 MB once packed.
LARGE = ["--grid", "11x9", "--texels", "160x128", "--delta-m", "2.4"]


def small_disk():
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))


class OutputFiles(ProgramTest):
    def test_a_full_disk_leaves_the_old_file(self):
        self.make_lamp()
        old = pathlib.Path("lamp.luminaire.exr").read_bytes()
        self.assertGreater(len(old), 20_000)
        before = self.files()
        line = self.refused(1, "pack", "lamp.lightfield.exr", "-o", "lamp.luminaire.exr", preexec_fn=small_disk)
        self.assertIn("lamp.luminaire.exr: cannot write file: got File too large", line)
        self.assertEqual(pathlib.Path("lamp.luminaire.exr").read_bytes(), old)
        self.assertEqual(self.files(), before)

    def test_a_full_file_system_leaves_nothing(self):
        self.make_lamp()
        pathlib.Path("disk").mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "none", "disk"], capture_output=True)
        if mounted.returncode != 0:
            self.skipTest("needs the right to mount a small file system")
        try:
            line = self.refused(1, "pack", "lamp.lightfield.exr", "-o", "disk/lamp.luminaire.exr")
            self.assertIn("No space left on device", line)
            self.assertEqual(os.listdir("disk"), [])
        finally:
            subprocess.run(["umount", "disk"], check=True)

    def test_a_signal_while_it_computes_or_writes_leaves_the_old_file(self):
        self.make_lamp()
        write_scene("scene.gltf", "lamp.luminaire.exr")
        self.done("simulate", "headlight", *LARGE, "-o", "large.lightfield.exr")
        for command in (["pack", "large.lightfield.exr", "-o", "old.exr"],
                        ["render", "scene.gltf", "-o", "old.exr", "--width", "600"]):
            start_s = time.monotonic()
            self.done(*command)
            whole_s = time.monotonic() - start_s
            pathlib.Path("old.exr").write_text("old")
            pathlib.Path("old.png").write_text("old")
            before = self.files()
            codes = []
            for number in (signal.SIGINT, signal.SIGKILL):
                for part in (0.1, 0.4, 0.7, 0.9):
                    codes.append(self.interrupted(command, number, part * whole_s))
                    self.assertEqual(self.files(), before)
                    if pathlib.Path("old.exr").read_bytes() != b"old":  # it was faster than the signal
                        self.done("info", "old.exr", "--verify")
                        pathlib.Path("old.exr").write_text("old")
            self.assertIn(-signal.SIGINT, codes)
            self.assertIn(-signal.SIGKILL, codes)

    def interrupted(self, command, number, delay_s):
        process = subprocess.Popen([PROGRAM, *command], stderr=subprocess.DEVNULL)
        time.sleep(delay_s)
        process.send_signal(number)
        code = process.wait(timeout=60)
        self.assertIn(code, (0, -number))
        return code

    def test_without_unnamed_files_outputs_are_whole_all_the_same(self):
        # A file without a name gets one through /proc. Hidden, that stands for a file system that knows no
        # unnamed files: both make the program write under a hidden name and rename it.
        self.make_lamp()
        pathlib.Path("out").mkdir()

        def pack_without_proc(limits):
            return subprocess.run(["unshare", "--mount", "bash", "-c", "mount -t tmpfs none /proc && " + limits +
                                   'exec "$0" pack lamp.lightfield.exr --reproducible -o out/lamp.exr', PROGRAM],
                                  capture_output=True, text=True)

        if subprocess.run(["unshare", "--mount", "mount", "-t", "tmpfs", "none", "/proc"],
                          capture_output=True).returncode != 0:
            self.skipTest("needs the right to hide /proc")
        for _ in range(2):  # as a new file, and over an old one
            result = pack_without_proc("")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(os.listdir("out"), ["lamp.exr"])
        self.done("pack", "lamp.lightfield.exr", "--reproducible", "-o", "usual.exr")
        usual = pathlib.Path("usual.exr").read_bytes()
        self.assertEqual(pathlib.Path("out/lamp.exr").read_bytes(), usual)
        # A full disk: the hidden file is removed.
        full = pack_without_proc("trap '' XFSZ; ulimit -f 20; ")
        self.assertEqual(full.returncode, 1)
        self.assertIn("File too large", full.stderr)
        self.assertEqual(os.listdir("out"), ["lamp.exr"])
        # Killed while it writes: the hidden file stays, which shows that there was one; the old file is whole.
        self.assertNotEqual(pack_without_proc("ulimit -f 20; ").returncode, 0)
        self.assertEqual(sorted(name.split("-")[0] for name in os.listdir("out")), [".nearfield", "lamp.exr"])
        self.assertEqual(pathlib.Path("out/lamp.exr").read_bytes(), usual)

    def test_a_new_file_replaces_the_old_one_with_the_usual_permissions(self):
        self.make_lamp()
        self.done("pack", "lamp.lightfield.exr", "-o", "new.exr", preexec_fn=lambda: os.umask(0o027))
        for _ in range(2):
            self.assertEqual(os.stat("new.exr").st_mode & 0o777, 0o640)
            self.done("pack", "lamp.lightfield.exr", "-o", "new.exr", "--lean", preexec_fn=lambda: os.umask(0o027))


class Streams(ProgramTest):
    def test_a_reader_that_goes_away_ends_it_quietly(self):
        self.make_lamp()
        points = "\n".join([POINTS_HEADER] + ["0,0,10,0,0,-1"] * 5000)  # more than a pipe holds
        pathlib.Path("points.csv").write_text(points)
        result = subprocess.run(
            f"set -o pipefail; '{PROGRAM}' probe lamp.luminaire.exr --points points.csv | head -n 1",
            shell=True, executable="/bin/bash", capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue(result.stdout.startswith(POINTS_HEADER))
        self.assertNotIn("nearfield: error", result.stderr)

    def test_what_is_said_holds_no_control_characters_where_no_terminal_reads_it(self):
        self.make_lamp()
        write_scene("scene.gltf", "lamp.luminaire.exr")
        for command in (["simulate", "headlight", "--grid", "5x4", "--texels", "32x24", "-o", "x.exr"],
                        ["render", "scene.gltf", "-o", "x.exr", "--width", "64"]):
            result = self.done(*command)
            self.assertEqual(result.stdout, "")
            self.assertFalse(any(c < " " and c != "\n" for c in result.stderr), repr(result.stderr))

    def test_closed_standard_streams_do_not_spoil_the_output(self):
        self.make_lamp()
        command = f"'{PROGRAM}' pack lamp.lightfield.exr --reproducible -o"
        for name, streams in (("open.exr", ""), ("closed.exr", "<&- >&- 2>&-")):
            subprocess.run(f"{command} {name} {streams}", shell=True, check=True, stderr=subprocess.DEVNULL)
        self.assertEqual(pathlib.Path("open.exr").read_bytes(), pathlib.Path("closed.exr").read_bytes())

    def test_remarks_that_nobody_can_read_are_no_failure(self):
        self.make_lamp()
        with open("/dev/full", "w") as full:
            self.assertEqual(
                subprocess.run([PROGRAM, "pack", "lamp.lightfield.exr", "-o", "x.exr"], stderr=full).returncode, 0)
        self.assertEqual(run("info", "x.exr", "--verify").returncode, 0)


if __name__ == "__main__":
    main()
