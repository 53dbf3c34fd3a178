#!/usr/bin/env bash
# make_deb.sh TARBALL FOLDER: makes Debian packages of a tarball of `make dist` in FOLDER, by the recipe in its
# tools/debian. The date of a version is the one in CHANGELOG.md, so that the same tarball makes the same packages.
# MAINTAINER="Name <mail>" is the maintainer in the packages. DEB_BUILD_OPTIONS is as in dpkg-buildpackage.
set -eu
tarball=$(realpath "$1") folder=$2
name=$(basename "$tarball" .tar.gz)
version=${name#hifdm-}

rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
cp "$tarball" "hifdm_$version.orig.tar.gz"
tar -xzf "$tarball"
cd "$name"
cp -r tools/debian debian
maintainer=${MAINTAINER:-$(sed -n 's/^Maintainer: //p' debian/control)}
sed -i "s/^Maintainer: .*/Maintainer: $maintainer/" debian/control
# Writes an entry for each version of CHANGELOG.md. A version that is not released yet has the date of the tarball.
sed -n 's/^## \[\(.*\)\] - \(.*\)$/\1 \2/p' CHANGELOG.md | while read -r of day; do
    [ "$day" != unreleased ] || day=@$(stat -c %Y CHANGELOG.md)
    printf 'hifdm (%s-1) unstable; urgency=medium\n\n  * Version %s: CHANGELOG.md says what is new.\n\n -- %s  %s\n\n' \
        "$of" "$of" "$maintainer" "$(date -u -R -d "$day")"
done >debian/changelog
unset MAKEFLAGS MAKELEVEL BUILD PREFIX DESTDIR LIB
dpkg-buildpackage -us -uc -b -j"$(nproc)" >../log 2>&1 || { tail -n 30 ../log; exit 1; }
cd ..
ls ./*.deb
if command -v lintian >/dev/null; then
    lintian --fail-on error,warning --allow-root ./*.changes
else
    echo "no lintian here: the packages are unchecked"
fi
