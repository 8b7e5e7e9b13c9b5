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

# Files that tests write are synced one by one, and the disk makes them wait; memory does not, where there is room.
# Afterwards they lie where they always do.
outputs=$(mktemp -d /dev/shm/nearfield_tests.XXXXXX 2>/dev/null || true)
presets=(release asan)
least_free_kib=$((3 * 1024 * 1024))
keep_outputs() {
    [ -n "$outputs" ] || return 0
    for preset in "${presets[@]}"; do
        rm -f "build/$preset/test_output"
        mv "$outputs/$preset" "build/$preset/test_output"
    done
    rmdir "$outputs"
}
if [ -n "$outputs" ] && [ "$(df --output=avail "$outputs" | tail -1)" -lt "$least_free_kib" ]; then
    rmdir "$outputs"
    outputs=
fi
if [ -n "$outputs" ]; then
    for preset in "${presets[@]}"; do
        mkdir -p "build/$preset" "$outputs/$preset"
        rm -rf "build/$preset/test_output"
        ln -s "$outputs/$preset" "build/$preset/test_output"
    done
    trap keep_outputs EXIT
fi

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
    trap 'kill "$tidy" 2>/dev/null || true; keep_outputs' EXIT
    NEARFIELD_FUZZ_COUNT=100000 ctest --preset asan -j 2
    step "clang-tidy, the rest"
    wait $tidy || { cat build/tidy.log; exit 1; }
else
    step "test with sanitizers"
    ctest --preset asan -j 2
fi
step "done"
