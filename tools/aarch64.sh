#!/usr/bin/env bash
# Builds hifdm for aarch64 on Debian, runs its unit, property and verification tests in an emulator, and checks that
# results have the same bits as those of this machine. Needs the packages gcc-aarch64-linux-gnu, libc6-dev-arm64-cross
# and qemu-user-static (tools/setup.sh --release). An apt that has its lists in build/aarch64 fetches the libraries into
# build/aarch64/root, so nothing is installed and no architecture is added. SUITE="unit verify" selects suites.
set -eu
cd "$(dirname "$0")/.."
build=$(realpath -m "${BUILD:-build}")/aarch64 triplet=aarch64-linux-gnu
root=$build/root libraries=$build/root/usr/lib/$triplet
mkdir -p "$build/tmp"
for program in $triplet-gcc qemu-aarch64-static; do
    command -v $program >/dev/null || { echo "no $program: see the beginning of $0" >&2; exit 2; }
done

if [ ! -e "$root/done" ]; then
    mkdir -p "$build/apt/state/lists/partial" "$build/apt/cache/archives/partial"
    : >"$build/apt/state/status"
    own=(apt-get -q -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o "Dir::State=$build/apt/state"
        -o "Dir::State::status=$build/apt/state/status" -o "Dir::Cache=$build/apt/cache" -o APT::Sandbox::User=root
        -o Debug::NoLocking=true -o APT::Install-Recommends=false -o APT::Keep-Downloaded-Packages=true)
    wanted=(libhdf5-dev libgsl-dev liblapack3 libyaml-dev zlib1g-dev check libgomp1 libc6-dev)
    { "${own[@]}" update && "${own[@]}" install -y --download-only "${wanted[@]}"; } >"$build/apt/log" 2>&1 ||
        { tail -n 20 "$build/apt/log" >&2; echo "apt fetches no packages for arm64" >&2; exit 2; }
    for package in "$build"/apt/cache/archives/*.deb; do dpkg -x "$package" "$root"; done
    find "$root" -type l -lname '/*' | while read -r link; do ln -snf "$root$(readlink "$link")" "$link"; done
    ln -sf hdf5-serial.pc "$libraries/pkgconfig/hdf5.pc" # the installation of its package would make it
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
