"""`pip install` of the package: CMake builds the module and puts it, with specs and scenes, where setuptools packs it.

CDOT_BUILD names a configured build folder that is used, and kept, in place of a temporary one. The checkout stays as it
is.
"""
import atexit
import os
import re
import shutil
import subprocess
import sys
import tempfile

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

checkout = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
with open(os.path.join(checkout, "CMakeLists.txt"), encoding="utf-8") as lists:
    version = re.search(r"project\(\w+ VERSION ([\d.]+)", lists.read()).group(1)
scratch = tempfile.mkdtemp(prefix="cdot-")
atexit.register(shutil.rmtree, scratch, ignore_errors=True)


class ByCMake(build_ext):
    def build_extension(self, ext):
        target = os.path.dirname(os.path.dirname(os.path.abspath(self.get_ext_fullpath(ext.name))))
        build = os.environ.get("CDOT_BUILD")
        if not build:
            build = os.path.join(scratch, "module")
            subprocess.run(["cmake", "-S", checkout, "-B", build, "-DCDOT_PYTHON=ON", "-DCDOT_TESTS=OFF",
                            "-DCDOT_DERIVE=OFF", "-DCMAKE_BUILD_TYPE=Release",
                            f"-DPython3_EXECUTABLE={sys.executable}"], check=True)
        cores = str(os.cpu_count() or 1)
        subprocess.run(["cmake", "--build", build, "--target", "cdot_python", "--parallel", cores], check=True)
        subprocess.run(["cmake", "--install", build, "--component", "cdot_wheel", "--prefix", target], check=True)


setup(version=version, ext_modules=[Extension("cdot._cdot", [])], cmdclass={"build_ext": ByCMake},
      options={"build": {"build_base": os.path.join(scratch, "packed")}, "egg_info": {"egg_base": scratch}})
