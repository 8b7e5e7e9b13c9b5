#!/usr/bin/env bash
# Installs, builds and tests. Without options: format, layers, release tests but the slow ones, then unit and fuzz
# tests under ASan and UBSan; under 30 minutes on 2 cores. --all: also the slow tests, 100,000 mutations of every
# reader's input, and clang-tidy on every file.
set -euo pipefail
cd "$(dirname "$0")/.."
all=false
if [ "${1:-}" = --all ]; then
    all=true
elif [ $# -gt 0 ]; then
    echo "usage: scripts/test.sh [--all]" >&2
    exit 2
fi

step() { printf '\n== %s (%d s)\n' "$1" "$SECONDS"; }
export CCACHE_NOHASHDIR=1

step "install"
scripts/setup.sh

step "format"
scripts/format.sh --check

step "build release"
cmake --preset release >/dev/null
cmake --build --preset release

step "build with sanitizers"
cmake --preset asan >/dev/null
cmake --build --preset asan

step "test release"
if $all; then
    ctest --test-dir build/release --output-on-failure --schedule-random -j 2
else
    ctest --preset release -j 2
fi

if $all; then
    step "test with sanitizers, clang-tidy beside them"
    # The longest fuzz tests share a folder and so a core; the other core checks the sources.
    scripts/tidy.py >build/tidy.log 2>&1 &
    tidy=$!
    trap 'kill "$tidy" 2>/dev/null || true' EXIT
    NEARFIELD_FUZZ_COUNT=100000 ctest --preset asan -j 2
    step "clang-tidy, the rest"
    wait $tidy || { cat build/tidy.log; exit 1; }
else
    step "test with sanitizers"
    ctest --preset asan -j 2
fi
step "done"
