# SPDX-License-Identifier: Apache-2.0
"""Proves that `cmake --install` puts a program that runs into any prefix: install_test.py CMAKE BUILD_FOLDER."""
import pathlib
import re
import subprocess
import sys
import tempfile

cmake, build = sys.argv[1:]
with tempfile.TemporaryDirectory(dir=".") as folder:
    prefix = pathlib.Path(folder).resolve()
    subprocess.run([cmake, "--install", build, "--prefix", prefix], check=True, stdout=subprocess.DEVNULL)
    files = [path for path in prefix.rglob("*") if path.is_file()]
    programs = [path for path in files if path.name == "nearfield"]
    assert len(programs) == 1, files
    version = subprocess.run([programs[0], "--version"], check=True, capture_output=True, text=True).stdout
    assert re.fullmatch(r"nearfield \d+\.\d+\.\d+\n", version), version
