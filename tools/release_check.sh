#!/usr/bin/env bash
# release_check.sh [STEP...]: runs checks before a release that take too long for .ci/run; without STEP, all of them.
#
# A failing step does not stop the others. Each step has a time limit; its output is in build/release/COMMIT/STEP.log.
# results/release/VERSION.log has one line per step: outcome, time, last words, and what was skipped. It is committed
# for the release that it was run on. Steps may be run one by one, on several days and machines. The log keeps the
# outcomes of the same commit and lists the steps that were not run. Exit status 1 if a step of this call failed.
set -eu
cd "$(dirname "$0")/.."

# name, limit, command
steps() {
    cat <<'STEPS'
aarch64         120m tools/aarch64.sh
same-bits       60m  tools/same_bits.sh
fuzz            20m  make fuzz FUZZ_SECONDS=60
asan            60m  make asan
attack          20m  make attack
stress          60m  make stress
blas-matrix     150m tools/blas_matrix.sh
faults          120m /usr/bin/python3 tests/fault/table.py --check --full
deb-check       20m  make deb-check
instructions    20m  make bench-instructions
mutants-random  130m make mutants-random N=200
equivalents     30m /usr/bin/python3 tools/mutants_random.py --equivalent
STEPS
}
all=$(steps | awk '{ print $1 }')
[ $# != 0 ] || set -- $all
for name; do
    grep -qxF -- "$name" <<<"$all" || {
        echo "usage: tools/release_check.sh [STEP...]; steps: $(echo $all)" >&2
        exit 2
    }
done

commit=$(git rev-parse HEAD)
[ -z "$(git status --porcelain --untracked-files=no -- . ':!results/release')" ] || commit=$commit-dirty
version=$(make -s print-VERSION)
work=build/release/$commit log=results/release/$version.log
mkdir -p "$work" results/release
# The steps must not get the jobs and variables of the make that calls this script.
unset MAKEFLAGS MFLAGS MAKELEVEL
export HIFDM_NO_SKIP=1
tools/setup.sh --ci --release
make all

# OpenBLAS in addition to the installed BLAS, for same_bits.sh: fetched, not installed.
openblas=$(find build/release/openblas -name libblas.so.3 2>/dev/null | head -n 1)
if [ -z "${OPENBLAS:-}" ] && [ -z "$openblas" ]; then
    mkdir -p build/release/openblas
    (cd build/release/openblas && apt-get download libopenblas0-pthread >/dev/null 2>&1 &&
        for package in ./*.deb; do dpkg -x "$package" .; done) || echo "no OpenBLAS to fetch" >&2
    openblas=$(find build/release/openblas -name libblas.so.3 | head -n 1)
fi
export OPENBLAS=${OPENBLAS:-${openblas:+$(realpath "$openblas")}}

# Takes over what the log has of this commit from other machines.
if grep -qxF "commit    $commit" "$log" 2>/dev/null; then
    for name in $all; do
        line=$(grep -E "^$name +(passed|FAILED|TIMEOUT) " "$log") || continue
        [ -e "$work/$name" ] || echo "$line" >"$work/$name"
    done
fi

processor() { sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1; }
system() { sed -n 's/^PRETTY_NAME="\(.*\)"/\1/p' /etc/os-release; }
installed_blas() { realpath /usr/lib/*/libblas.so.3 /usr/lib/*/liblapack.so.3 2>/dev/null | tr '\n' ' '; }

write_log() {
    local name failed=""
    {
        echo "hifdm $version, make release-check"
        echo "commit    $commit"
        echo "last on   $(processor), $(nproc) cores; $(system), Linux $(uname -r), $(uname -m)"
        echo "compiler  $("${CC:-cc}" --version | head -n 1)"
        echo "BLAS      $(installed_blas)"
        echo
        for name in $all; do
            if [ -e "$work/$name" ]; then cat "$work/$name"; else printf '%-15s not run\n' "$name"; fi
            grep -q "^$name *passed" "$work/$name" 2>/dev/null || failed="$failed $name"
        done
        echo
        if [ -n "$failed" ]; then echo "not passed:$failed"
        elif cat "$work"/*.skipped 2>/dev/null | grep -q .; then echo "all passed, but for what was skipped"
        else echo "all passed"; fi
    } >"$log"
}

# Returns the last line of a step's output and the checks that it skipped, without paths of this machine.
words() { # STEP
    local text
    text=$(grep -vE '^(make(\[[0-9]+\])?: .*|[[:space:]]*)$' "$work/$1.log" | tail -n 1 | tr -d '\r')
    { echo "$text"; grep -hE '^not tried: ' "$work/$1.log"; sed 's/^/skipped: /' "$work/$1.skipped" 2>/dev/null; } |
        awk '!seen[$0]++' | sed "s|$PWD/||g" | paste -sd ';' | sed 's/;/; /g' | cut -c 1-300
}

failed=""
for name; do
    read -r _ limit command < <(steps | grep "^$name ")
    echo "==> $name: $command"
    start=$SECONDS outcome=passed code=0
    # shellcheck disable=SC2086 # these are words
    rm -f "$work/$name.skipped"
    HIFDM_SKIPPED=$PWD/$work/$name.skipped timeout --kill-after=30s "$limit" $command </dev/null \
        >"$work/$name.log" 2>&1 || code=$?
    case $code in
    0) ;;
    124 | 137) outcome="TIMEOUT ($limit)" ;;
    *) outcome="FAILED ($code)" ;;
    esac
    [ $code = 0 ] || failed="$failed $name"
    printf '%-15s %-14s %6s s  %s  %s\n' "$name" "$outcome" $((SECONDS - start)) "$(date -u +%F), $(processor)" \
        "$(words "$name")" >"$work/$name"
    cat "$work/$name"
    write_log
done
echo "==> $log"
[ -z "$failed" ] || { echo "==> not passed:$failed" >&2; exit 1; }
