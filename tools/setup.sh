#!/usr/bin/env bash
# Installs what is missing on Debian 12 (apt, non-interactive), configures and builds
# build/release/bin/supple. Re-runnable: a second run only checks. Sourced by demo.sh and test.sh.
#
#   bash tools/setup.sh [--with-judges|--with-peers]
#     judges: other people's programs and volumes that the tests compare with
#     peers: VTK and ITK, which `supple bench` compares with
set -euo pipefail

SUPPLE_ROOT="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"

SUPPLE_PACKAGES=(
  ca-certificates git build-essential cmake ninja-build ccache python3-minimal
  libopenvdb-dev liblog4cplus-dev libnanovdb-dev libboost-dev libtbb-dev libembree-dev libhwy-dev
  libopencv-dev libtiff-dev libpugixml-dev libpng-dev libturbojpeg0-dev libopenexr-dev ffmpeg libnifti2-dev zlib1g-dev
  libbz2-dev libeigen3-dev libspectra-dev
  libhdf5-dev libdcmtk-dev libopenjp2-7-dev libssl-dev
  libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libgtest-dev
  python3-dev pybind11-dev python3-numpy)
SUPPLE_JUDGES=(
  pkg-config lintian zsh fish elastix plastimatch teem-apps python3-openvdb python3-nibabel python3-scipy mypy parallel snakemake python3-tifffile
  python3-h5py python3-dask python3-distributed python3-zarr python3-pydicom dicom3tools python3 python3-vtk9 libtiff-tools dcmtk libgdcm-tools
  libinsighttoolkit5-dev mricron-data openexr openimageio-tools python3-meshio
  calculix-ccx python3-dolfinx chromium nodejs xvfb
  python3-pip patchelf python3-matplotlib python3-sphinx)
SUPPLE_NPM_JUDGES=(@itk-wasm/transform-io@0.1.1 @itk-wasm/image-io@1.6.1)  # into build/npm
# Of preset asan: the compiler, its sanitizers, a linker, and what names their stacks.
SUPPLE_CLANG=(clang-14 libclang-rt-14-dev lld-14 llvm-14)
SUPPLE_PEERS=(python3-vtk9 xvfb libinsighttoolkit5-dev)
SUPPLE_PROGRAMS="supple supple-examples"

say() { printf '== %s\n' "$*"; }

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

can_install() {
  [ "$(id -u)" = 0 ] || command -v sudo >/dev/null ||
    { say "installing packages needs root or sudo"; return 1; }
}

missing_packages() {
  local package
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q '^install ok installed$' ||
      printf '%s\n' "$package"
  done
}

# Installs packages; returns 1 when they cannot be had, e.g. without a network.
install_packages() {
  local missing
  mapfile -t missing < <(missing_packages "$@")
  [ "${#missing[@]}" -gt 0 ] || return 0
  can_install || return 1
  say "installing ${#missing[@]} packages: ${missing[*]}"
  local apt=(env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o Dpkg::Use-Pty=0)
  as_root "${apt[@]}" update >/dev/null || say "the package list could not be refreshed"
  # One line for every 50 packages, and all errors.
  as_root "${apt[@]}" install --no-install-recommends "${missing[@]}" 2>&1 |
    awk '/^E:/ { print } /^Setting up/ && n++ % 50 == 0 { print $1, $2, $3; fflush() }' || true
  mapfile -t missing < <(missing_packages "$@")
  [ "${#missing[@]}" -eq 0 ] || { say "not installed: ${missing[*]}"; return 1; }
}

# Judges of Debian; returns 1 where some cannot be had. Those of npm come where its registry can be reached.
install_judges() {
  local failed=0
  install_packages "${SUPPLE_JUDGES[@]}" || failed=1
  if [ ! -d "$SUPPLE_ROOT/build/npm/node_modules/@itk-wasm/image-io" ]; then
    { command -v npm >/dev/null || install_packages npm; } &&
      timeout 300 npm install --prefix "$SUPPLE_ROOT/build/npm" --ignore-scripts --no-audit --no-fund --loglevel=error \
        --fetch-retries=1 "${SUPPLE_NPM_JUDGES[@]}" || say "left out: ${SUPPLE_NPM_JUDGES[*]}"
  fi
  return $failed
}

# build_preset PRESET TARGETS [cmake options]: each folder at once, which takes the least processor time for
# all of them; less together (SUPPLE_UNITY) is sooner built after an edit.
build_preset() {
  local preset="$1" targets
  read -ra targets <<<"$2"
  shift 2
  say "configuring build/$preset"
  (cd "$SUPPLE_ROOT" && cmake --preset "$preset" -DSUPPLE_UNITY=40 "$@" >"build/$preset-configure.log" 2>&1) ||
    { tail -n 20 "$SUPPLE_ROOT/build/$preset-configure.log"; return 1; }
  say "building build/$preset"
  (cd "$SUPPLE_ROOT" && cmake --build "build/$preset" -j "$(nproc)" --target "${targets[@]}")
}

supple_setup() {
  mkdir -p "$SUPPLE_ROOT/build"
  install_packages "${SUPPLE_PACKAGES[@]}"
}

if [ "${BASH_SOURCE[0]}" = "$0" ]; then
  supple_setup
  if [ "${1:-}" = "--with-judges" ]; then
    install_judges || say "tests that need them will be skipped"
  fi
  cmake_options=(-DSUPPLE_BENCH=ON)
  if [ "${1:-}" = "--with-peers" ]; then
    if install_packages "${SUPPLE_PEERS[@]}"; then
      SUPPLE_PROGRAMS+=" supple-lab supple-itk-inverse supple-itk-warp"
      cmake_options+=(-DSUPPLE_BENCH_ITK=ON)
    else
      say "benchmarks will leave out the rows that need them"
    fi
  fi
  build_preset release "$SUPPLE_PROGRAMS" "${cmake_options[@]}"
  say "built $SUPPLE_ROOT/build/release/bin/supple"
fi
