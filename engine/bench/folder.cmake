# SPDX-License-Identifier: MIT
add_executable(bench_packed_spheres bench/packed_spheres.cpp)
target_link_libraries(bench_packed_spheres PRIVATE verisim_dem)
add_executable(bench_grid_choices bench/grid_choices.cpp)
target_link_libraries(bench_grid_choices PRIVATE verisim_shape)
