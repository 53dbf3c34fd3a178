#!/usr/bin/env bash
# blas.sh [--with "NAME..."] COMMAND...: runs a command under each of four builds of BLAS and LAPACK: reference, and
# OpenBLAS pthread, serial and openmp. The packages of Debian are fetched into build/blas and unpacked there; nothing is
# installed. The program finds them by LD_LIBRARY_PATH. Exit status 1 if the command fails under one of them.
#
#     tools/blas.sh make test SUITE="unit property fault"
#     tools/blas.sh --with "reference pthread" make deb
set -eu
cd "$(dirname "$0")/.."
names="reference pthread serial openmp"
if [ "${1:-}" = --with ]; then names=$2; shift 2; fi
[ $# -gt 0 ] || { sed -n '2,7s/^# \{0,1\}//p' "$0" >&2; exit 2; }
there=$PWD/build/blas
mkdir -p "$there"

# Sets $folders to the folders with the libraries, and fetches the libraries first.
find_libraries() {
    local name=$1 packages=libopenblas0-$1 file
    [ "$name" != reference ] || packages="liblapack3 libblas3"
    if [ ! -e "$there/$name/done" ]; then
        rm -rf "${there:?}/$name"
        mkdir "$there/$name"
        # apt-get warns about its sandbox, which cannot write here.
        # shellcheck disable=SC2086
        (cd "$there/$name" && apt-get download -qq $packages 2>log) || { cat "$there/$name/log" >&2; exit 1; }
        for file in "$there/$name"/*.deb; do dpkg -x "$file" "$there/$name"; done
        touch "$there/$name/done"
    fi
    folders=$(find "$there/$name" \( -name liblapack.so.3 -o -name libblas.so.3 \) -printf '%h\n' | sort -u |
        paste -sd:)
}

# Checks that the program loads this LAPACK.
check() {
    local used
    [ -x build/hifdm ] || make -s build/hifdm
    build/hifdm run configs/reflector.yaml -o "$there/is.h5" --restart --quiet
    used=$(LC_ALL=C grep -a -o "$there/[a-z]*/[^;]*liblapack[.0-9a-z]*" "$there/is.h5" | head -n 1)
    [[ $used == "$there/$1/"* ]] || { echo "blas.sh: $1 is not loaded, but ${used:-another LAPACK}" >&2; exit 1; }
}

failed=""
for name in $names; do
    find_libraries "$name"
    export LD_LIBRARY_PATH=$folders
    check "$name"
    echo "--> $name"
    "$@" || failed="$failed $name"
done
[ -z "$failed" ] || { echo "blas.sh: $* failed under$failed" >&2; exit 1; }
