#!/usr/bin/env bash
# Checks that results have the same bits.
#
# tools/same_bits.sh runs cases with other compilers and levels of optimisation, with fewer instruction sets, with other
# LAPACKs, and on emulated processors. For each it prints how many data sets differ from those of the default build.
# Programs that are not installed are listed and left out: clang, OpenBLAS (Debian: libopenblas0-pthread, or
# OPENBLAS=.../libblas.so.3), qemu-x86_64 (Debian: qemu-user).
#
# tools/same_bits.sh built builds nothing. It compares the existing programs build/hifdm and build/clang/hifdm with the
# checksums of the suite cli/bits. Each runs with the kernels of every instruction set of this machine and, if OpenBLAS
# is installed, with OpenBLAS for two processors. Needs build/tests/run_tests.
set -eu
cd "$(dirname "$0")/.."
build=${BUILD:-build} work=${BUILD:-build}/bits n_differ=0 n_case=0
mkdir -p "$work"
openblas=${OPENBLAS:-$(find /usr/lib -name 'libblas.so.3' -path '*openblas*' 2>/dev/null | head -n 1)}
isas=(portable) # instruction sets of this machine, in the order of hf_lane_isa
if grep -qw avx2 /proc/cpuinfo && grep -qw fma /proc/cpuinfo; then isas+=(avx2); fi
if grep -qw avx512f /proc/cpuinfo; then isas+=(avx512); fi

# Links the objects of BUILD-FOLDER again, into a program that uses the kernels of this instruction set.
link_isa() { # BUILD-FOLDER CC ISA-NUMBER PROGRAM
    local of=(make -s "BUILD=$1" "CC=$2") link objects libraries
    link=$("${of[@]}" print-LINK) objects=$("${of[@]}" print-APP_OBJ) libraries=$("${of[@]}" print-PKG_LIBS)
    printf 'int __wrap_hf_lane_best_isa(void);\nint __wrap_hf_lane_best_isa(void)\n{\n    return %s;\n}\n' "$3" >"$4.c"
    # shellcheck disable=SC2086 # these are words
    $link -Wl,--wrap=hf_lane_best_isa -o "$4" $objects "$4.c" "$1/libhifdm.a" $libraries
}

# ---- the existing programs, against the checksums of cli/bits ----

hold() { # NAME COMMAND-BEFORE... PROGRAM
    local name=$1 program=${*: -1} ok=same
    n_case=$((n_case + 1))
    env "${@:2:$#-2}" HIFDM="$(realpath "$program")" HIFDM_SOURCE_DIR="$PWD" PYTHON="${PYTHON:-/usr/bin/python3}" \
        TMPDIR="$(realpath "$work")" HIFDM_TEST_JOBS="$(nproc)" CK_DEFAULT_TIMEOUT=300 \
        "$build/tests/run_tests" cli/bits >"$work/$name.log" 2>&1 || ok=differs
    printf '%-28s %s\n' "$name" "$ok"
    [ $ok = same ] || { n_differ=$((n_differ + 1)); tail -n 40 "$work/$name.log" >&2; }
}
hold_built() { # NAME BUILD-FOLDER CC
    local i
    [ -x "$2/hifdm" ] || { echo "$2/hifdm is not there: make all BUILD=$2 CC=$3" >&2; exit 1; }
    for ((i = 0; i < ${#isas[@]}; i++)); do
        link_isa "$2" "$3" "$i" "$work/hifdm-$1-${isas[i]}"
        hold "$1-${isas[i]}" "$work/hifdm-$1-${isas[i]}"
    done
}
if [ "${1:-}" = built ]; then
    hold_built gcc "$build" "${CC:-cc}"
    if [ -e "$build/clang/libhifdm.a" ]; then hold_built clang "$build/clang" clang; else echo "not tried: clang"; fi
    if [ -n "$openblas" ]; then
        for core in Prescott Haswell; do
            hold "OpenBLAS-$core" "LD_LIBRARY_PATH=$(dirname "$openblas")" OPENBLAS_CORETYPE=$core "$build/hifdm"
        done
    else echo "not tried: OpenBLAS"; fi
    echo "$n_differ of $n_case programs differ"
    [ "$n_differ" = 0 ]
    exit
fi

# ---- whole results, against those of the default build ----

cases=("chen2022 --set optimize.generations=20" "chen2022-truss"
    "straight-edges --set optimize.generations=20 --set optimize.refine=true"
    "straight-edges-truss --set optimize.generations=10 --set optimize.refine=true"
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
    make -s -j "$(nproc)" BUILD="$work/$1" WERROR= "${@:2}" "$work/$1/hifdm" >"$work/$1.log" 2>&1 || {
        tail -n 20 "$work/$1.log" >&2
        exit 1
    }
}
try_isas() { # PREFIX CC
    local i
    for ((i = 0; i < ${#isas[@]} - 1; i++)); do
        link_isa "$work/$1" "$2" "$i" "$work/$1/hifdm-${isas[i]}"
        try "$1-${isas[i]}" "$work/$1/hifdm-${isas[i]}"
    done
}

build base
run_cases base "$work/base/hifdm"
try_isas base "${CC:-cc}"
for level in O1 O2; do # the default is O3
    build $level CFLAGS=-$level
    try $level "$work/$level/hifdm"
done
if command -v clang >/dev/null; then
    build clang CC=clang
    try clang "$work/clang/hifdm"
    try_isas clang clang
    build clang-O2 CC=clang CFLAGS=-O2
    try clang-O2 "$work/clang-O2/hifdm"
else echo "not tried: clang"; fi

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
