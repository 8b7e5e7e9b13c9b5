#!/usr/bin/env bash
# From a fresh clone to the demo's pictures and report: installs, builds into build/release, runs. Options go to the
# demo: scripts/demo.sh --quick
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh
cmake --preset release >/dev/null
cmake --build --preset release --target nearfield
build/release/nearfield demo -o out "$@"
