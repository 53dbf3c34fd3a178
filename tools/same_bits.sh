#!/usr/bin/env bash
# The same bits? Runs cases by other compilers, with other LAPACKs, and on emulated processors, and tells for each how
# many data sets differ from those of the default build. What is not installed is named and left out: clang, OpenBLAS
# (Debian: libopenblas0-pthread, or OPENBLAS=.../libblas.so.3), qemu-x86_64 (Debian: qemu-user).
set -eu
cd "$(dirname "$0")/.."
work=${BUILD:-build}/bits n_differ=0 n_case=0
mkdir -p "$work"
cases=("chen2022 --set optimize.generations=20 --set optimize.compare_lm=true"
    "chen2022-truss --set optimize.generations=10 --set optimize.compare_lm=true"
    "reflector --set optimize.generations=10 --set optimize.method=ga+lm")

run_cases() { # PREFIX COMMAND...
    local name=$1 line words
    shift
    for line in "${cases[@]}"; do
        read -ra words <<<"$line"
        "$@" run "configs/${words[0]}.yaml" "${words[@]:1}" -o "$work/$name-${words[0]}.h5" --force --quiet \
            2>"$work/$name.log" >&2 || { cat "$work/$name.log" >&2; exit 1; }
    done
}
compare() { # PREFIX
    local line result
    for line in "${cases[@]}"; do
        result=$("$work/base/hifdm" diff "$work/base-${line%% *}.h5" "$work/$1-${line%% *}.h5" | tail -n 1) || true
        printf '%-28s %-16s %s\n' "$1" "${line%% *}" "${result%%; *}"
        n_case=$((n_case + 1))
        [[ $result = *" 0 differ"* ]] || n_differ=$((n_differ + 1))
    done
}
try() { # PREFIX COMMAND...
    run_cases "$@"
    compare "$1"
}
build() { # PREFIX MAKE-ARGUMENT...
    make -s -j "$(nproc)" BUILD="$work/$1" "${@:2}" "$work/$1/hifdm" >"$work/$1.log" 2>&1 || {
        tail -n 20 "$work/$1.log" >&2
        exit 1
    }
}

build base
run_cases base "$work/base/hifdm"
build O2 CFLAGS=-O2
try O2 "$work/O2/hifdm"
if command -v clang >/dev/null; then
    build clang CC=clang
    try clang "$work/clang/hifdm"
else echo "not tried: clang"; fi

openblas=${OPENBLAS:-$(find /usr/lib -name 'libblas.so.3' -path '*openblas*' 2>/dev/null | head -n 1)}
if [ -n "$openblas" ]; then
    for core in Haswell Zen SkylakeX Sandybridge Nehalem Prescott; do
        try "OpenBLAS-$core" env "LD_LIBRARY_PATH=$(dirname "$openblas")" "OPENBLAS_CORETYPE=$core" "$work/base/hifdm"
    done
else echo "not tried: OpenBLAS"; fi
reference=$(find /usr/lib -name 'libblas.so.3' -path '*/blas/*' 2>/dev/null | head -n 1)
lapack=$(find /usr/lib -name 'liblapack.so.3' -path '*/lapack/*' 2>/dev/null | head -n 1)
if [ -n "$reference" ] && [ -n "$lapack" ]; then
    try reference-LAPACK env "LD_LIBRARY_PATH=$(dirname "$reference"):$(dirname "$lapack")" "$work/base/hifdm"
else echo "not tried: the reference LAPACK"; fi

qemu=$(command -v qemu-x86_64 || command -v qemu-x86_64-static || true)
if [ -n "$qemu" ]; then
    for cpu in Nehalem Haswell; do # without and with AVX2 and FMA
        try "qemu-$cpu" "$qemu" -cpu "$cpu" "$work/base/hifdm"
    done
else echo "not tried: emulated processors"; fi
echo "$n_differ of $n_case results differ"
[ "$n_differ" = 0 ]
