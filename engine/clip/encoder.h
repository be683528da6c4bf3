// SPDX-License-Identifier: MIT
// Pictures to an mp4 file: H.264 by libx264, in process. The only file that knows the encoder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace verisim::clip {

/// kStimulus: near-lossless, what people rate. kMaster: lossless, for archives and re-encoding;
/// few browsers play it. kPreview: fast.
enum class Profile { kStimulus, kMaster, kPreview };

/// The profile called "stimulus", "master" or "preview"; none if unknown.
std::optional<Profile> profile(std::string_view name);

struct EncoderOptions {
  int width = 1280, height = 720;  // px, even
  double frame_rate_hz = 60;
  Profile profile = Profile::kStimulus;
};

/// Writes under a temporary name beside `path` and takes its name at finish(); a clip that is
/// there is whole. The same pictures and options give the same bytes. Any failure throws
/// ClipError, and the temporary file is removed when the encoder goes.
class Encoder {
 public:
  Encoder(std::filesystem::path path, const EncoderOptions& options);
  ~Encoder();
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  /// Adds one picture: RGBA, rows from the bottom up, as the renderer gives them.
  void add(std::span<const std::uint8_t> rgba);
  /// Flushes, closes, and renames; the last call.
  void finish();

  /// What was asked of the encoder, for the clip's record.
  const std::vector<std::pair<std::string, std::string>>& settings() const;
  /// The name that the file has until finish().
  const std::filesystem::path& temporary_path() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace verisim::clip
