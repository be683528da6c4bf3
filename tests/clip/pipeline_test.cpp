// SPDX-License-Identifier: MIT
// A clip decodes to the frames that were rendered, says what it is, and is the same each time.
#include "clip/pipeline.h"

#include <doctest/doctest.h>

#include <cmath>
#include <span>

#include "clip/clip_error.h"
#include "clip/colour.h"
#include "clip/decode.h"
#include "render/renderer.h"
#include "short_clip.h"
#include "temporary_folder.h"

namespace verisim::clip {
namespace {

constexpr int kWidth = 320, kHeight = 180;

ClipOptions options_for(const std::filesystem::path& path) {
  ClipOptions options;
  options.path = path;
  options.encoder.width = kWidth;
  options.encoder.height = kHeight;
  return options;
}

/// The frames that the encoder was given, as planes.
std::vector<Picture> rendered_pictures(const ShortClip& clip) {
  const auto context = render::make_context(render::ContextKind::kAuto, 0);
  render::Renderer renderer(context->get_proc_address(), clip.scene, kWidth, kHeight);
  renderer.fit_light(clip.log.poses);
  std::vector<Picture> pictures;
  std::vector<std::uint8_t> rgba(4 * kWidth * kHeight);
  for (std::size_t i = 0; i < clip.log.num_times(); ++i) {
    renderer.draw(std::span(clip.log.poses).subspan(i * 2, 2));
    renderer.read_pixels(rgba);
    Picture picture{kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight),
                    std::vector<std::uint8_t>(kWidth * kHeight / 4),
                    std::vector<std::uint8_t>(kWidth * kHeight / 4)};
    rgba_to_i420(
        rgba, kWidth, kHeight,
        {picture.y.data(), picture.u.data(), picture.v.data(), kWidth, kWidth / 2, kWidth / 2});
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

struct Error {
  double sum = 0, squares = 0, count = 0;
  void add(const std::vector<std::uint8_t>& decoded, const std::vector<std::uint8_t>& wanted) {
    for (std::size_t i = 0; i < decoded.size(); ++i) {
      const double difference = static_cast<double>(decoded[i]) - wanted[i];
      sum += difference;
      squares += difference * difference;
    }
    count += static_cast<double>(decoded.size());
  }
  double bias() const { return std::abs(sum / count); }
  double psnr_db() const { return 10 * std::log10(255 * 255 * count / squares); }
};

}  // namespace

TEST_CASE("a_stimulus_shows_the_rendered_frames") {
  const TemporaryFolder folder;
  const ShortClip clip = short_clip(30);
  const ClipInfo info = render_clip(clip.scene, clip.log, options_for(folder / "clip.mp4"), {});
  const std::vector<Picture> rendered = rendered_pictures(clip);
  Error y, u, v;
  const ClipFacts facts = decode_clip(folder / "clip.mp4", [&](int i, const Picture& picture) {
    y.add(picture.y, rendered[i].y);
    u.add(picture.u, rendered[i].u);
    v.add(picture.v, rendered[i].v);
  });
  CHECK(facts.num_frames == 30);
  CHECK(info.num_frames == 30);
  CHECK(info.num_clipped_pixels == 0);
  CHECK(y.psnr_db() >= 45);                                       // measured 54.3 dB
  CHECK(u.psnr_db() >= 45);                                       // measured 60.7 dB
  CHECK(v.psnr_db() >= 45);                                       // measured 60.7 dB
  for (const Error& plane : {y, u, v}) CHECK(plane.bias() <= 1);  // measured 0.015
}

TEST_CASE("a_master_is_lossless") {
  const TemporaryFolder folder;
  const ShortClip clip = short_clip(4);
  ClipOptions options = options_for(folder / "clip.mp4");
  options.encoder.profile = Profile::kMaster;
  render_clip(clip.scene, clip.log, options, {});
  const std::vector<Picture> rendered = rendered_pictures(clip);
  decode_clip(folder / "clip.mp4", [&](int i, const Picture& picture) {
    CHECK(picture.y == rendered[i].y);
    CHECK(picture.u == rendered[i].u);
    CHECK(picture.v == rendered[i].v);
  });
}

TEST_CASE("a_clip_says_what_it_is") {
  const TemporaryFolder folder;
  const ShortClip clip = short_clip(5);
  ClipOptions options = options_for(folder / "clip.mp4");
  for (const double rate : {60.0, 24.0, 30000.0 / 1001}) {
    options.encoder.frame_rate_hz = rate;
    const ClipInfo info = render_clip(clip.scene, clip.log, options, {});
    const ClipFacts facts = decode_clip(folder / "clip.mp4", [](int, const Picture&) {});
    CHECK(facts.num_frames == 5);
    CHECK(facts.frame_rate_hz == doctest::Approx(rate).epsilon(1e-12));
    CHECK(facts.width == kWidth);
    CHECK(facts.height == kHeight);
    CHECK(facts.pixel_format == "yuv420p");
    CHECK(facts.primaries == "bt709");
    CHECK(facts.transfer == "bt709");
    CHECK(facts.matrix == "bt709");
    CHECK(facts.range == "tv");
    CHECK(info.backend == "egl-device");
    CHECK(info.driver.find("llvmpipe") != std::string::npos);
  }
}

TEST_CASE("the_same_input_gives_the_same_bytes") {
  const TemporaryFolder folder;
  const ShortClip clip = short_clip(12);
  const ClipInfo first = render_clip(clip.scene, clip.log, options_for(folder / "a.mp4"), {});
  ClipOptions aside = options_for(folder / "b.mp4");
  aside.encode_aside = true;
  aside.raster_threads = 2;
  aside.context = render::ContextKind::kOsmesa;
  const ClipInfo second = render_clip(clip.scene, clip.log, aside, {});
  CHECK(first.video_sha256 == second.video_sha256);
  CHECK(first.frames_sha256 == second.frames_sha256);
  ShortClip other = short_clip(12);
  other.log.poses.back().position.x() += 0.05;
  const ClipInfo third = render_clip(other.scene, other.log, options_for(folder / "c.mp4"), {});
  CHECK(third.video_sha256 != first.video_sha256);
  CHECK(third.frames_sha256 != first.frames_sha256);
}

TEST_CASE("hashes_are_sha256") {
  const TemporaryFolder folder;
  std::FILE* file = std::fopen((folder / "abc").c_str(), "w");
  std::fputs("abc", file);
  std::fclose(file);
  // FIPS 180-2, appendix B.1
  CHECK(file_sha256(folder / "abc") ==
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST_CASE("progress_counts_frames_and_can_stop_the_work") {
  const TemporaryFolder folder;
  const ShortClip clip = short_clip(6);
  std::vector<int> seen;
  render_clip(clip.scene, clip.log, options_for(folder / "clip.mp4"), [&](int done, int total) {
    CHECK(total == 6);
    seen.push_back(done);
  });
  CHECK(seen == std::vector<int>{1, 2, 3, 4, 5, 6});
  std::filesystem::remove(folder / "clip.mp4");
  for (const bool aside : {false, true}) {
    ClipOptions options = options_for(folder / "clip.mp4");
    options.encode_aside = aside;
    CHECK_THROWS_AS(render_clip(clip.scene, clip.log, options,
                                [](int done, int) {
                                  if (done == 3) throw std::runtime_error("stop");
                                }),
                    std::runtime_error);
    CHECK(folder.is_empty());
  }
}

TEST_CASE("poses_of_other_bodies_are_refused") {
  const TemporaryFolder folder;
  ShortClip clip = short_clip(3);
  std::swap(clip.log.names[0], clip.log.names[1]);
  CHECK_THROWS_WITH_AS(render_clip(clip.scene, clip.log, options_for(folder / "clip.mp4"), {}),
                       doctest::Contains("\"ball\" in the pose log"), ClipError);
  clip.log.times.clear();
  CHECK_THROWS_AS(render_clip(clip.scene, clip.log, options_for(folder / "clip.mp4"), {}),
                  ClipError);
  CHECK(folder.is_empty());
}

}  // namespace verisim::clip
