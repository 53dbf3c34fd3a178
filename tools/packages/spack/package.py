# Recipe for Spack. Put the tarball of `make dist` into the current folder, and this file into packages/hifdm of a
# repository of your own (`spack repo create FOLDER`, `spack repo add FOLDER`). Then run:
#
#     spack install --no-checksum hifdm ^openblas
#
# NOT TESTED: no Spack was available when this recipe was written. `make dist-check` tests the build on Debian 12.
import os

from spack.package import *


class Hifdm(MakefilePackage):
    """Form finding of cable nets with force densities: shape and pretension of mesh reflectors."""

    manual_download = True
    url = f"file://{os.getcwd()}/hifdm-0.3.0.tar.gz"
    license("GPL-3.0-or-later")

    version("0.3.0")

    depends_on("c", type="build")
    depends_on("gmake", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("gsl")
    depends_on("hdf5@1.10:")
    depends_on("lapack")
    depends_on("libyaml")
    depends_on("zlib-api")

    # A newer compiler than ours may have other warnings.
    @property
    def build_targets(self):
        return ["WERROR=", f"PREFIX={self.prefix}", f"LAPACK={self.lapack}", "all"]

    @property
    def install_targets(self):
        return ["WERROR=", f"PREFIX={self.prefix}", f"LAPACK={self.lapack}", "install"]

    # Paths of the libraries. The program loads one of them when it needs it.
    @property
    def lapack(self):
        return " ".join(self.spec["lapack"].libs)

    @run_after("install")
    @on_package_attributes(run_tests=True)
    def smoke(self):
        program = Executable(self.prefix.bin.hifdm)
        program("new", "dish", "--paraboloid")
        program("run", "dish.yaml", "--quiet")
