// Videos, encoded by the program ffmpeg, which reads the pictures from a pipe. A process of its own
// keeps its codecs and their licences apart from this program, which needs it for nothing else.
#pragma once

#include <cstdio>
#include <memory>
#include <string>

#include <sys/types.h>

#include "raycast/pictures/image.h"

namespace supple::tools {

bool is_video_extension(const std::string& extension);

/// Throws SystemError naming `path` unless the program ffmpeg is installed.
void require_video_encoder(const std::string& path);

class VideoEncoder {
 public:
  /// `path` may be a temporary name of the right extension; `shown_as` names the file in errors.
  VideoEncoder(const std::string& path, std::string shown_as, int width, int height,
               double frames_per_second, const std::string& comment);
  /// Ends the encoder where finish() was not called; its file is then of no use.
  ~VideoEncoder();
  VideoEncoder(const VideoEncoder&) = delete;
  VideoEncoder& operator=(const VideoEncoder&) = delete;

  /// The next picture, shown on black. Throws SystemError.
  void add(const Image& image);
  /// Waits for the encoder. Throws SystemError with its messages.
  void finish();

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  [[noreturn]] void fail();
  int wait_for_end();

  std::string m_shown_as;
  std::unique_ptr<std::FILE, CloseFile> m_messages;  // messages of the encoder
  pid_t m_process = -1;
  int m_pipe = -1;
};

}  // namespace supple::tools
