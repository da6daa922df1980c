#!/usr/bin/env bash
# The main job on the logs that come with deltadyn: identify a 4-axis Delta, then check the model on a log it has not seen.
# Builds and installs the tools below build/demo of the source tree and uses them as installed. Works from any folder.
set -euo pipefail

root="$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)"
build="$root/build/demo"
prefix="$build/prefix"
out="$build/results"
jobs="${DELTADYN_JOBS:-$(nproc)}"

"$root/tools/install-packages.sh"

echo "building the tools ..."
mkdir -p "$build"
if ! { cmake -G Ninja -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DDELTADYN_BUILD_TESTS=OFF -DDELTADYN_BUILD_TOOLS=ON &&
  cmake --build "$build" --parallel "$jobs" &&
  cmake --install "$build" --prefix "$prefix"; } >"$build/build.log" 2>&1; then
  tail -n 40 "$build/build.log" >&2
  echo "demo.sh: the build failed; all of its output is in $build/build.log" >&2
  exit 1
fi

export PATH="$prefix/bin:$PATH"
data="$prefix/share/deltadyn"
robot="$data/robots/mujoco_delta4.urdf"
mkdir -p "$out"

run() {
  printf '\n$'
  printf ' %s' "${@//$root\//}"
  printf '\n'
  "$@"
}

run delta-model info "$robot"
run delta-model prior "$robot" -o "$out/prior.csv"
run delta-identify "$robot" "$data/logs/mujoco_delta4/identification_fast.csv" "$data/logs/mujoco_delta4/identification_slow.csv" \
  --prior "$out/prior.csv" -o "$out/params.csv" --base "$out/base.csv" \
  --summary "$out/identify_summary.csv" --report "$out/identification.html"
run delta-validate "$robot" --params "$out/params.csv" "$data/logs/mujoco_delta4/verification.csv" -o "$out/residuals.csv" \
  --summary "$out/validate_summary.csv" --report "$out/validation.html"

echo
echo "parameters:            $out/params.csv"
echo "identification report: $out/identification.html"
echo "validation report:     $out/validation.html"
