// SPDX-License-Identifier: MIT
// The window from Python: a scene, maybe poses, and the GIL released while it is open.
#ifdef VERISIM_VIEW

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/module.h"
#include "python/pose_arrays.h"
#include "view/application.h"

namespace nb = nanobind;

namespace verisim::python {
namespace {

void view_scene(const scene::Scene& scene, const std::vector<std::string>& overrides,
                const std::string& show, const std::optional<std::string>& screenshot, double after,
                const std::optional<TimeArray>& times, const std::optional<PoseArray>& positions,
                const std::optional<PoseArray>& orientations) {
  view::ViewOptions options;
  options.overrides = overrides;
  options.show = show == "particles" ? clip::Show::kParticles : clip::Show::kMesh;
  options.screenshot = screenshot.value_or("");
  options.after = after;
  if (times) options.poses = pose_log_of(scene, *times, *positions, *orientations);
  const nb::gil_scoped_release release;
  view::view(scene, options, [] {
    const nb::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
  });
}

}  // namespace

void bind_view(nb::module_& m) {
  m.def("view_scene", &view_scene, nb::arg("scene"), nb::arg("overrides"), nb::arg("show"),
        nb::arg("screenshot").none(), nb::arg("after_s"), nb::arg("time_s").none(),
        nb::arg("position_m").none(), nb::arg("orientation_wxyz").none());
}

}  // namespace verisim::python

#endif
