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

# MuJoCo and Pinocchio, for the tests against them, in an environment of their own below build/. Without them those tests skip.
if [ -z "${DELTADYN_PYTHON:-}" ]; then
  environment="$root/build/python"
  wanted="$root/tests/peers/requirements.txt"
  if ! cmp -s "$wanted" "$environment/installed.txt"; then
    echo "installing MuJoCo and Pinocchio for the tests against them ..."
    if python3 -m venv --clear "$environment" &&
      timeout 600 "$environment/bin/pip" install --quiet --disable-pip-version-check --only-binary :all: --retries 2 --timeout 30 \
        -r "$wanted"; then
      cp "$wanted" "$environment/installed.txt"
    else
      echo "test.sh: the packages of tests/peers/requirements.txt could not be installed; the tests against MuJoCo and Pinocchio will skip" >&2
    fi
  fi
  if [ -x "$environment/bin/python3" ]; then export DELTADYN_PYTHON="$environment/bin/python3"; fi
fi

cd "$root"
cmake --preset release -DDELTADYN_WARNINGS_AS_ERRORS=ON
cmake --build --preset release --parallel "$jobs"
cmake --build --preset release --parallel "$jobs" --target all_verify_interface_header_sets
exec ctest --preset release --parallel 2 --output-on-failure "$@"
