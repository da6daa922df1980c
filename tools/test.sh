#!/usr/bin/env bash
# Builds everything with warnings as errors, checks that every header compiles alone, runs every test.
# Works from any folder; writes only below build/ of the source tree. The last line is ctest's summary.
#   tools/test.sh [ctest arguments]     e.g. tools/test.sh -R house
set -euo pipefail

root="$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)"
jobs="${DELTADYN_JOBS:-$(nproc)}"

"$root/tools/install-packages.sh"

# Tests against measured and published data, which cannot travel with the product, run where such a folder lies beside the tree.
if [ -z "${DELTADYN_SHARED_DATA:-}" ] && [ -d "$root/../shared/data" ]; then
  export DELTADYN_SHARED_DATA="$root/../shared/data"
fi

cd "$root"
cmake --preset release -DDELTADYN_WARNINGS_AS_ERRORS=ON
cmake --build --preset release --parallel "$jobs"
cmake --build --preset release --parallel "$jobs" --target all_verify_interface_header_sets
exec ctest --preset release --parallel 2 --output-on-failure "$@"
