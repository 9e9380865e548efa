#pragma once
/// MP4 by way of the program ffmpeg.
#include <filesystem>
#include <memory>

#include "analysis/render/image.hpp"

namespace repose {

/// Writes an MP4 file (H.264) through the program ffmpeg, a picture at a time.
class VideoWriter {
 public:
  /// True if there is a program ffmpeg on the PATH.
  static bool available();

  /// All pictures must have this size. Throws Error if ffmpeg cannot be started.
  VideoWriter(std::filesystem::path file, int width, int height, double frames_per_second);
  ~VideoWriter();  ///< without finish() nothing is left behind
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  void add(const Image& image);  ///< throws Error if ffmpeg gave up
  void finish();                 ///< the file is there, complete, when it returns

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace repose
