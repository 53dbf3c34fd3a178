#!/usr/bin/env bash
# Opens pages of `hifdm report` in headless Chromium, `make browser`; run.sh NAME... for some of those in pages.mjs,
# run.sh --node SCRIPT... for another script with the same settings.
# Needs node, npm and chromium (tools/setup.sh --ci); playwright-core is installed under build/browser.
set -eu
cd "$(dirname "$0")/../.."
export HIFDM=${HIFDM:-$PWD/build/hifdm} CHROMIUM=${CHROMIUM:-$(command -v chromium)}
export WORK=$(realpath -m "${BUILD:-build}")/browser OMP_WAIT_POLICY=passive

[ -x "$HIFDM" ] || { echo "no $HIFDM: run \`make\` first" >&2; exit 1; }
mkdir -p "$WORK"
if ! cmp -s tests/browser/package-lock.json "$WORK/package-lock.json" || [ ! -d "$WORK/node_modules" ]; then
    cp tests/browser/package.json tests/browser/package-lock.json "$WORK/"
    (cd "$WORK" && PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD=1 npm ci --no-audit --no-fund --loglevel=error)
fi
if [ "${1:-}" = --node ]; then
    shift
    exec node "$@"
fi
exec node tests/browser/test.mjs "$@"
