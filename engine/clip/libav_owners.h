// SPDX-License-Identifier: MIT
// Owners of libav objects, its error codes as text, and its silence.
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include <array>
#include <memory>
#include <string>

namespace verisim::clip {

struct LibavDelete {
  void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
  void operator()(AVFrame* p) const { av_frame_free(&p); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
};
template <typename T>
using LibavPtr = std::unique_ptr<T, LibavDelete>;

/// Every failure reaches the reader as an exception; libav's own chatter on stderr stays out.
inline void silence_libav() { av_log_set_level(AV_LOG_FATAL); }

inline std::string libav_error(int code) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(code, text.data(), text.size());
  return text.data();
}

}  // namespace verisim::clip
