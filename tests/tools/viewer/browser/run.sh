#!/usr/bin/env bash
# The page of `supple view` tested without and in a browser. Without Node of 18 or later nothing is
# tested, without Chromium only what needs none; exit code 77 says that something was left out.
#   run.sh [TEST…]: those that need Chromium, by default viewer
set -euo pipefail
cd "$(dirname "$0")"

node -e 'process.exit(process.versions.node.split(".")[0] >= 18 ? 0 : 1)' 2>/dev/null ||
  { echo "skipped: no node 18 or later (apt-get install nodejs)"; exit 77; }

node --test page_camera.test.mjs page_session.test.mjs page_operation.test.mjs

chromium="${SUPPLE_CHROMIUM:-$(command -v chromium chromium-browser google-chrome | head -n 1 || true)}"
[ -n "$chromium" ] || { echo "skipped: no chromium (apt-get install chromium)"; exit 77; }
for name in "${@:-viewer}"; do
  SUPPLE_CHROMIUM="$chromium" SUPPLE_BROWSER_REQUIRED=1 node --test "$name.test.mjs"
done
