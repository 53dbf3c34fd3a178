#!/usr/bin/env bash
# check_dist.sh TARBALL FOLDER: builds a tarball of `make dist` without git, installs it, runs it and uninstalls it.
# SUITE="..." also runs those suites of its tests.
set -eu
tarball=$(realpath "$1") folder=$2
fail() { echo "check_dist: $*" >&2; exit 1; }

rm -rf "$folder"
mkdir -p "$folder/bin"
tar -xzf "$tarball" -C "$folder" --strip-components=1
cd "$folder"
[ ! -e .git ] || fail "$tarball has a folder .git"
# A call of git fails here, as on a machine without git.
printf '#!/bin/sh\necho "git was called: $*" >&2\nexit 127\n' >bin/git
chmod +x bin/git
export PATH="$PWD/bin:$PATH"
unset MAKEFLAGS MAKELEVEL BUILD PREFIX DESTDIR LIB

make -s -j"$(nproc)" all >log 2>&1 || { tail -n 20 log; fail "does not build"; }
! grep -H 'git was called' log || fail "git is needed"
described=$(cat .describe)
build/hifdm version | grep -F "($described)" >/dev/null || fail "the program does not say that it is of $described"
if [ -n "${SUITE:-}" ]; then make -s test SUITE="$SUITE"; fi

there="$PWD/there"
make -s install DESTDIR="$there" PREFIX=/usr LIB=lib/here
"$there/usr/bin/hifdm" run configs/reflector.yaml -o case.h5 --quiet
export PKG_CONFIG_PATH="$there/usr/lib/here/pkgconfig"
printf '%s\n' '#include <hifdm/hifdm.h>' '#include <stdio.h>' \
    'int main(void) { return puts(hf_store_version()) < 0; }' >use.c
# shellcheck disable=SC2046
"${CC:-cc}" use.c -o use $(pkg-config --define-variable=prefix="$there/usr" --cflags --libs hifdm)
LD_LIBRARY_PATH="$there/usr/lib/here" ./use | grep -Fx "$(build/hifdm version | sed -n '1s/^hifdm //p')" >/dev/null ||
    fail "the installed library is of another version"
make -s uninstall DESTDIR="$there" PREFIX=/usr LIB=lib/here
left=$(cd "$there" && find . ! -type d -o -path "*hifdm*") # the folder above may have that name
[ -z "$left" ] || fail "make uninstall leaves $left"
for what in install python-install uninstall; do
    if make -s "$what" DESTDIR="$there/two words" PREFIX=/usr >log 2>&1; then fail "make $what takes a blank"; fi
    grep -F 'has a blank' log >/dev/null || fail "make $what does not refuse a blank"
done
echo "$(basename "$tarball"): $(wc -c <"$tarball") bytes; builds, installs, runs and uninstalls without git"
