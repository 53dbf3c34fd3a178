#!/usr/bin/env bash
# Installs what is missing to build hifdm: setup.sh [--OPTION]...
#   --test  also what the tests need     --ci  also clang, sanitizers, linters, VTK, a browser, Slurm (includes --test)
#   --bench also the peers of `make bench`     --api  also doxygen, for `make api`
#   --docs  also Sphinx with its theme, for `make docs`
#   --deb   also debhelper, lintian and debootstrap, for `make deb-check`
#   --workflows also Snakemake, for `make workflow-check`     --optimisers also those of `make bench-optimisers`
#   --instructions also valgrind, for `make bench-instructions`     --release also emulators, for `make release-check`
# It is silent and quick if nothing is missing. It looks for what is needed (a compiler, a pkg-config name, a Python
# module) and not for packages, so other providers will do as well: any LAPACK that can be loaded, modules from pip.
set -eu

with_test=no with_ci=no with_bench=no with_optimisers=no with_api=no with_docs=no with_deb=no with_workflows=no
with_instructions=no with_release=no
for option in "$@"; do
    case $option in
    --test) with_test=yes ;;
    --ci) with_test=yes with_ci=yes with_api=yes with_docs=yes with_instructions=yes with_deb=yes ;;
    --bench) with_bench=yes ;;
    --optimisers) with_optimisers=yes ;;
    --instructions) with_instructions=yes ;;
    --release) with_release=yes ;;
    --api) with_api=yes ;;
    --deb) with_deb=yes ;;
    --workflows) with_workflows=yes ;;
    --docs) with_docs=yes ;;
    *) echo "usage: tools/setup.sh [--OPTION]..., the options at its top" >&2; exit 2 ;;
    esac
done

has() { command -v "$1" >/dev/null 2>&1; }
has_library() { pkg-config --exists "$@" 2>/dev/null; }
# Returns true if the program finds a LAPACK when it runs. LAPACK="NAME..." gives other names, as for make.
has_lapack() {
    local name
    for name in ${LAPACK:-liblapack.so.3 libopenblas.so.0}; do
        [[ $name != */* || ! -e $name ]] || return 0
        if PATH=$PATH:/sbin ldconfig -p | grep -F "$name " >/dev/null; then return 0; fi
    done
    return 1
}
has_header() { "${CC:-cc}" -E -include "$1" -x c /dev/null >/dev/null 2>&1; }
# Returns true if a program in C++ with this line links with these libraries.
links() {
    local line=$1
    shift
    printf '%s\nint main() { return 0; }\n' "$line" | g++ -o /dev/null -x c++ - "$@" 2>/dev/null
}
has_openmp() { printf '#include <omp.h>\n#include <stdlib.h>\n' | "$@" -fopenmp -fsyntax-only -x c - 2>/dev/null; }
# Returns true if Debian's own Python has the module, as in the Makefile. Its packages are of no use to another python3
# that comes first in PATH.
has_module() {
    "${PYTHON:-/usr/bin/python3}" -c \
        'import sys, importlib.util as u; sys.exit(not u.find_spec(sys.argv[1]))' "$1" 2>/dev/null
}

# Prints the Debian packages that would provide what is missing, on one line.
missing_packages() {
    local list="" cc=${CC:-cc}
    need() { list="$list $*"; }

    # gcc only recommends libc6-dev, and recommended packages are not installed below.
    case $cc in
    *clang*) has_openmp "$cc" || need clang libc6-dev libomp-dev ;;
    *) has_openmp "$cc" || need gcc libc6-dev ;;
    esac
    has make || need make
    has pkg-config || need pkg-config
    has_lapack || need libopenblas0-pthread
    has_library gsl || need libgsl-dev
    has_library hdf5 || need libhdf5-dev
    has_library zlib || need zlib1g-dev
    has_library yaml-0.1 || need libyaml-dev

    if [ $with_test = yes ]; then
        has_library check || need check
        has h5dump || need hdf5-tools
        has_module h5py || need python3-h5py
        has_module yaml || need python3-yaml
        has_module scipy || need python3-scipy
    fi
    if [ $with_bench = yes ]; then
        has_header suitesparse/cholmod.h || need libsuitesparse-dev
        has_library lapack blas || need liblapack-dev libblas-dev # old commits link them: make bench-before
        has_module scipy || need python3-scipy
    fi
    if [ $with_optimisers = yes ]; then
        has g++ || need g++
        has_library eigen3 || need libeigen3-dev
        has_library tbb || need libtbb-dev
        links "#include <nlopt.hpp>" -lnlopt_cxx -lnlopt || need libnlopt-dev libnlopt-cxx-dev
        [ -e /usr/include/boost/serialization/access.hpp ] || need libboost-serialization-dev
        [ -e /usr/include/pagmo/population.hpp ] || need libpagmo-dev
        has_module scipy || need python3-scipy
    fi
    if [ $with_instructions = yes ]; then
        has valgrind || need valgrind
    fi
    if [ $with_api = yes ]; then
        has doxygen || need doxygen
    fi
    if [ $with_docs = yes ]; then
        has_module sphinx || need python3-sphinx
        has_module myst_parser || need python3-myst-parser
        has_module furo || need furo
    fi
    if [ $with_workflows = yes ]; then
        has snakemake || need snakemake
    fi
    if [ $with_deb = yes ]; then
        has dpkg-buildpackage || need dpkg-dev
        # dpkg-buildpackage requires this package by its name.
        dpkg-query -W -f '${Status}' build-essential 2>/dev/null | grep ' installed$' >/dev/null || need build-essential
        has dh || need debhelper
        has dh_python3 || need dh-python
        has lintian || need lintian
        has debootstrap || [ -x /usr/sbin/debootstrap ] || need debootstrap
    fi
    if [ $with_release = yes ]; then
        has aarch64-linux-gnu-gcc || need gcc-aarch64-linux-gnu
        [ -e /usr/aarch64-linux-gnu/include/stdio.h ] || need libc6-dev-arm64-cross
        has qemu-aarch64-static && has qemu-x86_64-static || need qemu-user-static
    fi
    if [ $with_ci = yes ]; then
        has clang || need clang
        has_openmp clang || need libomp-dev
        # The package has clang's version in its name, which is known only after clang is installed, in the second round
        # below. It must have the thread sanitizer, the address sanitizer and the fuzzer.
        if has clang && ! ls "$(clang -print-resource-dir)"/lib/linux/libclang_rt.{tsan,asan,fuzzer}-*.a \
            >/dev/null 2>&1; then
            need "libclang-rt-$(clang -dumpversion | cut -d. -f1)-dev"
        fi
        has cppcheck || need cppcheck
        has clang-tidy || need clang-tidy
        has clang-format || need clang-format
        has_module vtk || need python3-vtk9
        has chromium || need chromium fonts-dejavu-core
        has node || need nodejs
        has pdftotext || need poppler-utils
        has npm || need npm
        has sbatch && has slurmctld && has slurmd || need slurm-wlm
        has munged || need munge
        has parallel || need parallel
        { has man && has groff; } || has mandoc || need mandoc
        has localedef || need libc-bin
        has g++ || need g++
        has_module matplotlib || need python3-matplotlib
        has_module pandas || need python3-pandas
    fi
    echo $list
}

# Succeeds if we may run apt-get, and sets $as_root to the way.
may_install() {
    has apt-get || return 1
    as_root=""
    [ "$(id -u)" = 0 ] && return 0
    as_root="sudo -n"
    has sudo && sudo -n true 2>/dev/null
}

apt() {
    $as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get -y -o DPkg::Lock::Timeout=120 "$@" </dev/null >>"$log" 2>&1
}

have_lists() { ls /var/lib/apt/lists/*_Packages* >/dev/null 2>&1; }

install() {
    have_lists || apt update
    # The package list may be older than the archive. This is the only failure that an update and a second try can
    # repair.
    apt install --no-install-recommends "$@" || { apt update && apt install --no-install-recommends "$@"; }
}

missing=$(missing_packages)
[ -n "$missing" ] || exit 0
if ! may_install; then
    echo "Some packages are missing. Install them and try again; on Debian or Ubuntu:" >&2
    echo "    sudo apt-get install $missing" >&2
    exit 1
fi

log=$(mktemp "${TMPDIR:-/tmp}/hifdm-setup-XXXXXX")
for round in 1 2; do
    echo "Installing $missing"
    # Unquoted: one argument per package.
    if ! install $missing; then
        tail -n 20 "$log" >&2
        echo "Could not install: $missing (log: $log)" >&2
        exit 1
    fi
    missing=$(missing_packages)
    [ -n "$missing" ] || { rm -f "$log"; exit 0; }
done
echo "Still missing after installing: $missing (log: $log)" >&2
exit 1
