// SPDX-License-Identifier: MIT
// Draws every frame of a clip and passes it to the encoder.
#include "clip/pipeline.h"

#include <optional>
#include <span>

#include "clip/clip_error.h"
#include "clip/decode.h"
#include "clip/frame_queue.h"
#include "clip/vector_clones.h"
#include "render/renderer.h"

namespace verisim::clip {
namespace {

void check_bodies(const render::VisualScene& scene, const dem::PoseLog& log) {
  if (log.num_times() == 0) throw ClipError("the pose log holds no times: nothing to show");
  if (log.num_bodies() != scene.bodies.size()) {
    throw ClipError("the pose log has " + std::to_string(log.num_bodies()) + " bodies, the scene " +
                    std::to_string(scene.bodies.size()));
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (log.names[b] != scene.bodies[b].name) {
      throw ClipError("body " + std::to_string(b) + " is \"" + log.names[b] +
                      "\" in the pose log and \"" + scene.bodies[b].name + "\" in the scene");
    }
  }
}

VERISIM_VECTOR_CLONES
std::int64_t count_clipped_pixels(std::span<const std::uint8_t> rgba) {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < rgba.size(); i += 4) {
    // Without branches, so that the loop becomes vector code.
    count += (rgba[i] == 255) | (rgba[i + 1] == 255) | (rgba[i + 2] == 255);
  }
  return count;
}

}  // namespace

ClipInfo render_clip(const render::VisualScene& scene, const dem::PoseLog& log,
                     const ClipOptions& options,
                     const std::function<void(int done, int total)>& progress) {
  check_bodies(scene, log);
  const int width = options.encoder.width, height = options.encoder.height;
  Encoder encoder(options.path, options.encoder);
  const std::unique_ptr<render::Context> context =
      render::make_context(options.context, options.raster_threads);
  render::Renderer renderer(context->get_proc_address(), scene, width, height);
  renderer.fit_light(log.poses);

  ClipInfo info;
  const std::size_t frame_size = 4 * static_cast<std::size_t>(width) * height;
  const int num_frames = static_cast<int>(log.num_times());
  {
    std::optional<FrameQueue> queue;
    if (options.encode_aside) queue.emplace(encoder);
    std::vector<std::uint8_t> rgba(queue ? 0 : frame_size);
    for (int i = 0; i < num_frames; ++i) {
      if (queue) rgba = queue->take_buffer(frame_size);
      renderer.draw(std::span(log.poses).subspan(i * log.num_bodies(), log.num_bodies()));
      renderer.read_pixels(rgba);
      info.num_clipped_pixels += count_clipped_pixels(rgba);
      if (queue) {
        queue->push(std::move(rgba));
      } else {
        encoder.add(rgba);
      }
      if (progress) progress(i + 1, num_frames);
    }
    if (queue) queue->drain();
  }
  encoder.finish();

  info.num_frames = num_frames;
  info.width = width;
  info.height = height;
  info.encoder_settings = encoder.settings();
  info.video_sha256 = file_sha256(options.path);
  info.frames_sha256 = frames_sha256(options.path);
  info.backend = context->name();
  info.driver = renderer.driver();
  return info;
}

}  // namespace verisim::clip
