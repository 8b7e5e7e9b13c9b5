#!/usr/bin/env bash
# clang-tidy on every source file, or on those named; warnings are errors (.clang-tidy).
set -euo pipefail
cd "$(dirname "$0")/.."

cmake --preset dev >/dev/null
if [ $# -gt 0 ]; then
    files=("$@")
else
    mapfile -t files < <(git ls-files '*.cpp')
fi
printf '%s\n' "${files[@]}" | xargs -P 2 -n 1 clang-tidy-14 -p build/dev --quiet
