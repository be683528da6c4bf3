# SPDX-License-Identifier: MIT
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
verisim_folder(scene verisim_dem verisim_shape yaml-cpp nlohmann_json::nlohmann_json)
