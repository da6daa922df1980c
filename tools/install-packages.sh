#!/usr/bin/env bash
# Installs what deltadyn is built with on Debian 12 and Ubuntu 24.04. Does nothing if all of it is there.
#   tools/install-packages.sh              what the library, the tools and the tests need
#   tools/install-packages.sh --developer  also clang, clang-tidy and clang-format (presets clang and tidy)
# DELTADYN_SKIP_PACKAGES=1 leaves the system alone, for machines that get the libraries another way.
set -euo pipefail

packages=(
  build-essential g++ cmake ninja-build ccache
  libeigen3-dev libceres-dev libnlopt-dev libnlopt-cxx-dev liburdfdom-dev libconsole-bridge-dev libtinyxml2-dev
  libgtest-dev libgmock-dev libbenchmark-dev libcli11-dev libfmt-dev libomp-dev
  libsqlite3-dev libtomlplusplus-dev
  gnuplot-nox python3-venv
)

case "${1:-}" in
  "") ;;
  --developer) packages+=(clang-14 clang-tidy-14 clang-format-14) ;;
  -h | --help) sed -n '2,5s/^# //p' "${BASH_SOURCE[0]}"; exit 0 ;;
  *) echo "install-packages.sh: unknown argument '$1' (known: --developer, --help)" >&2; exit 2 ;;
esac

if [[ "${DELTADYN_SKIP_PACKAGES:-0}" == 1 ]]; then exit 0; fi

fail() {
  echo "install-packages.sh: $1" >&2
  echo "  mend: $2" >&2
  exit 1
}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  fail "this machine has no apt, so the packages cannot be installed" \
    "install the equivalents of: ${packages[*]}; then set DELTADYN_SKIP_PACKAGES=1"
fi

installed() {
  [[ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" == installed ]]
}

missing=()
for package in "${packages[@]}"; do
  # gnuplot-x11 and gnuplot-qt bring the same program and exclude gnuplot-nox.
  if [[ "$package" == gnuplot-nox ]] && command -v gnuplot >/dev/null; then continue; fi
  installed "$package" || missing+=("$package")
done
if [[ ${#missing[@]} -eq 0 ]]; then exit 0; fi

as_root=()
if [[ "$(id -u)" -ne 0 ]]; then
  command -v sudo >/dev/null ||
    fail "these packages are missing and neither root nor sudo is at hand: ${missing[*]}" \
      "as root: apt-get install ${missing[*]}"
  as_root=(sudo)
fi

echo "installing: ${missing[*]}"
log="$(mktemp)"
trap 'rm -f "$log"' EXIT
run_apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 "$@" >"$log" 2>&1
}
# A stale mirror list alone is no reason to stop: what it knows may be enough.
run_apt update || echo "install-packages.sh: the package lists could not be refreshed, going on with the old ones" >&2
if ! run_apt install --yes --no-install-recommends "${missing[@]}"; then
  tail -n 20 "$log" >&2
  fail "apt-get could not install: ${missing[*]}" "see apt's words above; on another release than Debian 12 or Ubuntu 24.04 names may differ"
fi
