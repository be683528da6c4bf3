// SPDX-License-Identifier: MIT
// libavcodec, libavformat and libx264, with every setting that decides the bytes pinned.
#include "clip/encoder.h"

#include <unistd.h>

#include <cmath>

#include "clip/clip_error.h"
#include "clip/colour.h"
#include "clip/libav_owners.h"

extern "C" {
#include <libavutil/opt.h>
}

namespace verisim::clip {
namespace {

struct ProfileSettings {
  const char* name;
  const char* preset;
  const char* quality_key;  // "crf": constant quality; "qp" 0: lossless
  const char* quality;
};

ProfileSettings settings_of(Profile profile) {
  // Above superfast, slower presets buy size, not quality, on flat matte scenes.
  switch (profile) {
    case Profile::kMaster:
      return {"master", "ultrafast", "qp", "0"};
    case Profile::kPreview:
      return {"preview", "ultrafast", "crf", "20"};
    default:
      return {"stimulus", "superfast", "crf", "14"};
  }
}

constexpr int kKeyframeInterval = 60;  // frames; a seek decodes at most this many
constexpr int kReorderedFrames = 2;

void check_options(const EncoderOptions& options) {
  if (options.width < 16 || options.height < 16 || options.width % 2 || options.height % 2) {
    throw ClipError("clip size is " + std::to_string(options.width) + "x" +
                    std::to_string(options.height) +
                    "; both must be even and at least 16 pixels\nhint: 4:2:0 video stores colour "
                    "once per 2x2 pixels; try " +
                    std::to_string(std::max(16, options.width + options.width % 2)) + "x" +
                    std::to_string(std::max(16, options.height + options.height % 2)));
  }
  if (!(options.frame_rate_hz >= 1 && options.frame_rate_hz <= 1000)) {
    throw ClipError("frame_rate_hz is " + std::to_string(options.frame_rate_hz) +
                    "; 1 to 1000 is allowed");
  }
}

/// Whole rates and those over 1001 (29.97 as 30000/1001) come out exact.
AVRational to_rational(double frame_rate_hz) { return av_d2q(frame_rate_hz, 60000); }

}  // namespace

std::optional<Profile> profile(std::string_view name) {
  for (const Profile candidate : {Profile::kStimulus, Profile::kMaster, Profile::kPreview}) {
    if (name == settings_of(candidate).name) return candidate;
  }
  return std::nullopt;
}

class Encoder::Impl {
 public:
  Impl(std::filesystem::path path, const EncoderOptions& options)
      : path_(std::move(path)), options_(options) {
    check_options(options);
    // Process id: two processes that make the same clip do not write into each other's file.
    temporary_ = path_;
    temporary_.replace_filename("." + path_.filename().string() + "." + std::to_string(getpid()) +
                                ".part");
    try {
      open_codec();
      open_file();
    } catch (...) {
      discard();
      throw;
    }
  }

  ~Impl() { discard(); }

  void add(std::span<const std::uint8_t> rgba) {
    check(av_frame_make_writable(frame_.get()), "cannot reuse the picture buffer");
    rgba_to_i420(rgba, options_.width, options_.height,
                 {frame_->data[0], frame_->data[1], frame_->data[2], frame_->linesize[0],
                  frame_->linesize[1], frame_->linesize[2]});
    frame_->pts = num_frames_++;
    encode(frame_.get());
  }

  void finish() {
    encode(nullptr);
    check(av_write_trailer(file_), "cannot finish");
    check(file_->pb->error, "cannot write");
    check(avio_closep(&file_->pb), "cannot close");
    std::error_code error;
    std::filesystem::rename(temporary_, path_, error);
    if (error) fail("cannot rename " + temporary_.string(), error.message());
    is_finished_ = true;
  }

  const std::vector<std::pair<std::string, std::string>>& settings() const { return settings_; }
  const std::filesystem::path& temporary_path() const { return temporary_; }

 private:
  [[noreturn]] void fail(const std::string& action, const std::string& cause) const {
    throw ClipError(path_.string() + ": " + action + ": " + cause +
                    "\nhint: check free space and permissions of the folder; nothing was kept");
  }
  void check(int code, const char* action) const {
    if (code < 0) fail(action, libav_error(code));
  }

  void set_option(const char* name, const char* value) {
    check(av_opt_set(codec_->priv_data, name, value, 0), name);
    settings_.emplace_back(std::string("x264_") + name, value);
  }

  void open_codec() {
    silence_libav();
    const AVCodec* libx264 = avcodec_find_encoder_by_name("libx264");
    if (libx264 == nullptr) {
      throw ClipError("this libavcodec has no libx264\nhint: apt-get install libavcodec59");
    }
    const ProfileSettings wanted = settings_of(options_.profile);
    const AVRational rate = to_rational(options_.frame_rate_hz);
    codec_.reset(avcodec_alloc_context3(libx264));
    codec_->width = options_.width;
    codec_->height = options_.height;
    codec_->pix_fmt = AV_PIX_FMT_YUV420P;
    codec_->framerate = rate;
    codec_->time_base = av_inv_q(rate);
    codec_->gop_size = kKeyframeInterval;
    codec_->max_b_frames = kReorderedFrames;
    codec_->color_primaries = AVCOL_PRI_BT709;
    codec_->color_trc = AVCOL_TRC_BT709;
    codec_->colorspace = AVCOL_SPC_BT709;
    codec_->color_range = AVCOL_RANGE_MPEG;
    codec_->chroma_sample_location = AVCHROMA_LOC_CENTER;
    codec_->thread_count = 1;  // x264 writes the thread count into the stream
    codec_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_BITEXACT;
    settings_ = {
        {"codec", "libx264"},
        {"profile", wanted.name},
        {"size_px", std::to_string(options_.width) + "x" + std::to_string(options_.height)},
        {"frame_rate", std::to_string(rate.num) + "/" + std::to_string(rate.den)},
        {"pixel_format", "yuv420p"},
        {"colour", "bt709, limited range"},
        {"keyframe_interval", std::to_string(kKeyframeInterval)},
        {"b_frames", std::to_string(kReorderedFrames)},
        {"threads", "1"}};
    set_option("preset", wanted.preset);
    set_option(wanted.quality_key, wanted.quality);
    if (options_.profile != Profile::kMaster) set_option("profile", "high");
    // Without this x264 picks arithmetic by processor, and bytes differ between machines.
    set_option("x264-params", "cpu-independent=1");
    settings_.emplace_back("libavcodec", LIBAVCODEC_IDENT);
    check(avcodec_open2(codec_.get(), libx264, nullptr), "cannot start libx264");

    frame_.reset(av_frame_alloc());
    frame_->format = codec_->pix_fmt;
    frame_->width = options_.width;
    frame_->height = options_.height;
    check(av_frame_get_buffer(frame_.get(), 0), "no memory for a picture");
    packet_.reset(av_packet_alloc());
  }

  void open_file() {
    check(avformat_alloc_output_context2(&file_, nullptr, "mp4", temporary_.c_str()),
          "cannot make an mp4");
    file_->flags |= AVFMT_FLAG_BITEXACT;
    stream_ = avformat_new_stream(file_, nullptr);
    stream_->time_base = codec_->time_base;
    stream_->avg_frame_rate = stream_->r_frame_rate = codec_->framerate;
    check(avcodec_parameters_from_context(stream_->codecpar, codec_.get()), "cannot describe");
    check(avio_open(&file_->pb, temporary_.c_str(), AVIO_FLAG_WRITE), "cannot create the file");
    AVDictionary* format_options = nullptr;
    av_dict_set(&format_options, "movflags", "+faststart", 0);
    const int code = avformat_write_header(file_, &format_options);
    av_dict_free(&format_options);
    check(code, "cannot start the file");
  }

  /// frame: null flushes what the encoder still holds.
  void encode(const AVFrame* frame) {
    check(avcodec_send_frame(codec_.get(), frame), "cannot encode");
    for (;;) {
      const int code = avcodec_receive_packet(codec_.get(), packet_.get());
      if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return;
      check(code, "cannot encode");
      packet_->duration = 1;
      av_packet_rescale_ts(packet_.get(), codec_->time_base, stream_->time_base);
      packet_->stream_index = stream_->index;
      check(av_interleaved_write_frame(file_, packet_.get()), "cannot write");
      check(file_->pb->error, "cannot write");
    }
  }

  void discard() {
    if (file_ == nullptr) return;
    if (file_->pb != nullptr) avio_closep(&file_->pb);
    avformat_free_context(file_);
    file_ = nullptr;
    std::error_code ignored;
    if (!is_finished_) std::filesystem::remove(temporary_, ignored);
  }

  std::filesystem::path path_, temporary_;
  EncoderOptions options_;
  std::vector<std::pair<std::string, std::string>> settings_;
  LibavPtr<AVCodecContext> codec_;
  LibavPtr<AVFrame> frame_;
  LibavPtr<AVPacket> packet_;
  AVFormatContext* file_ = nullptr;
  AVStream* stream_ = nullptr;
  std::int64_t num_frames_ = 0;
  bool is_finished_ = false;
};

Encoder::Encoder(std::filesystem::path path, const EncoderOptions& options)
    : impl_(std::make_unique<Impl>(std::move(path), options)) {}
Encoder::~Encoder() = default;
void Encoder::add(std::span<const std::uint8_t> rgba) { impl_->add(rgba); }
void Encoder::finish() { impl_->finish(); }
const std::vector<std::pair<std::string, std::string>>& Encoder::settings() const {
  return impl_->settings();
}
const std::filesystem::path& Encoder::temporary_path() const { return impl_->temporary_path(); }

}  // namespace verisim::clip
