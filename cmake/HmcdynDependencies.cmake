# SPDX-License-Identifier: BSD-3-Clause
# Dependencies of the library itself; examples, tests and benches ask for theirs where they use them.

find_package(Eigen3 3.3 REQUIRED NO_MODULE)
find_package(nanoflann 1.3 REQUIRED)
find_package(OpenCV 4.2 REQUIRED COMPONENTS core imgproc video calib3d)
find_package(Ceres REQUIRED)
