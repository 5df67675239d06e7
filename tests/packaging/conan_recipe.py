# SPDX-License-Identifier: BSD-3-Clause
"""Runs what the Conan recipe says about itself, with stand-ins for Conan's modules: the version is the
header's, what it exports exists, and its components are those of the CMake build."""
import collections
import os
import sys
import types

source, version = sys.argv[1:]


class Component:
    def __init__(self):
        self.properties = {}
        self.requires = []
        self.libs = []

    def set_property(self, name, value):
        self.properties[name] = value


def module(name, **members):
    made = types.ModuleType(name)
    made.__dict__.update(members)
    sys.modules[name] = made


module("conan", ConanFile=object)
module("conan.tools")
module("conan.tools.build", check_min_cppstd=None)
module("conan.tools.cmake", CMake=None, CMakeDeps=None, CMakeToolchain=None, cmake_layout=None)
module("conan.tools.files", copy=None, rmdir=None,
       load=lambda recipe, path: open(path, encoding="utf-8").read())

recipe_file = os.path.join(source, "conanfile.py")
scope = {}
exec(compile(open(recipe_file, encoding="utf-8").read(), recipe_file, "exec"), scope)
recipe = scope["HmcdynConan"]()
recipe.recipe_folder = source
recipe.set_version()
assert recipe.version == version, recipe.version

for pattern in recipe.exports_sources:
    assert os.path.exists(os.path.join(source, pattern.split("*")[0])), pattern
for needed in ("CMakeLists.txt", "cmake/*", "include/*", "src/*"):
    assert needed in recipe.exports_sources, needed

for vision, optimization in ((True, True), (True, False), (False, False)):
    required = []
    recipe.options = types.SimpleNamespace(vision=vision, optimization=optimization)
    recipe.requires = lambda reference, **traits: required.append(reference.split("/")[0])
    recipe.requirements()
    assert ("opencv" in required) == vision and ("ceres-solver" in required) == optimization
    recipe.cpp_info = Component()
    recipe.cpp_info.components = collections.defaultdict(Component)
    recipe.package_info()
    names = {c.properties["cmake_target_name"] for c in recipe.cpp_info.components.values()}
    expected = {"hmcdyn::core"} | ({"hmcdyn::vision"} if vision else set())
    expected |= {"hmcdyn::optimization"} if optimization else set()
    assert names == expected, names
    for component in recipe.cpp_info.components.values():
        for requirement in component.requires:
            package = requirement.split("::")[0]
            assert package in required or package in recipe.cpp_info.components, requirement

test_package = os.path.join(source, "test_package")
compile(open(os.path.join(test_package, "conanfile.py"), encoding="utf-8").read(), "test", "exec")
assert os.path.exists(os.path.join(source, "tests", "consumers", "core", "main.cpp"))
print("the recipe and its version", recipe.version, "hold together")
