#!/usr/bin/env bash
# Builds hifdm for aarch64 on Debian and runs its unit, property and verification tests, emulated; then compares results
# with those of this machine: the same bits. Needs the packages gcc-aarch64-linux-gnu, libc6-dev-arm64-cross and
# qemu-user-static, and `dpkg --add-architecture arm64 && apt-get update`; the libraries are fetched into
# build/aarch64/root, nothing is installed. SUITE="unit verify" picks suites.
set -eu
cd "$(dirname "$0")/.."
build=$(realpath -m "${BUILD:-build}")/aarch64 triplet=aarch64-linux-gnu
root=$build/root libraries=$build/root/usr/lib/$triplet
mkdir -p "$build/debs" "$build/tmp"
for program in $triplet-gcc qemu-aarch64-static; do
    command -v $program >/dev/null || { echo "no $program: see the beginning of $0" >&2; exit 2; }
done

if [ ! -e "$root/done" ]; then
    wanted=(libhdf5-dev libgsl-dev liblapack3 libyaml-dev zlib1g-dev check libgomp1 libc6-dev)
    mapfile -t packages < <(apt-get install -s --no-install-recommends "${wanted[@]/%/:arm64}" |
        awk '/^Inst/ && /arm64/ { sub(/:arm64$/, "", $2); print $2 ":arm64" }' | sort -u)
    [ ${#packages[@]} -gt 0 ] || { echo "apt knows no packages for arm64: see the beginning of $0" >&2; exit 2; }
    (cd "$build/debs" && apt-get download "${packages[@]}")
    for package in "$build"/debs/*.deb; do dpkg -x "$package" "$root"; done
    find "$root" -type l -lname '/*' | while read -r link; do ln -snf "$root$(readlink "$link")" "$link"; done
    ln -sf hdf5-serial.pc "$libraries/pkgconfig/hdf5.pc" # made by its package's installation
    touch "$root/done"
fi

path=$libraries:$libraries/lapack:$libraries/blas:$libraries/hdf5/serial
export PKG_CONFIG_LIBDIR=$libraries/pkgconfig PKG_CONFIG_SYSROOT_DIR=$root
make -s -j "$(nproc)" BUILD="$build" CC="$triplet-gcc --sysroot=$root" AR=$triplet-ar LDFLAGS="-Wl,-rpath-link,$path" \
    "$build/hifdm" "$build/tests/run_tests"
unset PKG_CONFIG_LIBDIR PKG_CONFIG_SYSROOT_DIR
emulated=(qemu-aarch64-static -L "$root" -E "LD_LIBRARY_PATH=$path")
printf '#!/bin/sh\nexec %s "$@"\n' "${emulated[*]} $build/hifdm" >"$build/hifdm-emulated"
chmod +x "$build/hifdm-emulated"
read -ra suites <<<"${SUITE:-unit property verify cli/bits}"
HIFDM=$build/hifdm-emulated HIFDM_SOURCE_DIR=$PWD PYTHON=${PYTHON:-/usr/bin/python3} TMPDIR=$build/tmp \
    CK_DEFAULT_TIMEOUT=1800 HIFDM_TEST_JOBS=$(nproc) "${emulated[@]}" "$build/tests/run_tests" "${suites[@]}"
