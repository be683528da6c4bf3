# SPDX-License-Identifier: MIT
pkg_check_modules(libav REQUIRED IMPORTED_TARGET libavcodec libavformat libavutil)
verisim_folder(clip verisim_scene verisim_render PkgConfig::libav)
