# SPDX-License-Identifier: MIT
add_executable(bench_packed_spheres bench/packed_spheres.cpp)
target_link_libraries(bench_packed_spheres PRIVATE verisim_dem)
