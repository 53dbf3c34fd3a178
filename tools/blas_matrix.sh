#!/usr/bin/env bash
# blas_matrix.sh: builds, tests and packages the current commit in bare roots of Debian, one for each build of BLAS and
# LAPACK. The development package of the build is installed first; then run `tools/setup.sh`, `make`, `make test` and
# `make deb`. Needs root, debootstrap and the network; writes to build/matrix. Prints one line per root. The exit status
# is 0 if all of them passed, and 1 otherwise. BLAS="reference pthread serial openmp" selects builds, SUITE="..." tests,
# RELEASE=bookworm and MIRROR=http://... another Debian, and JOBS=... the number of cores.
set -eu
cd "$(dirname "$0")/.."
release=${RELEASE:-bookworm} mirror=${MIRROR:-http://deb.debian.org/debian} jobs=${JOBS:-$(nproc)}
work=$PWD/build/matrix
[ "$(id -u)" = 0 ] || { echo "blas_matrix.sh: must be root, for chroot" >&2; exit 2; }
command -v debootstrap >/dev/null || { echo "blas_matrix.sh: no debootstrap: apt-get install debootstrap" >&2; exit 2; }
mkdir -p "$work"

packages_of() {
    case $1 in
    reference) echo liblapack-dev libblas-dev ;;
    pthread | serial | openmp) echo "libopenblas-$1-dev" ;;
    *) echo "blas_matrix.sh: no BLAS $1" >&2; exit 2 ;;
    esac
}

leave() {
    local mounted
    awk -v root="$work/" 'index($2, root) == 1 { print $2 }' /proc/mounts | sort -r | while read -r mounted; do
        umount "$mounted"
    done
}
trap leave EXIT

inside() {
    local root=$1
    shift
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
        ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} \
        HIFDM_TEST_JOBS="$jobs" chroot "$root" sh -ec "cd /hifdm && $*"
}

# Runs the steps in one root. $work/NAME.step holds the last step that has begun.
try() {
    local name=$1 root=$work/$1
    step() { echo "$1" >"$work/$name.step"; echo "==> $name: $1"; }
    step debootstrap
    rm -rf "$root"
    debootstrap --variant=minbase --include=ca-certificates,git,make "$release" "$root" "$mirror"
    mount -t proc proc "$root/proc"
    mount --rbind /dev "$root/dev"
    mount --make-rslave "$root/dev"
    git clone -q --no-hardlinks . "$root/hifdm"
    step packages
    # shellcheck disable=SC2046
    inside "$root" apt-get -y -q install --no-install-recommends $(packages_of "$name")
    step setup
    inside "$root" tools/setup.sh --test --deb
    step make
    inside "$root" make -j"$jobs"
    step "make test"
    inside "$root" make -j"$jobs" test SUITE="'${SUITE:-}'"
    step "make deb"
    inside "$root" make -j"$jobs" deb
    step done
}

failed=""
for name in ${BLAS:-reference pthread serial openmp}; do
    start=$SECONDS
    set +e # with || after it, a step that fails would not end it
    (set -e; try "$name") >"$work/$name.log" 2>&1
    set -e
    leave
    step=$(cat "$work/$name.step")
    if [ "$step" = done ]; then
        echo "$name: $(grep -E '[0-9]+ passed, ' "$work/$name.log" | tail -n 1); packaged; $((SECONDS - start)) s"
        rm -rf "${work:?}/$name"
    else
        echo "$name: FAILED at $step, $((SECONDS - start)) s; build/matrix/$name.log"
        failed=yes
    fi
done
[ -z "$failed" ]
