// SPDX-License-Identifier: MIT
// What the engine makes of a mesh, as a dictionary.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/module.h"
#include "shape/check_mesh.h"
#include "shape/extents.h"
#include "shape/fill_particles.h"
#include "shape/load_mesh.h"
#include "shape/mass_properties.h"

namespace nb = nanobind;

namespace verisim::python {
namespace {

constexpr double kParticlesPerExtent = 4;

nb::list list_of(const Eigen::Vector3d& v) {
  nb::list list;
  for (double value : v) list.append(value);
  return list;
}

nb::typed<nb::dict, nb::str, nb::object> inspect_shape(const std::string& file,
                                                       std::optional<double> particle_size) {
  const shape::Mesh mesh = shape::load_mesh(file);
  const std::vector<shape::MeshProblem> problems = shape::check_mesh(mesh);
  nb::list messages;
  bool closed = true;
  for (const shape::MeshProblem& problem : problems) {
    messages.append(problem.message);
    closed = closed && !problem.code.ends_with("_edge") && problem.code != "mismatched_winding" &&
             problem.code != "no_triangles" && problem.code != "bad_index";
  }
  nb::dict report;
  report["closed"] = closed;
  report["num_triangles"] = mesh.triangles.size();
  report["volume_m3"] = nb::none();
  report["center_of_mass_m"] = nb::none();
  report["inertia_m5"] = nb::none();
  report["num_particles"] = nb::none();
  if (problems.empty()) {
    const shape::MassProperties mass = shape::mesh_mass_properties(mesh);
    nb::list rows;
    for (int i = 0; i < 3; ++i) rows.append(list_of(mass.inertia.row(i).transpose()));
    report["volume_m3"] = mass.volume;
    report["center_of_mass_m"] = list_of(mass.center_of_mass);
    report["inertia_m5"] = rows;
    const double size = particle_size.value_or(shape::smallest_extent(mesh) / kParticlesPerExtent);
    report["num_particles"] = shape::fill_mesh(mesh, size).centers.size();
  }
  report["problems"] = messages;
  return report;
}

}  // namespace

void bind_shape(nb::module_& m) {
  m.def("inspect_shape", &inspect_shape, nb::arg("file"), nb::arg("particle_size_m").none());
}

}  // namespace verisim::python
