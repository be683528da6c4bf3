// SPDX-License-Identifier: MIT
#include "python/module.h"

#include "clip/clip_error.h"
#include "render/render_error.h"
#include "scene/problem.h"
#include "shape/fill_particles.h"
#include "shape/mesh_error.h"

namespace nb = nanobind;

// Parts are added in order of use: exceptions first, then what raises them.
NB_MODULE(_engine, m) {
  m.doc() = "The Verisim engine. Use it through verisim.engine.";
  static const nb::exception<std::runtime_error> engine_error(m, "EngineError", PyExc_RuntimeError);
  nb::exception<verisim::scene::SceneError>(m, "SceneError", PyExc_ValueError);
  nb::exception<verisim::shape::MeshError>(m, "MeshError", PyExc_ValueError);
  nb::exception<verisim::shape::FillError>(m, "FillError", m.attr("MeshError").ptr());
  nb::exception<verisim::clip::ClipError>(m, "ClipError", m.attr("EngineError").ptr());
  nb::exception<verisim::render::RenderError>(m, "RenderError", m.attr("EngineError").ptr());
  verisim::python::bind_scene(m);
  verisim::python::bind_run(m);
  verisim::python::bind_shape(m);
  verisim::python::bind_clip(m);
#ifdef VERISIM_VIEW
  verisim::python::bind_view(m);
#endif
}
