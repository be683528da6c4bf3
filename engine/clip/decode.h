// SPDX-License-Identifier: MIT
// Reads clips back: frames, and hashes that say whether two clips show the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace verisim::clip {

/// A decoded picture: 8-bit 4:2:0 planes without padding, top row first.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> y, u, v;
};

/// What a clip's file says about itself.
struct ClipFacts {
  int width = 0, height = 0;
  int num_frames = 0;
  double frame_rate_hz = 0;
  std::string pixel_format, primaries, transfer, matrix, range;  // as libav names them
};

/// Decodes all frames in order of showing. Throws ClipError if the file cannot be read whole.
ClipFacts decode_clip(const std::filesystem::path& path,
                      const std::function<void(int index, const Picture& picture)>& use);

/// sha256, in hexadecimal, over the decoded planes of all frames: equal for equal pictures,
/// whatever the file around them.
std::string frames_sha256(const std::filesystem::path& path);

/// sha256 of a file's bytes, in hexadecimal.
std::string file_sha256(const std::filesystem::path& path);

}  // namespace verisim::clip
