# SPDX-License-Identifier: Apache-2.0
"""Proves that no source, script or page names a folder of somebody's machine: source_paths_test.py SOURCE_FOLDER."""
import pathlib
import re
import sys

SUFFIXES = {".h", ".cpp", ".py", ".sh", ".cmake", ".txt", ".json", ".md", ".gltf", ".html"}
PLACE = re.compile(r"(?<![\w.}])/(?:work|tmp|home|root|Users)/\w")

root = pathlib.Path(sys.argv[1])
folders = [path for path in root.iterdir()
           if path.is_dir() and not path.name.startswith(".") and path.name not in ("build", "out")]
files = [path for path in root.iterdir() if path.is_file()] + [path for f in folders for path in f.rglob("*")]
breaches = [f"{path.relative_to(root)}:{number}: {line.strip()}"
            for path in files if path.is_file() and path.suffix in SUFFIXES
            for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1) if PLACE.search(line)]
assert len(files) > 100, f"only {len(files)} files in {root}"
sys.exit("\n".join(breaches) if breaches else 0)
