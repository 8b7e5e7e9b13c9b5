# SPDX-License-Identifier: Apache-2.0
"""Photographs become captures, and what is odd about them is said."""
import json
import pathlib
import struct
import zlib

from program import ProgramTest, main

SHARED = pathlib.Path(__file__).resolve().parents[2].parent / "shared" / "data" / "capture"


def png(rows):
    """8-bit RGB PNG of rows of (r, g, b)."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    raw = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in rows)
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b"")


def frames(folder):
    records = [json.loads(line) for line in pathlib.Path(folder, "log.jsonl").read_text().splitlines()]
    return [record for record in records if record["record"] == "frame"]


class ImportTest(ProgramTest):
    def write(self, name, shade, border=0, size=16):
        blue, gray = (0, 0, 255), (shade, shade // 2, 7)
        rows = [[blue if x < border else gray for x in range(size)] for _ in range(size)]
        pathlib.Path("photos").mkdir(exist_ok=True)
        pathlib.Path("photos", name).write_bytes(png(rows))

    def test_a_list_of_exposures_makes_a_bracket(self):
        self.write("a1.png", 200)
        self.write("a2.png", 100, border=3)
        pathlib.Path("photos/a.hdr_image_list.txt").write_text(
            "# Number of Images\n3\na1.ppm 0.5 8 0 0\na2.ppm 2 8 0 0\na3.ppm 4 8 0 0\n")
        said = self.done("capture", "--import", "photos", "-o", "bracket").stderr
        self.assertIn("a bracket of exposures", said)
        self.assertIn("a2.png: 48 pixels of one pure color", said)
        self.assertIn("1 pictures that are not there, the first is a3", said)
        self.assertEqual([f["exposure_us"] for f in frames("bracket")], [2e6, 5e5])
        self.assertEqual([f["channels"] for f in frames("bracket")], [3, 3])
        info = json.loads(self.done("info", "bracket", "--verify", "--json").stdout)
        self.assertEqual((info["response"], info["damaged"], len(info["events"])), ("unknown", [], 2))

    def test_without_exposures_they_are_views(self):
        self.write("b1.png", 200)
        self.write("b2.png", 100, size=20)
        said = self.done("capture", "--import", "photos", "-o", "views").stderr
        self.assertIn("views of a target", said)
        self.assertIn("sizes differ", said)
        self.assertEqual([f["shot"]["view"] for f in frames("views")], [0, 1])
        self.assertEqual([f["mean_dn"] for f in frames("views")], [(200 + 100 + 7) / 3, (100 + 50 + 7) / 3])

    def test_a_known_board_makes_them_its_views(self):
        self.write("a1.png", 200)
        self.write("a2.png", 100)
        pathlib.Path("photos/a.hdr_image_list.txt").write_text("2\na1.png 0.5 8 0 0\na2.png 2 8 0 0\n")
        said = self.done("capture", "--import", "photos", "--board", "chessboard:10x7:0.025", "-o", "board").stderr
        self.assertIn("views of a target", said)
        plan = json.loads(pathlib.Path("board/capture.json").read_text())["plan"]
        self.assertEqual(plan["targets"], {"board": {"kind": "chessboard", "squares": [10, 7], "square_m": 0.025},
                                           "views": ["free", "free"]})
        self.assertNotIn("filter", plan)
        self.assertEqual([(f["shot"]["kind"], f["shot"]["view"]) for f in frames("board")], [("target", 0), ("target", 1)])
        info = json.loads(self.done("info", "board", "--json").stdout)
        self.assertEqual((info["missing"], info["frames_by_kind"]), (0, {"target": 2}))
        self.assertIn("chessboard of 10 x 7 squares of 25 mm", self.done("info", "board").stdout)
        self.assertIn("imported photographs", self.refused(1, "capture", "-o", "board", "--resume"))
        self.assertIn("--board", self.refused(1, "capture", "--import", "photos", "--board", "charuco:8x6:0.03", "-o", "x"))
        self.refused(2, "capture", "plan.json", "--board", "chessboard:10x7:0.025", "-o", "x")
        self.assertNotIn("x", self.files())

    def test_what_is_no_photograph_is_refused(self):
        self.refused(1, "capture", "--import", "nowhere", "-o", "x")
        pathlib.Path("photos").mkdir()
        self.assertIn("photographs", self.refused(1, "capture", "--import", "photos", "-o", "x"))
        pathlib.Path("photos/broken.jpg").write_bytes(b"\xff\xd8\xff\xe0 no picture")
        self.assertIn("broken.jpg", self.refused(1, "capture", "--import", "photos", "-o", "x"))
        pathlib.Path("photos/broken.jpg").unlink()
        self.write("c.png", 9)
        pathlib.Path("photos/c.hdr_image_list.txt").write_text("1\nc.png fast 8 0 0\n")
        self.assertIn("line 2", self.refused(1, "capture", "--import", "photos", "-o", "x"))
        self.assertNotIn("x", self.files())

    def test_real_photographs(self):
        if not SHARED.exists():
            self.skipTest(f"{SHARED} is absent")
        said = self.done("capture", "--import", SHARED / "debevec_memorial", "-o", "memorial").stderr
        self.assertIn("memorial0061.png: its name says png, its content is jpeg", said)
        self.assertIn("memorial0062.png: 2933 pixels of one pure color", said)
        self.assertEqual([f["exposure_us"] * 1e-6 for f in frames("memorial")], [32, 16, 8, 4, 2, 1, 0.5, 0.25])
        self.done("capture", "--import", SHARED / "chessboard", "-o", "chessboard")
        self.assertEqual(len(frames("chessboard")), 13)
        self.done("capture", "--import", SHARED / "aruco_photos", "-o", "aruco")
        phone = [f for f in frames("aruco") if f["source"] == "singlemarkersoriginal.jpg"]
        self.assertAlmostEqual(phone[0]["exposure_us"], 1e6 / 60, delta=1)


if __name__ == "__main__":
    main()
