# SPDX-License-Identifier: MIT
verisim_folder(dem Eigen3::Eigen Threads::Threads)
# Vectors of three doubles are written one by one; reading two at once right after stalls. Public,
# because Eigen's inline functions must be the same in every file that shares them with dem.
target_compile_definitions(verisim_dem PUBLIC EIGEN_UNALIGNED_VECTORIZE=0)
