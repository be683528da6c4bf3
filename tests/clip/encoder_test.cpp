// SPDX-License-Identifier: MIT
// A clip is there whole or not at all.
#include "clip/encoder.h"

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <csignal>
#include <random>
#include <vector>

#include "clip/clip_error.h"
#include "clip/decode.h"
#include "clip/frame_queue.h"
#include "temporary_folder.h"

namespace verisim::clip {
namespace {

const EncoderOptions kSmall{.width = 128, .height = 64};

std::vector<std::uint8_t> noise(unsigned seed) {  // hard to compress: fills the file's buffers
  std::mt19937 rng(seed);
  std::vector<std::uint8_t> rgba(128 * 64 * 4);
  for (std::uint8_t& byte : rgba) byte = static_cast<std::uint8_t>(rng());
  return rgba;
}

/// What the encoder says when its disk is full.
std::string error_on_full_disk(const std::filesystem::path& path, bool is_aside) {
  // The temporary name leads to a device that is always full.
  const std::filesystem::path temporary = Encoder(path, kSmall).temporary_path();
  std::filesystem::create_symlink("/dev/full", temporary);
  try {
    Encoder encoder(path, kSmall);
    if (is_aside) {
      FrameQueue queue(encoder);
      for (unsigned i = 0; i < 100; ++i) {
        queue.take_buffer(noise(0).size());
        queue.push(noise(i));
      }
      queue.drain();
    } else {
      for (unsigned i = 0; i < 100; ++i) encoder.add(noise(i));
    }
    encoder.finish();
  } catch (const ClipError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("a_clip_takes_its_name_when_it_is_whole") {
  const TemporaryFolder folder;
  Encoder encoder(folder / "clip.mp4", kSmall);
  for (unsigned i = 0; i < 3; ++i) encoder.add(noise(i));
  CHECK(!std::filesystem::exists(folder / "clip.mp4"));
  CHECK(std::filesystem::exists(encoder.temporary_path()));
  CHECK(encoder.temporary_path().parent_path() == folder.path());
  encoder.finish();
  CHECK(!std::filesystem::exists(encoder.temporary_path()));
  CHECK(decode_clip(folder / "clip.mp4", [](int, const Picture&) {}).num_frames == 3);
}

TEST_CASE("an_unfinished_clip_leaves_nothing") {
  const TemporaryFolder folder;
  {
    Encoder encoder(folder / "clip.mp4", kSmall);
    encoder.add(noise(1));
  }
  CHECK(folder.is_empty());
}

TEST_CASE("a_full_disk_is_reported_and_leaves_nothing") {
  for (const bool is_aside : {false, true}) {
    const TemporaryFolder folder;
    const std::string error = error_on_full_disk(folder / "clip.mp4", is_aside);
    CHECK(error.find("clip.mp4") != std::string::npos);
    CHECK(error.find("No space left on device") != std::string::npos);
    CHECK(error.find("hint:") != std::string::npos);
    CHECK(folder.is_empty());
  }
}

TEST_CASE("a_write_that_fails_at_the_very_end_is_reported") {
  // So few bytes stay in a buffer until the clip is finished; a limit on file sizes stops them.
  const TemporaryFolder folder;
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  {
    Encoder encoder(folder / "clip.mp4", kSmall);
    encoder.add(std::vector<std::uint8_t>(128 * 64 * 4));
    const rlimit limit{200, before.rlim_max};  // bytes
    setrlimit(RLIMIT_FSIZE, &limit);
    CHECK_THROWS_WITH_AS(encoder.finish(), doctest::Contains("File too large"), ClipError);
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  CHECK(folder.is_empty());
}

TEST_CASE("a_clip_cannot_be_made_in_a_folder_that_is_not_there") {
  CHECK_THROWS_WITH_AS(Encoder("/nowhere/clip.mp4", kSmall),
                       doctest::Contains("No such file or directory"), ClipError);
}

TEST_CASE("odd_sizes_are_refused_with_the_next_even_one") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH_AS(Encoder(folder / "clip.mp4", {.width = 1281, .height = 720}),
                       doctest::Contains("1282x720"), ClipError);
  CHECK_THROWS_AS(Encoder(folder / "clip.mp4", {.width = 8, .height = 8}), ClipError);
  CHECK_THROWS_AS(Encoder(folder / "clip.mp4", {.frame_rate_hz = 0}), ClipError);
  CHECK(folder.is_empty());
}

TEST_CASE("profiles_have_names") {
  CHECK(profile("stimulus") == Profile::kStimulus);
  CHECK(profile("master") == Profile::kMaster);
  CHECK(profile("preview") == Profile::kPreview);
  CHECK(!profile("film"));
}

TEST_CASE("what_is_no_clip_cannot_be_decoded") {
  const TemporaryFolder folder;
  CHECK_THROWS_AS(frames_sha256(folder / "missing.mp4"), ClipError);
  std::FILE* file = std::fopen((folder / "text.mp4").c_str(), "w");
  std::fputs("this is no clip", file);
  std::fclose(file);
  CHECK_THROWS_AS(frames_sha256(folder / "text.mp4"), ClipError);
}

}  // namespace verisim::clip
