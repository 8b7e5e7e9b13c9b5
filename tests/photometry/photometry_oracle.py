#!/usr/bin/env python3
"""Independent oracle for luminaire photometry: IES LM-63 (.ies) and EULUMDAT (.ldt).
photometry_oracle.py [--array] FILE...     (one JSON object a line; --array: one JSON list)

FRAME (right-handed, fixed to the luminaire, z up):
  type C and EULUMDAT  gamma = 0 is straight down (-z), gamma = 180 is +z; C = 0 is +x, C = 90 is +y.
  type A  V = -90 is -z, V = +90 is +z; (H = 0, V = 0) is +x; H turns clockwise seen from above, so
          (H = 90, V = 0) is -y.
  type B  (H = 0, V = 0) is -z; V = 90 at H = 0 is +x; the polar axis is horizontal: H = +90 is -y and
          H = -90 is +y.  (LM-63-2002: "photometric zero" at H = V = 0 for B and C, H clockwise for A, B.)
QUADRATURE (flux_lm): intensity is bilinear in the two tabulated angles in every cell and that function
  is integrated exactly over solid angle: closed form of (linear in angle) * sin(angle from the type's
  pole), trapezium in azimuth.  Symmetries are unfolded first.  Intensity is zero outside the tabulated
  range, whose edge counts as inside.  At a pole azimuth 0 is used.  flux_trapezium_lm, for comparison
  only, is the trapezium rule on intensity * sin in both angles.
OPENING: metres as stated (LM-63 signs kept: negative is round; LDT width 0: circular).  LM-63 width lies
  along y (90-270), length along x (0-180); LDT length along y (C90-C270), width along x, largest height.
INTENSITY: LM-63 candela = value * multiplier * ballast factor (* ballast-lamp factor in 1986 and 1991);
  EULUMDAT candela = value * conversion factor * flux of the first lamp set / 1000.
"""
import json, math, os, re, sys
from collections import namedtuple

NUMBER = re.compile(r"[+-]?(\d{1,30}\.?\d*|\.\d+)([eE][+-]?\d{1,2})?")
TOLERANCE = 1e-6                        # degrees
DOWN, PLUS_X, PLUS_Y, MINUS_Y = (0, 0, -1), (1, 0, 0), (0, 1, 0), (0, -1, 0)
# The axes of polar angle 0, of azimuth 0 and of azimuth 90:
FRAMES = {"C": (DOWN, PLUS_X, PLUS_Y), "A": (DOWN, PLUS_X, MINUS_Y), "B": (PLUS_Y, DOWN, PLUS_X)}
PROBES = [(0, 0, -1), (0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0),
          (0.6, 0, -0.8), (-0.6, 0, -0.8), (0, 0.6, -0.8), (0, -0.6, -0.8),
          (0.36, 0.48, -0.8), (-0.36, 0.48, -0.8), (-0.36, -0.48, -0.8), (0.36, -0.48, -0.8),
          (0.64, 0.48, -0.6), (0.28, -0.96, 0), (0.48, 0.6, 0.64), (36 / 901, 48 / 901, -899 / 901)]

class Refused(Exception):
    """Arguments: reason, line number."""

def require(condition, reason, line):
    if not condition:
        raise Refused(reason, line)
# ---- geometry and integration -------------------------------------------------------------------
def same(a, b):
    return abs(a - b) < TOLERANCE

def mirrored(angles, rows):
    """Continue planes by their mirror images beyond the last one."""
    return angles + [2 * angles[-1] - a for a in angles[-2::-1]], rows + rows[-2::-1]

def bracket(grid, x):
    """Cell index and fraction of x in an ascending grid, (None, None) outside."""
    if x < grid[0] - TOLERANCE or x > grid[-1] + TOLERANCE:
        return None, None
    i = 0
    while i < len(grid) - 2 and x >= grid[i + 1]:
        i += 1
    return i, min(1.0, max(0.0, (x - grid[i]) / (grid[i + 1] - grid[i])))

def sine_cell(a, b):
    """Integrals of (b - t)/(b - a) sin t and of (t - a)/(b - a) sin t from a to b."""
    mean = (math.sin(b) - math.sin(a)) / (b - a)
    return math.cos(a) - mean, mean - math.cos(b)

def trapezium_cell(a, b):
    return (b - a) / 2, (b - a) / 2

def weights(degrees, cell):
    """Integral of a piecewise linear function as weights of its node values."""
    result = [0.0] * len(degrees)
    for k in range(len(degrees) - 1):
        left, right = cell(math.radians(degrees[k]), math.radians(degrees[k + 1]))
        result[k] += left
        result[k + 1] += right
    return result

class Web(namedtuple("Web", "kind azimuth polar rows")):
    """Candela as rows[azimuth][polar], angles in degrees, all symmetries unfolded."""
    def flux(self, across):
        around = weights(self.azimuth, trapezium_cell)
        return math.fsum(w * a * v for w, row in zip(around, self.rows) for a, v in zip(across, row))

    def intensity(self, direction):
        pole, zero, quarter = (sum(a * b for a, b in zip(axis, direction)) for axis in FRAMES[self.kind])
        radius = math.hypot(zero, quarter)
        azimuth = math.degrees(math.atan2(quarter, zero)) if radius > 1e-12 else 0.0
        if self.kind == "C":
            azimuth = self.azimuth[0] + (azimuth - self.azimuth[0]) % 360
        i, s = bracket(self.azimuth, azimuth)
        j, t = bracket(self.polar, math.degrees(math.atan2(radius, pole)))
        if i is None or j is None:
            return 0.0
        low, high = self.rows[i], self.rows[i + 1]
        return (1 - s) * ((1 - t) * low[j] + t * low[j + 1]) + s * ((1 - t) * high[j] + t * high[j + 1])

def c_web(symmetry, planes, gamma, rows):
    """Unfold C planes to the full circle; symmetry as EULUMDAT's Isym, planes given up to the mirror."""
    if symmetry == 1:
        planes, rows = [0.0], rows[:1]
    for _ in range({2: 1, 3: 1, 4: 2}.get(symmetry, 0)):
        planes, rows = mirrored(planes, rows)
    if not same(planes[-1] - planes[0], 360):
        planes, rows = planes + [planes[0] + 360], rows + rows[:1]
    return Web("C", planes, gamma, rows)

def unit_vector(kind, azimuth, polar):
    a, p = math.radians(azimuth), math.radians(polar)
    parts = (math.cos(p), math.sin(p) * math.cos(a), math.sin(p) * math.sin(a))
    return [sum(c * axis[k] for c, axis in zip(parts, FRAMES[kind])) for k in range(3)]

def read_lines(path):
    with open(path, "rb") as handle:
        text = handle.read().decode("latin-1").removeprefix("\xef\xbb\xbf")
    return text.rstrip(" \t\r\n\x1a\x00").replace("\r\n", "\n").replace("\r", "\n").split("\n")

class Numbers:
    """Words (with their line numbers) read one number at a time; `split` cuts a line into words."""
    def __init__(self, lines, first_line, split=lambda text: text.replace(",", " ").split()):
        self.words = [(word, n) for n, text in enumerate(lines, first_line) for word in split(text)]
        self.position, self.last_line = 0, first_line + len(lines) - 1

    def at(self, line):
        """For a file with one word a line: go on at this line."""
        self.position = line - 1
        return self

    def number(self, what):
        require(self.position < len(self.words), "file ends where %s is expected" % what, self.last_line)
        word, self.line = self.words[self.position]
        self.position += 1
        require(NUMBER.fullmatch(word), "%s is not a number: %r" % (what, word[:40]), self.line)
        return float(word)

    def whole(self, what, least, most=10 ** 9):
        value = self.number(what)
        require(value == int(value) and least <= value <= most,
                "%s must be a whole number from %d to %d, not %g" % (what, least, most, value), self.line)
        return int(value)

    def positive(self, what):
        value = self.number(what)
        require(value > 0, "%s must be positive, not %g" % (what, value), self.line)
        return value

    def several(self, count, what):
        return [self.number("%s %d of %d" % (what, k + 1, count)) for k in range(count)]

    def angles(self, count, what, low, high):
        values = []
        for value in (self.number("%s %d of %d" % (what, k + 1, count)) for k in range(count)):
            require(low <= value <= high, "%s must lie in %g..%g, not %g" % (what, low, high, value), self.line)
            require(not values or value > values[-1], "%s do not ascend at %g" % (what, value), self.line)
            values.append(value)
        return values

    def finish(self):
        for word, line in self.words[self.position:]:
            raise Refused("more values than the header's counts: %r" % word[:40], line)
# ---- LM-63 --------------------------------------------------------------------------------------
def lm63_version(first_line):
    text = first_line.strip().upper()
    known = {"91": "1991", "95": "1995", "02": "2002", "19": "2019"} if text.startswith(("IESNA", "IES:")) else {}
    return known.get(text[-2:], "1986")     # no format line: free label lines

def read_tilt(numbers, kind):
    geometry, count = numbers.whole("lamp-to-luminaire geometry", 1, 3), numbers.whole("number of tilt angles", 1)
    return {"kind": kind, "geometry": geometry, "angles": numbers.angles(count, "tilt angles", -360, 360),
            "factors": numbers.several(count, "tilt factor")}

def tilt_of(word, numbers, folder, line, notes):
    require(word, "TILT= names nothing", line)
    if word.upper() == "NONE":
        return {"kind": "NONE"}
    if word.upper() == "INCLUDE":
        return read_tilt(numbers, "INCLUDE")
    path = os.path.join(folder, os.path.basename(word.replace("\\", "/")))
    if not os.path.isfile(path):
        notes.append("tilt file not found beside the photometric file; not needed for these results")
        return {"kind": "FILE"}
    try:
        return read_tilt(Numbers(read_lines(path), 1), "FILE")
    except Refused as problem:
        raise Refused("tilt file: %s (its line %d)" % problem.args, line)

def lm63_symmetry(horizontal, line, notes):
    """The angles' range tells the symmetry of type C; as EULUMDAT's Isym."""
    for symmetry, first, last in ((4, 0, 90), (2, 0, 180), (3, 90, 270)):
        if same(horizontal[0], first) and same(horizontal[-1], last):
            return symmetry
    if len(horizontal) == 1:
        return 1
    require(same(horizontal[0], 0) and horizontal[-1] > 180,
            "type C horizontal angles run from %g to %g" % (horizontal[0], horizontal[-1]), line)
    if not same(horizontal[-1], 360):
        notes.append("horizontal angles end at %g: closed to 360 with the first plane" % horizontal[-1])
    return 0

def lm63_web(kind, vertical, horizontal, rows, line, notes):
    if kind == "C":
        return c_web(lm63_symmetry(horizontal, line, notes), horizontal, vertical, rows)
    require(len(horizontal) > 1 and horizontal[0] < TOLERANCE,
            "type %s needs several horizontal angles, the first 0 or negative" % kind, line)
    if same(horizontal[0], 0):          # one side given: mirror it about H = 0
        horizontal, rows = mirrored([-h for h in horizontal[::-1]], rows[::-1])
    if kind == "A":
        return Web("A", horizontal, [v + 90 for v in vertical], rows)
    return Web("B", vertical, [h + 90 for h in horizontal], [list(column) for column in zip(*rows)])

def read_lm63(path):
    lines, notes = read_lines(path), []
    line = next((n for n, text in enumerate(lines, 1) if re.match(r"\s*TILT\s*=", text, re.I)), None)
    require(line, "no TILT= line", len(lines))
    year, numbers = lm63_version(lines[0]), Numbers(lines[line:], line + 1)
    tilt = tilt_of(lines[line - 1].split("=", 1)[1].strip(), numbers, os.path.dirname(path), line, notes)
    lamps, lumens = numbers.whole("number of lamps", 0), numbers.number("lumens per lamp")
    multiplier = numbers.positive("multiplier")
    n_vertical, n_horizontal = numbers.whole("vertical count", 2), numbers.whole("horizontal count", 1)
    kind = " CBA"[numbers.whole("photometric type", 1, 3)]
    units = ("", "feet", "metres")[numbers.whole("units type", 1, 2)]
    opening = [d * (0.3048 if units == "feet" else 1) for d in numbers.several(3, "opening dimension")]
    ballast, (second, watts) = numbers.positive("ballast factor"), numbers.several(2, "second factor or watts")
    factor = multiplier * ballast * (second if year in ("1986", "1991") else 1)
    vertical = numbers.angles(n_vertical, "vertical angles", *((0, 180) if kind == "C" else (-90, 90)))
    limits = {"C": (0, 360), "A": (-180, 180), "B": (-90, 90)}[kind]
    horizontal, angle_line = numbers.angles(n_horizontal, "horizontal angles", *limits), numbers.line
    rows = [[factor * v for v in numbers.several(n_vertical, "candela at horizontal angle %g," % h)]
            for h in horizontal]
    numbers.finish()
    head = {"format": "LM-63-" + year, "type": kind, "tilt": tilt, "lamps": lamps, "lamp_lumens": lumens,
            "absolute": lumens < 0, "multiplier": multiplier, "candela_factor": factor, "watts": watts,
            "units": units, "opening_m": dict(zip(("width", "length", "height"), opening))}
    web = lm63_web(kind, vertical, horizontal, rows, angle_line, notes)
    return report(head, web, vertical, horizontal, rows, notes)
# ---- EULUMDAT -----------------------------------------------------------------------------------
def ldt_planes(symmetry, angles, line):
    """C angles of the stored planes in file order; Isym 3 runs from C270 over C0 to C90."""
    n = len(angles)
    require(n % {2: 2, 3: 4, 4: 4}.get(symmetry, 1) == 0, "Mc = %d does not suit Isym = %d" % (n, symmetry), 4)
    planes = angles[:{0: n, 1: 1, 2: n // 2 + 1, 3: n // 4 + 1, 4: n // 4 + 1}[symmetry]]
    if symmetry == 3:
        planes = [a - 360 for a in angles[3 * n // 4:]] + planes
    ends = {2: (0, 180), 3: (-90, 90), 4: (0, 90)}.get(symmetry, (planes[0], planes[-1]))
    require(same(planes[0], ends[0]) and same(planes[-1], ends[1]),
            "planes C%g to C%g do not suit Isym = %d" % (planes[0] % 360, planes[-1], symmetry), line)
    return planes

def read_ldt(path):
    numbers = Numbers(read_lines(path), 1, lambda text: [text.strip().replace(",", ".")])
    symmetry = numbers.at(3).whole("symmetry Isym", 0, 4)
    n_c, n_g = numbers.at(4).whole("number of C planes", 1), numbers.at(6).whole("number of gamma angles", 2)
    length, width, *heights = [v / 1000 for v in numbers.at(16).several(6, "luminous area size")]
    conversion, sets = numbers.at(24).positive("conversion factor"), numbers.at(26).whole("number of lamp sets", 1)
    lamps, lumens = numbers.at(27).number("number of lamps"), numbers.at(29).positive("lamp flux")
    angles = numbers.at(27 + 6 * sets + 10).angles(n_c, "C angles", 0, 360 - TOLERANCE)
    angle_line, gamma = numbers.line, numbers.angles(n_g, "gamma angles", 0, 180)
    planes, factor = ldt_planes(symmetry, angles, angle_line), conversion * lumens / 1000
    rows = [[factor * v for v in numbers.several(n_g, "intensity at C%g," % (c % 360))] for c in planes]
    numbers.finish()
    head = {"format": "EULUMDAT", "type": "C", "isym": symmetry, "lamps": lamps, "lamp_lumens": lumens,
            "lamp_sets": sets, "absolute": lamps < 0, "multiplier": conversion, "candela_factor": factor,
            "units": "mm", "opening_m": {"width": width, "length": length, "height": max(heights)}}
    web = c_web(symmetry, planes, gamma, rows)
    return report(head, web, gamma, [c % 360 for c in planes], rows, [])
# ---- output -------------------------------------------------------------------------------------
def pole_notes(web, peak):
    for k, end in ((0, 0), (-1, 180)):
        values = [row[k] for row in web.rows]
        if same(web.polar[k], end) and max(values) - min(values) > 1e-3 * abs(peak):
            yield "planes disagree at a pole: %g to %g cd" % (min(values), max(values))

def report(head, web, vertical, horizontal, rows, notes):
    """Add the results to the header; vertical, horizontal and rows are as the file has them."""
    peak = max(max(row) for row in rows)
    ties = [(h, v) for h, row in zip(horizontal, rows) for v, cd in zip(vertical, row) if cd == peak]
    h, v = ties[0]                      # the first in file order
    azimuth, polar = {"C": (h, v), "A": (h, v + 90), "B": (v, h + 90)}[web.kind]
    notes.extend(pole_notes(web, peak))
    notes.extend(["negative intensities, kept as they are"] if min(min(row) for row in rows) < 0 else [])
    by_sine = [w * math.sin(math.radians(p)) for w, p in zip(weights(web.polar, trapezium_cell), web.polar)]
    head.update({
        "n_vertical": len(vertical), "n_horizontal": len(horizontal),
        "vertical_range": [vertical[0], vertical[-1]], "horizontal_range": [horizontal[0], horizontal[-1]],
        "flux_lm": web.flux(weights(web.polar, sine_cell)), "flux_trapezium_lm": web.flux(by_sine),
        "peak_cd": peak, "peak_vertical": v, "peak_horizontal": h, "peak_nodes": len(ties),
        "peak_direction": [round(c, 9) + 0.0 for c in unit_vector(web.kind, azimuth, polar)],
        "probes": [{"direction": list(d), "cd": web.intensity(d)} for d in PROBES], "notes": notes})
    return head

def examine(path):
    reader = {".ies": read_lm63, ".ldt": read_ldt}.get(os.path.splitext(path)[1].lower())
    try:
        require(reader, "neither .ies nor .ldt", 0)
        return dict({"file": path}, **reader(path))
    except Refused as problem:
        return dict(zip(("file", "error", "line"), (path,) + problem.args))

def main(arguments):
    results = [examine(path) for path in arguments if path != "--array"]
    print(json.dumps(results, indent=1) if "--array" in arguments else "\n".join(map(json.dumps, results)))

if __name__ == "__main__":
    main(sys.argv[1:])
