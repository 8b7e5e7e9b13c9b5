#!/usr/bin/env python3
"""clang-tidy on every source file, or on those named; warnings are errors (.clang-tidy).

What passed is not checked again until the text that is compiled changes, headers and comments included: a file takes
ten seconds to check and half a second to preprocess. The hashes of what passed are in build/tidy/.
"""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build/dev"
PASSED = ROOT / "build/tidy"
TIDY = "clang-tidy-14"


def compile_commands():
    entries = json.loads((BUILD / "compile_commands.json").read_text())
    return {os.path.realpath(entry["file"]): entry for entry in entries}


def rules():
    version = subprocess.run([TIDY, "--version"], capture_output=True, check=True).stdout
    return version + (ROOT / ".clang-tidy").read_bytes()


def text_compiled(entry):
    """Preprocessed with comments (NOLINT is one), or None where that fails."""
    words = shlex.split(entry["command"])
    if words[0].endswith("ccache"):
        words = words[1:]
    words[words.index("-o") + 1] = "-"
    run = subprocess.run(words + ["-E", "-C"], cwd=entry["directory"], capture_output=True)
    return run.stdout if run.returncode == 0 else None


def check(file, entry, rules_text):
    text = text_compiled(entry) if entry else None
    mark = None
    if text is not None:
        mark = PASSED / hashlib.sha256(rules_text + entry["command"].encode() + text).hexdigest()
        if mark.exists():
            return 0, b""
    run = subprocess.run([TIDY, "-p", str(BUILD), "--quiet", str(file)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if run.returncode == 0 and mark:
        mark.touch()
    return run.returncode, run.stdout


def main():
    subprocess.run(["cmake", "--preset", "dev"], cwd=ROOT, stdout=subprocess.DEVNULL, check=True)
    PASSED.mkdir(parents=True, exist_ok=True)
    listed = subprocess.run(["git", "ls-files", "*.cpp"], cwd=ROOT, capture_output=True, text=True, check=True)
    files = [pathlib.Path(name).resolve() for name in sys.argv[1:]] or [ROOT / name for name in listed.stdout.split()]
    commands, rules_text = compile_commands(), rules()
    failed = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for file, (code, output) in zip(files, pool.map(lambda f: check(f, commands.get(str(f)), rules_text), files)):
            if code != 0:
                failed += 1
                print(f"{file.relative_to(ROOT)}:\n{output.decode()}", flush=True)
    print(f"clang-tidy: {failed} of {len(files)} files with findings")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
