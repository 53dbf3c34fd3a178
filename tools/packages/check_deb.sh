#!/usr/bin/env bash
# check_deb.sh FOLDER WORK: installs, runs and purges the Debian packages in FOLDER (make deb) in a bare root. Needs
# root and debootstrap. The base root is made once and kept in WORK/base-RELEASE; the checks use a copy.
#   RELEASE=bookworm  the release of Debian; by default that of this machine
#   MIRROR=...        source of the packages (default: http://deb.debian.org/debian)
#   WITH="PACKAGE"    packages that are installed first, such as libopenblas0-pthread for another BLAS
set -eu
packages=$(realpath "$1") work=$2
release=${RELEASE:-$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)} mirror=${MIRROR:-http://deb.debian.org/debian}
fail() { echo "check_deb: $*" >&2; exit 1; }
skip() { # REASON [tool]
    echo "skipped: deb-check: $1"
    [ -z "${HIFDM_SKIPPED:-}" ] || echo "deb-check: $1" >>"$HIFDM_SKIPPED"
    [ "${2:-}" != tool ] || [ "${HIFDM_NO_SKIP:-}" != 1 ] || fail "$1, and HIFDM_NO_SKIP=1"
    exit 0
}
PATH=$PATH:/usr/sbin:/sbin
[ "$(id -u)" = 0 ] || skip "not root, so no root can be made"
command -v debootstrap >/dev/null || skip "no debootstrap" tool
ls "$packages"/hifdm_*.deb >/dev/null || fail "no packages in $packages: make deb"

mkdir -p "$work"
work=$(realpath "$work") root=$work/root log=$work/log
base=$work/base-$release
rm -rf "$root" "$base.new"
if [ ! -d "$base" ]; then
    if ! debootstrap --variant=minbase "$release" "$base.new" "$mirror" >"$log" 2>&1; then
        grep -vE '^I: ' "$log" | tail -n 5 >&2
        skip "debootstrap of $release does not work here"
    fi
    mv "$base.new" "$base"
fi
cp -a "$base" "$root"
trap 'rm -rf "$root"' EXIT

clean=(env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive
    ${http_proxy:+"http_proxy=$http_proxy"})
in_root() { # COMMAND...: its output goes into the log, and is printed if it fails
    chroot "$root" "${clean[@]}" "$@" </dev/null >"$log" 2>&1 || { tail -n 30 "$log" >&2; fail "failed: $*"; }
}
get() { in_root apt-get install -y --no-install-recommends "$@"; }
ours() { # lists the packages that dpkg knows, also those that are not purged
    chroot "$root" dpkg-query -W -f '${db:Status-Abbrev}${Package}\n' '*hifdm*' 2>/dev/null | grep -v '^un' || true
}

mkdir "$root/debs"
for package in "$packages"/*.deb; do
    case $package in *-dbgsym_*) ;; *) cp "$package" "$root/debs" ;; esac
done
cp /etc/resolv.conf "$root/etc/resolv.conf"
in_root apt-get update
# shellcheck disable=SC2086 # these are words
[ -z "${WITH:-}" ] || get $WITH
mapfile -t debs < <(cd "$root" && printf '/%s\n' debs/*.deb)
get "${debs[@]}"
mapfile -t names < <(ours | cut -c4- | sort)
mapfile -t files < <(chroot "$root" dpkg -L "${names[@]}" | grep hifdm)

# Tests the program and the library with only what the packages depend on.
version=$(basename "$packages"/hifdm_*.deb | cut -d_ -f2 | sed 's/-[^-]*$//')
in_root hifdm version
grep -q "^hifdm $version " "$log" || fail "hifdm version is not $version: $(head -n 1 "$log")"
examples=/usr/share/doc/hifdm/examples
in_root hifdm run $examples/chen2022-truss.yaml -o /truss.h5 --quiet
in_root hifdm run $examples/reflector.yaml -o /reflector.h5 --quiet
in_root hifdm show /reflector.h5
in_root python3 -c 'import hifdm'
in_root python3 /usr/share/doc/python3-hifdm/examples/net_of_arrays.py
# Builds the example in C as its head describes, with a compiler and pkg-config.
get gcc libc6-dev pkg-config
in_root sh -c 'cc -std=c11 /usr/share/doc/libhifdm-dev/examples/read_example.c $(pkg-config --cflags --libs hifdm) \
    -lm -o /read_example && /read_example /reflector.h5'
grep -q '^psi .* mm after form-finding$' "$log" || fail "the example in C prints no psi"

in_root apt-get purge -y "${names[@]}"
[ -z "$(ours)" ] || fail "dpkg knows after the purge: $(ours)"
left=$(for file in "${files[@]}"; do [ ! -e "$root$file" ] || echo "$file"; done
    find "$root" -xdev \( -path "$root/debs" -o -path "$root/var/log" \) -prune -o -name '*hifdm*' -print)
[ -z "$left" ] || fail "left after the purge: $left"
echo "${names[*]} $version: installed in a bare $release${WITH:+ with $WITH}, run, and purged without a trace"
