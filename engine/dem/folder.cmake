# SPDX-License-Identifier: MIT
verisim_folder(dem Eigen3::Eigen Threads::Threads)
