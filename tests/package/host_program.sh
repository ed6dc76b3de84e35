#!/usr/bin/env bash
# Builds and runs the examples outside of the source tree, against the library as installed by
# `cmake --install` or as unpacked from the packages of `cpack`, and a drag in Python.
#
#   host_program.sh install|deb BUILD_FOLDER SOURCE_FOLDER
set -euo pipefail
way="$1" build="$2" source="$3"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

build_type=Release examples=all
if [ "$way" = install ]; then
  prefix="$work/prefix"
  cmake --install "$build" --prefix "$prefix" >"$work/install.log"
else
  command -v dpkg-shlibdeps >/dev/null || { echo "skipped: dpkg-dev is not installed"; exit 77; }
  (cd "$work" && cpack --config "$build/CPackConfig.cmake" -B "$work" -D CPACK_DEBIAN_COMPRESSION_TYPE=gzip >"$work/cpack.log" 2>&1) ||
    { cat "$work/cpack.log"; exit 1; }
  for package in "$work"/*.deb; do dpkg -x "$package" "$work/root"; done
  if command -v lintian >/dev/null; then lintian --fail-on error --allow-root "$work"/*.deb; fi
  for package in "$work"/*.deb; do dpkg -I "$package" | grep -E '^ (Package|Version|Depends)'; done
  prefix="$work/root/usr"
  build_type= examples="info drag_and_export own_offsets"  # some, once more, without optimiser
fi

# Nothing of this build leaks: neither its instruction set nor its warnings nor its folders.
if grep -rE -- "-march|-Wall|-Werror|cmake_pch|$source|$build" $prefix/lib/cmake/supple \
    $prefix/lib/*/cmake/supple 2>/dev/null; then
  echo "the installed CMake package names what belongs to the build"
  exit 1
fi

# The host program has its own operator new.
if nm -D --defined-only "$(find "$prefix" -name 'libsupple.so*' -type f -not -path '*hwcaps*' | head -n 1)" | grep -w _Znwm; then
  echo "the library replaces operator new of its host"
  exit 1
fi

# Each installed header compiles alone, and all of them are those of the list.
headers=$(cd "$prefix/include" && find supple -name '*.h' ! -name density_grid_vdb.h)
test "$(echo "$headers" | wc -l)" = "$(grep -c '^[^#].*\.h$' "$source/cmake/PublicHeaders.txt" | awk '{print $1 - 1}')"
if [ "$way" = install ]; then
  echo "$headers" | xargs -P "$(nproc)" -I{} sh -c \
    'echo "#include <{}>" | g++ -std=c++17 -fsyntax-only -Wall -Wextra -Werror -I "$0" -x c++ -' "$prefix/include"
fi

cp -r "$source/examples" "$work/host"
cmake -S "$work/host" -B "$work/host/build" -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_BUILD_TYPE="$build_type" -DCMAKE_CXX_FLAGS="-Wall -Wextra -Werror" >"$work/configure.log"
cmake --build "$work/host/build" -j "$(nproc)" --target $examples >"$work/build.log" 2>&1 ||
  { cat "$work/build.log"; exit 1; }

# A ball of tissue, made by the installed program's own formats.
cd "$work"
export LD_LIBRARY_PATH="$(dirname "$(find "$prefix" -name 'libsupple.so*' -not -path '*hwcaps*' | head -n 1)")"
python3 - <<'EOF'
n = 24
values = bytearray()
for k in range(n):
    for j in range(n):
        for i in range(n):
            d = ((i - 11.5) ** 2 + (j - 11.5) ** 2 + (k - 11.5) ** 2) ** 0.5
            values.append(max(0, min(255, int(260 - 25 * max(0, d - 1)))))
open("ball.raw", "wb").write(values)
open("ball.nhdr", "w").write(
    "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 24 24 24\nencoding: raw\n"
    "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1.5)\n"
    "space origin: (0,0,0)\ndata file: ball.raw\n")
EOF
bin="$work/host/build"
supple="$prefix/bin/supple"
set -x
if command -v pkg-config >/dev/null; then                     # wherever the tree lies
  export PKG_CONFIG_PATH="$(dirname "$(find "$prefix" -name supple.pc)")"
  g++ -std=c++17 "$work/host/info.cpp" $(pkg-config --cflags --libs supple) -o by_pkg_config
  ./by_pkg_config ball.nhdr
fi
"$bin/info" ball.nhdr
"$bin/drag_and_export" ball.nhdr 12 12 16 0 2 0 warp.nrrd
"$bin/drag_and_export" ball.nhdr 12 12 16 0 2 0 warp.h5       # through the plugin of HDF5
"$bin/own_offsets" ball.nhdr sheared.png
if [ "$way" = install ]; then
  "$bin/live_drag" ball.nhdr 12 12 16
  "$bin/incremental_inverse" ball.nhdr 12 12 16
  "$bin/mesh_body"
  "$bin/own_model" ball.nhdr 12 12 16
  printf '[volume]\npath = "ball.nhdr"\n[[step]]\ngrab = [12, 12, 16]\nby = [0.0, 2.0, 0.0]\n[output]\nstate = "s.vdb"\n' >ball.toml
  mkdir scene && "$bin/run_scene" ball.toml scene && test -s scene/s.vdb
  "$bin/live_session" ball.toml
  mkdir film && "$bin/live_film" ball.toml film && test -s film/0.png
  cat >film.toml <<'EOF'
[volume]
path = "ball.nhdr"
[[step]]
grab = [12, 12, 16]
path = [{ time = 0.0, by = [0.0, 0.0, 0.0] }, { time = 2.0, by = [0.0, 2.0, 0.0] }]
[[view]]
image = "f_%d.png"
width = 64
height = 64
[film]
times = "frames"
EOF
  "$bin/run_scene" film.toml film && test -s film/f_2.png
  mkdir in out && cp ball.* in && "$bin/batch" in out && test -s out/ball.png
fi
"$prefix/bin/supple-examples" phantom t-shape t.png        # README's first try
"$supple" deform t.png --grab 40,25,0 --by 5,0,0 --fix 0,0,0:0,49,0 -o t.vdb
test -s "$prefix/share/doc/supple/docs/scenes/ct_head_material.toml"
"$supple" deform ball.nhdr --grab 12,12,16 --by 0,2,0 -o ball.vdb
"$bin/drag_and_export" ball.vdb 12 12 16 0 1 0 further.nrrd   # continues the state
"$supple" info warp.h5
for package in "$work"/python3-supple_*.deb; do                # where the package of Python is built
  [ -f "$package" ] || continue
  dpkg -f "$package" Depends | grep -q "supple (= .*python3-numpy"
  if dpkg -c "$package" | grep -vE '/$| \./usr/(lib/python3/dist-packages/supple/|share/doc/python3-supple -> supple$)'; then
    echo "python3-supple holds what belongs elsewhere"
    exit 1
  fi
  hash='import supple; s = supple.Session("ball.nhdr"); s.drag([12, 12, 16], [0, 2, 0]); print(s.hash)'
  env -u LD_LIBRARY_PATH PYTHONPATH="$prefix/lib/python3/dist-packages" /usr/bin/python3 -W ignore -c "$hash" >dragged
  PYTHONPATH="$build/python" /usr/bin/python3 -W ignore -c "$hash" | diff - dragged
done
zgrep -q springs "$prefix/share/man/man1/supple.1.gz"
grep -q springs-time "$prefix/share/bash-completion/completions/supple"
grep -q springs-time "$prefix"/share/zsh/*/_supple
grep -q springs-time "$prefix/share/fish/vendor_completions.d/supple.fish"
"$supple" convert ball.nhdr ball.h5 && "$bin/info" ball.h5
for dicom in /usr/lib/python3/dist-packages/pydicom/data/test_files/CT_small.dcm; do
  if [ -f "$dicom" ]; then "$bin/info" "$dicom"; fi              # through the plugin of DICOM
done
SUPPLE_PLUGIN_PATH="$work/nowhere" "$bin/info" ball.h5        # and then where it was found before
