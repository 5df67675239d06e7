# SPDX-License-Identifier: BSD-3-Clause
# Conan 2: conan create . --build=missing [-o "&:vision=False"] [-o "&:optimization=False"]
import os
import re

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rmdir

required_conan_version = ">=2.0"


class HmcdynConan(ConanFile):
    name = "hmcdyn"
    description = "Which key points lie on moving things: a dynamic-feature filter for RGB-D SLAM"
    license = "BSD-3-Clause"
    topics = ("slam", "rgb-d", "robotics", "computer-vision", "dynamic-environments")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {
        "shared": [True, False],
        "fPIC": [True, False],
        "vision": [True, False],  # needs OpenCV
        "optimization": [True, False],  # needs Ceres
    }
    default_options = {"shared": False, "fPIC": True, "vision": True, "optimization": True}
    implements = ["auto_shared_fpic"]
    exports_sources = ("CMakeLists.txt", "LICENSE", "README.md", "cmake/*", "include/*", "src/*")

    def set_version(self):
        header = load(self, os.path.join(self.recipe_folder, "include", "hmcdyn", "version.hpp"))
        self.version = re.search(r'HMCDYN_VERSION_STRING "([0-9.]+)"', header).group(1)

    def layout(self):
        cmake_layout(self)

    def requirements(self):
        self.requires("eigen/[>=3.3.7 <4]", transitive_headers=True)
        self.requires("nanoflann/[>=1.3.1 <1.8]", transitive_headers=True)
        if self.options.vision:
            self.requires("opencv/[>=4.5 <5]", transitive_headers=True, transitive_libs=True)
        if self.options.optimization:
            self.requires("ceres-solver/[>=2.0 <2.3]")

    def validate(self):
        check_min_cppstd(self, 17)

    def package_id(self):
        if not self.info.options.vision and not self.info.options.optimization:
            self.info.clear()  # core is headers only

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["HMCDYN_WITH_VISION"] = bool(self.options.vision)
        toolchain.cache_variables["HMCDYN_WITH_OPTIMIZATION"] = bool(self.options.optimization)
        toolchain.cache_variables["HMCDYN_BUILD_EXAMPLES"] = False
        toolchain.cache_variables["HMCDYN_BUILD_TESTS"] = False
        toolchain.cache_variables["HMCDYN_INSTALL"] = True
        toolchain.generate()
        CMakeDeps(self).generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        CMake(self).install()
        # Conan's generators write these for whoever uses the package.
        rmdir(self, os.path.join(self.package_folder, "lib", "cmake"))
        rmdir(self, os.path.join(self.package_folder, "lib", "pkgconfig"))
        rmdir(self, os.path.join(self.package_folder, "share"))

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "hmcdyn")
        self.cpp_info.set_property("cmake_target_name", "hmcdyn::hmcdyn")
        core = self.cpp_info.components["core"]
        core.set_property("cmake_target_name", "hmcdyn::core")
        core.set_property("pkg_config_name", "hmcdyn-core")
        core.bindirs = []
        core.libdirs = []
        core.requires = ["eigen::eigen", "nanoflann::nanoflann"]
        if self.options.vision:
            vision = self.cpp_info.components["vision"]
            vision.set_property("cmake_target_name", "hmcdyn::vision")
            vision.set_property("pkg_config_name", "hmcdyn-vision")
            vision.libs = ["hmcdyn_vision"]
            vision.requires = ["core", "opencv::opencv_core", "opencv::opencv_imgproc",
                               "opencv::opencv_video", "opencv::opencv_calib3d"]
        if self.options.optimization:
            optimization = self.cpp_info.components["optimization"]
            optimization.set_property("cmake_target_name", "hmcdyn::optimization")
            optimization.set_property("pkg_config_name", "hmcdyn-optimization")
            optimization.libs = ["hmcdyn_optimization"]
            optimization.requires = ["core", "ceres-solver::ceres-solver"]
