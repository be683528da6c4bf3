# SPDX-License-Identifier: MIT
find_package(assimp REQUIRED)
verisim_folder(shape Eigen3::Eigen assimp::assimp)
