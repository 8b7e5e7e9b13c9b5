#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Proves that every formats/shared/*.glsl.h is GLSL 4.50 as it stands: each is compiled into a compute shader by
glslangValidator. That they are C++ is proven by the build. Says nothing about results being equal on both sides.

usage: shared_headers.py PROJECT_FOLDER. Exits 0 if all compile, 1 if one does not, 77 (skipped) without the compiler.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77  # SKIP_RETURN_CODE in CMakeLists.txt


def expand(root, header, files):
    """The header's text with its includes in place; `#line n k` says which of `files` a line comes from."""
    files.append(header)
    index = len(files) - 1
    lines = [f"#line 1 {index}"]
    for number, line in enumerate((root / header).read_text().splitlines(), 1):
        match = re.match(r'\s*#\s*include\s+"([^"]+)"', line)
        if match:
            lines += [expand(root, match.group(1), files), f"#line {number + 1} {index}"]
        elif re.match(r"\s*#\s*include\s+<", line):
            lines.append("")  # C++ alone sees the libraries' headers: they stand behind __cplusplus
        else:
            lines.append(line)
    return "\n".join(lines)


def compile_errors(text):
    """What the compiler has against a shader that holds the text; empty where nothing."""
    shader = "#version 450\nlayout(local_size_x = 1) in;\n" + text + "\nvoid main() {}\n"
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "shared.comp"
        path.write_text(shader)
        result = subprocess.run(["glslangValidator", "-S", "comp", path], capture_output=True, text=True)
    return "" if result.returncode == 0 else result.stdout + result.stderr


def main():
    root = pathlib.Path(sys.argv[1])
    if shutil.which("glslangValidator") is None:
        print("skipped: no glslangValidator (Debian package glslang-tools)")
        return SKIPPED
    headers = sorted(p.relative_to(root).as_posix() for p in (root / "formats/shared").glob("*.glsl.h"))
    failures = 0 if headers else 1
    for header in headers:
        files = []
        errors = compile_errors(expand(root, header, files))
        failures += 1 if errors else 0
        print(f"{header}: {'refused' if errors else 'ok'}")
        if errors:
            print("\n".join(f"  file {k}: {name}" for k, name in enumerate(files)), errors, sep="\n")

    # The compiler must refuse what is C++ alone, also in a function that nothing calls.
    portable = expand(root, "formats/shared/portable.glsl.h", [])
    if not compile_errors(portable + "\nGPU_FN float f(const float& x) { return static_cast<float>(x); }"):
        print("a reference and a cast of C++ were not refused")
        failures += 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
