// SPDX-License-Identifier: MIT
// Decoding by libav, hashing by libavutil.
#include "clip/decode.h"

#include <fstream>
#include <span>

#include "clip/clip_error.h"
#include "clip/libav_owners.h"

extern "C" {
#include <libavutil/mem.h>
#include <libavutil/pixdesc.h>
#include <libavutil/sha.h>
}

namespace verisim::clip {
namespace {

class Sha256 {
 public:
  Sha256() : state_(av_sha_alloc()) { av_sha_init(state_, 256); }
  ~Sha256() { av_free(state_); }
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;
  void update(std::span<const std::uint8_t> bytes) {
    av_sha_update(state_, bytes.data(), bytes.size());
  }
  std::string hexadecimal() {
    std::array<std::uint8_t, 32> digest{};
    av_sha_final(state_, digest.data());
    std::string text;
    for (const std::uint8_t byte : digest) {
      text += "0123456789abcdef"[byte >> 4];
      text += "0123456789abcdef"[byte & 15];
    }
    return text;
  }

 private:
  AVSHA* state_;
};

class Decoder {
 public:
  explicit Decoder(const std::filesystem::path& path) : path_(path) {
    silence_libav();
    check(avformat_open_input(&file_, path.c_str(), nullptr, nullptr));
    try {
      open_video();
    } catch (...) {
      avformat_close_input(&file_);
      throw;
    }
  }
  ~Decoder() { avformat_close_input(&file_); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  ClipFacts run(const std::function<void(int, const Picture&)>& use) {
    LibavPtr<AVPacket> packet(av_packet_alloc());
    ClipFacts facts = read_facts();
    int code = 0;
    while ((code = av_read_frame(file_, packet.get())) >= 0) {
      if (packet->stream_index == stream_) {
        check(avcodec_send_packet(codec_.get(), packet.get()));
        receive(facts.num_frames, use);
      }
      av_packet_unref(packet.get());
    }
    if (code != AVERROR_EOF) check(code);
    check(avcodec_send_packet(codec_.get(), nullptr));
    receive(facts.num_frames, use);
    return facts;
  }

 private:
  void check(int code) const {
    if (code < 0) throw ClipError(path_.string() + ": cannot read clip: " + libav_error(code));
  }

  void open_video() {
    check(avformat_find_stream_info(file_, nullptr));
    const AVCodec* decoder = nullptr;
    stream_ = av_find_best_stream(file_, AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
    check(stream_);
    codec_.reset(avcodec_alloc_context3(decoder));
    check(avcodec_parameters_to_context(codec_.get(), file_->streams[stream_]->codecpar));
    codec_->thread_count = 1;
    check(avcodec_open2(codec_.get(), decoder, nullptr));
    if (codec_->pix_fmt != AV_PIX_FMT_YUV420P) {
      throw ClipError(path_.string() + ": only 8-bit 4:2:0 clips can be compared");
    }
  }

  ClipFacts read_facts() const {
    const AVStream* stream = file_->streams[stream_];
    const auto text = [](const char* name) { return std::string(name ? name : "unknown"); };
    ClipFacts facts;
    facts.width = codec_->width;
    facts.height = codec_->height;
    facts.frame_rate_hz = av_q2d(stream->avg_frame_rate);
    facts.pixel_format = text(av_get_pix_fmt_name(codec_->pix_fmt));
    facts.primaries = text(av_color_primaries_name(codec_->color_primaries));
    facts.transfer = text(av_color_transfer_name(codec_->color_trc));
    facts.matrix = text(av_color_space_name(codec_->colorspace));
    facts.range = text(av_color_range_name(codec_->color_range));
    return facts;
  }

  void receive(int& num_frames, const std::function<void(int, const Picture&)>& use) {
    for (;;) {
      const int code = avcodec_receive_frame(codec_.get(), frame_.get());
      if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return;
      check(code);
      picture_.width = frame_->width;
      picture_.height = frame_->height;
      copy_plane(0, frame_->width, frame_->height, picture_.y);
      copy_plane(1, (frame_->width + 1) / 2, (frame_->height + 1) / 2, picture_.u);
      copy_plane(2, (frame_->width + 1) / 2, (frame_->height + 1) / 2, picture_.v);
      use(num_frames++, picture_);
    }
  }

  void copy_plane(int plane, int width, int height, std::vector<std::uint8_t>& out) const {
    out.resize(static_cast<std::size_t>(width) * height);
    for (int row = 0; row < height; ++row) {
      const std::uint8_t* source = frame_->data[plane] + row * frame_->linesize[plane];
      std::copy(source, source + width, out.begin() + static_cast<std::ptrdiff_t>(row) * width);
    }
  }

  std::filesystem::path path_;
  AVFormatContext* file_ = nullptr;
  int stream_ = -1;
  LibavPtr<AVCodecContext> codec_;
  LibavPtr<AVFrame> frame_{av_frame_alloc()};
  Picture picture_;
};

}  // namespace

ClipFacts decode_clip(const std::filesystem::path& path,
                      const std::function<void(int, const Picture&)>& use) {
  return Decoder(path).run(use);
}

std::string frames_sha256(const std::filesystem::path& path) {
  Sha256 sha;
  decode_clip(path, [&sha](int, const Picture& picture) {
    sha.update(picture.y);
    sha.update(picture.u);
    sha.update(picture.v);
  });
  return sha.hexadecimal();
}

std::string file_sha256(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw ClipError(path.string() + ": cannot open");
  Sha256 sha;
  std::vector<char> block(1 << 16);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0) {
    sha.update({reinterpret_cast<const std::uint8_t*>(block.data()),
                static_cast<std::size_t>(file.gcount())});
  }
  if (file.bad()) throw ClipError(path.string() + ": cannot read");
  return sha.hexadecimal();
}

}  // namespace verisim::clip
