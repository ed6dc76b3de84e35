#include "tools/scene/pictures/video.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <map>
#include <sstream>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "volumes/base/error.h"
#include "volumes/base/process.h"
#include "volumes/base/signals.h"

namespace supple::tools {

namespace {

/// Codecs that players of these files know, at a quality without visible loss.
const std::map<std::string, std::vector<std::string>>& codecs() {
  static const std::map<std::string, std::vector<std::string>> table = {
      {".mp4", {"-c:v", "libx264", "-crf", "16", "-pix_fmt", "yuv420p", "-movflags", "+faststart"}},
      {".webm", {"-c:v", "libvpx-vp9", "-crf", "20", "-b:v", "0", "-pix_fmt", "yuv420p"}},
      {".avi", {"-c:v", "mjpeg", "-q:v", "2", "-pix_fmt", "yuvj420p"}}};
  return table;
}

std::string extension_of(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? "" : path.substr(dot);
}

std::vector<std::string> arguments(const std::string& path, int width, int height, double fps,
                                   const std::string& comment) {
  std::vector<std::string> all = {"ffmpeg", "-nostdin", "-loglevel", "error", "-y"};
  const auto add = [&all](const std::vector<std::string>& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  add({"-f", "rawvideo", "-pix_fmt", "rgb24", "-video_size",
       std::to_string(width) + "x" + std::to_string(height), "-framerate", number_text(fps)});
  add({"-i", "pipe:0"});
  // These codecs halve the resolution of colours and want even sizes.
  add({"-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2"});
  add(codecs().at(extension_of(path)));
  add({"-metadata", "comment=" + comment, "-fflags", "+bitexact", path});
  return all;
}

std::vector<std::uint8_t> on_black(const Image& image) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(3 * std::size_t(image.width) * image.height);
  for (std::size_t n = 0; n < image.rgba.size(); n += 4) {
    const int alpha = image.rgba[n + 3];
    for (std::size_t c = 0; c < 3; ++c) {
      rgb.push_back(std::uint8_t((image.rgba[n + c] * alpha + 127) / 255));
    }
  }
  return rgb;
}

}  // namespace

bool is_video_extension(const std::string& extension) {
  return codecs().count(extension) != 0;
}

void require_video_encoder(const std::string& path) {
  const char* folders = std::getenv("PATH");
  std::istringstream stream(folders != nullptr ? folders : "");
  for (std::string folder; std::getline(stream, folder, ':');) {
    if (::access((folder + "/ffmpeg").c_str(), X_OK) == 0) return;
  }
  throw SystemError(path + ": the program ffmpeg, which encodes videos, is not installed");
}

VideoEncoder::VideoEncoder(const std::string& path, std::string shown_as, int width, int height,
                           double frames_per_second, const std::string& comment)
    : m_shown_as(std::move(shown_as)), m_messages(std::tmpfile()) {
  int ends[2];
  if (!m_messages || ::pipe2(ends, O_CLOEXEC) != 0) {
    throw SystemError(m_shown_as + ": cannot write: " + std::strerror(errno));
  }
  m_pipe = ends[1];
  // It outlives no signal that ends us, and gets none that is meant for us alone.
  m_process = start_program({arguments(path, width, height, frames_per_second, comment),
                             "",
                             {},
                             ends[0],
                             ProgramStart::kNowhere,
                             ::fileno(m_messages.get()),
                             false,
                             true});
  ::close(ends[0]);
  if (m_process < 0) {
    ::close(m_pipe);
    throw SystemError(m_shown_as + ": the program ffmpeg could not be started");
  }
  end_at_signal(m_process);
}

VideoEncoder::~VideoEncoder() {
  if (m_process < 0) return;
  ::kill(m_process, SIGKILL);
  wait_for_end();
}

void VideoEncoder::add(const Image& image) {
  const std::vector<std::uint8_t> rgb = on_black(image);
  std::size_t written = 0;
  while (written < rgb.size()) {
    const ssize_t count = ::write(m_pipe, rgb.data() + written, rgb.size() - written);
    if (count < 0 && errno != EINTR) fail();
    if (count > 0) written += std::size_t(count);
  }
}

void VideoEncoder::finish() {
  if (wait_for_end() != 0) fail();
}

int VideoEncoder::wait_for_end() {
  ::close(m_pipe);
  // Its number stays its own until it is spared.
  siginfo_t ended;
  while (::waitid(P_PID, id_t(m_process), &ended, WEXITED | WNOWAIT) < 0 && errno == EINTR) {
  }
  spare_at_signal(m_process);
  const int status = supple::wait_for_end(m_process);
  m_process = -1;
  return status;
}

void VideoEncoder::fail() {
  if (m_process >= 0) wait_for_end();
  std::rewind(m_messages.get());
  std::string first = "it ended early";
  char line[256];
  if (std::fgets(line, sizeof line, m_messages.get()) != nullptr) first = line;
  while (!first.empty() && first.back() == '\n') first.pop_back();
  throw SystemError(m_shown_as + ": cannot write: ffmpeg: " + first);
}

}  // namespace supple::tools
