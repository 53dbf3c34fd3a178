# Recipe for Spack. Put the tarball of `make dist` into the current folder, this file into packages/hifdm of a
# repository of your own (`spack repo create FOLDER`, `spack repo add FOLDER`), and:
#
#     spack install --no-checksum hifdm ^openblas
#
# NOT TRIED: there was no Spack where it was written. The build that it asks for is tried on Debian 12 by
# `make dist-check`; LAPACK_LIBS by `make deb`.
import os

from spack.package import *


class Hifdm(MakefilePackage):
    """Form finding of cable nets with force densities: shape and pretension of mesh reflectors."""

    manual_download = True
    url = f"file://{os.getcwd()}/hifdm-0.2.0.tar.gz"
    license("GPL-3.0-or-later")

    version("0.2.0")

    depends_on("c", type="build")
    depends_on("gmake", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("blas")
    depends_on("gsl")
    depends_on("hdf5@1.10:")
    depends_on("lapack")
    depends_on("libyaml")
    depends_on("zlib-api")

    # A compiler newer than ours may have warnings of its own.
    @property
    def build_targets(self):
        return ["WERROR=", f"PREFIX={self.prefix}", f"LAPACK_LIBS={self.lapack_libs}", "all"]

    @property
    def install_targets(self):
        return ["WERROR=", f"PREFIX={self.prefix}", f"LAPACK_LIBS={self.lapack_libs}", "install"]

    @property
    def lapack_libs(self):
        return (self.spec["lapack"].libs + self.spec["blas"].libs).ld_flags

    @run_after("install")
    @on_package_attributes(run_tests=True)
    def smoke(self):
        program = Executable(self.prefix.bin.hifdm)
        program("new", "dish", "--paraboloid")
        program("run", "dish.yaml", "--quiet")
