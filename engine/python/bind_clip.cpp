// SPDX-License-Identifier: MIT
// Clips in Python: poses in, an mp4 and its facts out, the GIL released while drawing.
#include <nanobind/stl/string.h>

#include "clip/clip_error.h"
#include "clip/pipeline.h"
#include "clip/visualise.h"
#include "python/module.h"
#include "python/pose_arrays.h"

namespace nb = nanobind;

namespace verisim::python {
namespace {

nb::dict info_dict(const clip::ClipInfo& info, const clip::EncoderOptions& encoder) {
  nb::dict settings;
  for (const auto& [key, value] : info.encoder_settings) settings[key.c_str()] = value;
  nb::dict render;
  render["backend"] = info.backend;
  render["driver"] = info.driver;
  render["samples"] = 4;
  render["num_clipped_pixels"] = info.num_clipped_pixels;
  nb::dict d;
  d["frame_rate_hz"] = encoder.frame_rate_hz;
  d["num_frames"] = info.num_frames;
  d["width_px"] = info.width;
  d["height_px"] = info.height;
  d["render"] = render;
  d["encoder"] = settings;
  d["video_sha256"] = info.video_sha256;
  d["frames_sha256"] = info.frames_sha256;
  return d;
}

nb::typed<nb::dict, nb::str, nb::object> render_clip(
    const scene::Scene& scene, const TimeArray& times, const PoseArray& positions,
    const PoseArray& orientations, const std::string& output, int width, int height,
    const std::string& profile, const std::string& gl, const std::string& show, int raster_threads,
    const nb::object& progress) {
  clip::ClipOptions options;
  options.path = output;
  options.encoder.width = width;
  options.encoder.height = height;
  options.encoder.frame_rate_hz = scene.frame_rate;
  const auto chosen_profile = clip::profile(profile);
  const auto chosen_context = render::context_kind(gl);
  if (!chosen_profile) throw clip::ClipError("profile " + profile + ": no such profile");
  if (!chosen_context) throw clip::ClipError("gl " + gl + ": no such backend");
  options.encoder.profile = *chosen_profile;
  options.context = *chosen_context;
  options.raster_threads = raster_threads;
  options.encode_aside = raster_threads > 0;
  const dem::PoseLog log = pose_log_of(scene, times, positions, orientations);
  const auto report = [&](int done, int total) {
    const nb::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (!progress.is_none()) progress(done, total);
  };
  clip::ClipInfo info;
  {
    const nb::gil_scoped_release release;
    const auto part = show == "particles" ? clip::Show::kParticles : clip::Show::kMesh;
    const render::VisualScene look = clip::visualise(scene, scene::build_world(scene), part);
    info = clip::render_clip(look, log, options, report);
  }
  return info_dict(info, options.encoder);
}

}  // namespace

void bind_clip(nb::module_& m) {
  m.def("render_clip", &render_clip, nb::arg("scene"), nb::arg("time_s"), nb::arg("position_m"),
        nb::arg("orientation_wxyz"), nb::arg("output"), nb::arg("width"), nb::arg("height"),
        nb::arg("profile"), nb::arg("gl"), nb::arg("show"), nb::arg("raster_threads"),
        nb::arg("progress").none());
}

}  // namespace verisim::python
