// SPDX-License-Identifier: MIT
// From a pose log and a look to a finished clip.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "clip/encoder.h"
#include "dem/pose_log.h"
#include "render/context.h"
#include "render/visual_scene.h"

namespace verisim::clip {

struct ClipOptions {
  std::filesystem::path path;  // the mp4 to make
  EncoderOptions encoder;
  render::ContextKind context = render::ContextKind::kAuto;
  int raster_threads = 0;     // 0 = the calling thread; best where each core makes its own clip
  bool encode_aside = false;  // encode on a thread of its own; best for one clip alone
};

struct ClipInfo {
  int num_frames = 0;
  int width = 0, height = 0;  // px
  std::vector<std::pair<std::string, std::string>> encoder_settings;
  std::string video_sha256;             // of the file
  std::string frames_sha256;            // of the decoded pictures
  std::string backend;                  // "egl-device", ...
  std::string driver;                   // what OpenGL calls itself
  std::int64_t num_clipped_pixels = 0;  // with a channel at 255, over all frames
};

/// Draws and encodes one frame per time of the log: frame i shows time i / frame_rate_hz.
/// progress: called after each frame with the frames done and in all; may be empty; may throw to
/// stop. Throws RenderError or ClipError; the file exists only if all went well.
/// The poses' bodies and the look's must be the same, in the same order.
ClipInfo render_clip(const render::VisualScene& scene, const dem::PoseLog& log,
                     const ClipOptions& options,
                     const std::function<void(int done, int total)>& progress);

}  // namespace verisim::clip
