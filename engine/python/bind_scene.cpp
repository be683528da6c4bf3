// SPDX-License-Identifier: MIT
// Scenes in Python: load, ask, and hand over the poses of prescribed bodies.
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/module.h"
#include "scene/load_scene.h"
#include "scene/schema.h"

namespace nb = nanobind;

namespace verisim::python {
namespace {

using Times = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Rows = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

std::vector<std::string> body_names(const scene::Scene& scene) {
  std::vector<std::string> names;
  for (const scene::Body& body : scene.bodies) names.push_back(body.name);
  return names;
}

std::vector<std::pair<std::string, std::string>> prescribed_files(const scene::Scene& scene) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const scene::Body& body : scene.bodies) {
    if (body.motion == dem::Motion::kPrescribed) {
      files.emplace_back(body.name, body.poses_file.string());
    }
  }
  return files;
}

void set_prescribed(scene::Scene& scene, const std::string& name, const Times& times,
                    const Rows& positions, const Rows& orientations, const Rows& velocities) {
  for (scene::Body& body : scene.bodies) {
    if (body.name != name) continue;
    body.prescribed = {};
    for (std::size_t i = 0; i < times.shape(0); ++i) {
      dem::Pose pose;
      pose.position = {positions(i, 0), positions(i, 1), positions(i, 2)};
      pose.orientation = Eigen::Quaterniond(orientations(i, 0), orientations(i, 1),
                                            orientations(i, 2), orientations(i, 3))
                             .normalized();
      pose.linear_velocity = {velocities(i, 0), velocities(i, 1), velocities(i, 2)};
      body.prescribed.times.push_back(times(i));
      body.prescribed.poses.push_back(pose);
    }
    body.initial = body.prescribed.poses.front();
  }
}

}  // namespace

void bind_scene(nb::module_& m) {
  nb::class_<scene::Scene>(m, "Scene")
      .def_prop_ro("name", [](const scene::Scene& s) { return s.name; })
      .def_prop_ro(
          "method",
          [](const scene::Scene& s) { return std::string(dem::to_string(s.physics.method)); })
      .def_ro("duration_s", &scene::Scene::duration)
      .def_ro("frame_rate_hz", &scene::Scene::frame_rate)
      .def_ro("resolved_yaml", &scene::Scene::resolved_yaml)
      .def_prop_ro("body_names", &body_names)
      .def("prescribed_files", &prescribed_files)
      .def("set_prescribed", &set_prescribed, nb::arg("body"), nb::arg("time_s"),
           nb::arg("position_m"), nb::arg("orientation_wxyz"), nb::arg("linear_velocity_m_s"));
  m.def(
      "load_scene",
      [](const std::string& file, const std::vector<std::string>& overrides) {
        return scene::load_scene(file, overrides);
      },
      nb::arg("file"), nb::arg("overrides"));
  m.def("scene_schema", &scene::scene_schema, "JSON Schema of scene files, as text.");
}

}  // namespace verisim::python
