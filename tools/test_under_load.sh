#!/usr/bin/env bash
# Runs `make test` RUNS times beside a busy loop on every core, then (CLONE=yes) once in a fresh clone of HEAD, and
# prints the result and the time of each run. A test that depends on timing fails here. SUITE selects suites as for
# `make test`.
set -eu
cd "$(dirname "$0")/.."
runs=${RUNS:-20} logs=${BUILD:-build}/test-under-load n_failed=0
rm -rf "$logs"
mkdir -p "$logs"

# The loops end with this script, even if it is killed.
busy() {
    while kill -0 $$ 2>/dev/null; do
        for ((i = 0; i < 100000; i++)); do :; done
    done
}
loops=()
for _ in $(seq "$(nproc)"); do
    busy &
    loops+=($!)
done
job=
trap '[ -z "$job" ] || kill -- "-$job" 2>/dev/null; kill "${loops[@]}" 2>/dev/null || true' EXIT
trap 'exit 130' INT TERM HUP

try() {
    local name=$1 start=$SECONDS result=passed
    shift
    set -m # a process group of its own, which the trap can end
    "$@" >"$logs/$name.log" 2>&1 </dev/null &
    job=$!
    set +m
    wait "$job" || { result="FAILED, see $logs/$name.log"; n_failed=$((n_failed + 1)); }
    job=
    echo "$name: $((SECONDS - start)) s, $(tail -n 1 "$logs/$name.log"): $result"
}
for run in $(seq "$runs"); do
    try "run-$run" make test
done
if [ "${CLONE:-no}" = yes ]; then
    git clone -q . "$logs/clone"
    try clone env -u BUILD make -C "$logs/clone" test
fi
echo "$n_failed of $((runs + $([ "${CLONE:-no}" = yes ] && echo 1 || echo 0))) failed"
[ "$n_failed" = 0 ]
