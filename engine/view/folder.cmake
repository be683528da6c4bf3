# SPDX-License-Identifier: MIT
# Debian's libimgui.a holds the GLFW and OpenGL 3 backends, position-independent; libstb writes PNG.
find_package(glfw3 3.3 REQUIRED)
pkg_check_modules(imgui REQUIRED IMPORTED_TARGET imgui)
verisim_folder(view verisim_clip PkgConfig::imgui glfw)
get_target_property(view_type verisim_view TYPE)
if(view_type STREQUAL "STATIC_LIBRARY")
  target_compile_definitions(verisim_view PUBLIC VERISIM_VIEW)
endif()
