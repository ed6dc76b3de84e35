#!/usr/bin/env bash
# What tools/test.sh has no time for: every test in the build with sanitizers, parsers on random input
# for a minute each, races under the thread sanitizer, and all rows of `supple stress`. Some hours.
#
#   bash tools/nightly.sh
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
cd "$SUPPLE_ROOT"

failed=0
bash tools/test.sh --all-tests "$@" || failed=1
bash tools/fuzz.sh --seconds 60 || failed=1
bash tools/races.sh || failed=1
say "supple stress --long"
build/release/bin/supple stress --long || failed=1
exit "$failed"
