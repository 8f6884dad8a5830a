#!/usr/bin/env bash
# Configures and builds the program: build/release/meshgraft.
set -euo pipefail
cd "$(dirname "$0")/.."
# A directory in which the tests were built keeps them, so that they need not be compiled again.
tests=()
[ -f build/release/build.ninja ] || tests=(-DMESHGRAFT_BUILD_TESTS=OFF)
cmake --preset release "${tests[@]}" --log-level=NOTICE
cmake --build --preset release --target meshgraft_cli
