# SPDX-License-Identifier: MIT
verisim_folder(render verisim_dem ${CMAKE_DL_LIBS})
