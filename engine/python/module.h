// SPDX-License-Identifier: MIT
// The parts of the Python module, one file each.
#pragma once

#include <nanobind/nanobind.h>

namespace verisim::python {

void bind_scene(nanobind::module_& m);  // Scene, load_scene, scene_schema
void bind_run(nanobind::module_& m);    // simulate
void bind_shape(nanobind::module_& m);  // inspect_shape
void bind_clip(nanobind::module_& m);   // render_clip
void bind_view(nanobind::module_& m);   // view

}  // namespace verisim::python
