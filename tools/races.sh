#!/usr/bin/env bash
# Looks for data races with the thread sanitizer, in what a live session does: the viewer's session and
# the attacks on it, hands that lead an operation, and journals. Builds oneTBB from Debian's sources and
# the program, preset `tsan`; the packaged oneTBB is not built for the sanitizer, and everything beside it
# would look like a race.
# Reports are kept under build/races; any is an error.
#
#   bash tools/races.sh
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
cd "$SUPPLE_ROOT"

# The sources of the installed version, from Debian's archive and nothing else of the machine's lists.
fetch_tbb() {
  local version
  version="$(dpkg-query -W -f='${source:Version}' libtbb12)"
  mkdir -p lists
  printf 'deb-src http://deb.debian.org/debian %s main\n' bookworm bookworm-updates >sources.list
  printf 'deb-src http://deb.debian.org/debian-security bookworm-security main\n' >>sources.list
  local apt=(apt-get -q -o Dir::Etc::SourceList="$PWD/sources.list" -o Dir::Etc::SourceParts=/dev/null
    -o Dir::State::Lists="$PWD/lists" -o APT::Sandbox::User=root)
  "${apt[@]}" update >/dev/null
  "${apt[@]}" source --download-only "onetbb=$version" >/dev/null
  tar xf onetbb_*.orig.tar.xz
}

build_tbb() {
  mkdir -p build/races/tbb
  cd build/races/tbb
  fetch_tbb
  cmake -S oneTBB-* -B built -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DTBB_SANITIZE=thread \
    -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBBMALLOC_BUILD=OFF >configure.log
  cmake --build built --target tbb >build.log
  cp built/*/libtbb.so.12 .
}

supple_setup
if [ ! -e build/races/tbb/libtbb.so.12 ]; then
  say "building oneTBB with the thread sanitizer"
  (build_tbb)
fi
build_preset tsan supple
build_preset release test_tools

rm -rf build/races/reports
mkdir -p build/races/reports
program="$PWD/build/races/supple"
cat >"$program" <<END
#!/bin/sh
export LD_LIBRARY_PATH="$PWD/build/races/tbb"
export TSAN_OPTIONS="suppressions=$PWD/tests/races.supp log_path=$PWD/build/races/reports/report exitcode=0"
exec "$PWD/build/tsan/bin/supple" "\$@"
END
chmod +x "$program"

export SUPPLE_BINARY="$program" SUPPLE_SOURCE_DIR="$PWD" PYTHONDONTWRITEBYTECODE=1
failed=0
for script in session attacks hands; do
  say "tests/tools/viewer/$script.py"
  /usr/bin/python3 "tests/tools/viewer/$script.py" || failed=1
done
say "journals"
build/release/bin/test_tools --gtest_brief=1 --gtest_filter='UnitReplay.*' || failed=1

races="$(cat build/races/reports/* 2>/dev/null | grep -c '^SUMMARY' || true)"
say "$races reports of races"
cat build/races/reports/* 2>/dev/null | grep '^SUMMARY' | sort | uniq -c || true
[ "$races" = 0 ] && [ "$failed" = 0 ]
