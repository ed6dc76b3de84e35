#include "tools/scene/peers/peer_process.h"

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <regex>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "volumes/base/error.h"
#include "volumes/base/memory.h"
#include "volumes/base/process.h"

namespace supple::tools {

namespace {

constexpr const char* kServer = "/usr/bin/Xvfb";
/// Starts a program that gets a signal when this one ends, however it ends.
constexpr const char* kEndsWithParent = "/usr/bin/setpriv";

double now_ms() {
  return std::chrono::duration<double, std::milli>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

PeerProcess::PeerProcess(const std::vector<std::string>& arguments,
                         const std::vector<std::string>& environment)
    : m_name(std::filesystem::path(arguments.front()).filename()) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw SystemError(m_name + ": " + std::strerror(errno));
  }
  m_socket = ends[0];
  const int messages =
      ::open((m_scratch / "stderr").c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  m_own_mbytes = rss_mb();
  m_start_ms = now_ms();
  m_pid = start_program({arguments, "", environment, ends[1], ends[1], messages});
  const int failure = errno;
  ::close(messages);
  ::close(ends[1]);
  if (m_pid < 0) {
    ::close(m_socket);
    throw SystemError(arguments.front() + ": " + std::strerror(failure));
  }
}

PeerProcess::~PeerProcess() {
  if (m_pid >= 0) {
    ::kill(m_pid, SIGTERM);
    wait_for_end(m_pid);
  }
  ::close(m_socket);
}

/// The last line on stderr that has words beside a terminal's colours.
std::string PeerProcess::complaint() const {
  static const std::regex colour("\x1b\\[[0-9;]*m");
  std::ifstream stream(m_scratch / "stderr");
  std::string last;
  for (std::string line; std::getline(stream, line);) {
    line = std::regex_replace(line, colour, "");
    if (!line.empty()) last = line;
  }
  return m_name + ": " + (last.empty() ? "failed" : last);
}

std::string PeerProcess::read_line(const Progress* progress) {
  constexpr int kAskEvery_ms = 50;
  for (;;) {
    const std::size_t end = m_unread.find('\n');
    if (end != std::string::npos) {
      const std::string line = m_unread.substr(0, end);
      m_unread.erase(0, end + 1);
      return line;
    }
    if (progress != nullptr && progress->cancelled()) throw Cancelled();
    struct pollfd waiting = {m_socket, POLLIN, 0};
    if (progress != nullptr && ::poll(&waiting, 1, kAskEvery_ms) <= 0) continue;
    char buffer[4096];
    const ssize_t count = ::read(m_socket, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) throw Error(complaint());
    m_unread.append(buffer, std::size_t(count));
  }
}

std::string PeerProcess::ask(const std::string& line, const Progress* progress) {
  const std::string text = line + "\n";
  if (::send(m_socket, text.data(), text.size(), MSG_NOSIGNAL) != ssize_t(text.size())) {
    throw Error(complaint());
  }
  return read_line(progress);
}

ProcessCost PeerProcess::finish() {
  ::shutdown(m_socket, SHUT_WR);
  int status = 0;
  struct rusage usage {};
  while (::wait4(m_pid, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  ProcessCost cost;
  cost.wall_ms = now_ms() - m_start_ms;
  m_pid = -1;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw Error(complaint());
  const double peak = double(usage.ru_maxrss) * 1024 / 1e6;
  if (peak > m_own_mbytes) cost.peak_mbytes = peak;
  return cost;
}

bool has_python_with_vtk(const std::vector<std::string>& modules) {
  std::string test = "import sys";
  for (const std::string& module : modules) test += ", vtkmodules." + module;
  try {
    PeerProcess({kPythonWithVtk, "-c", test}).finish();
  } catch (const Error&) {
    return false;
  }
  return true;
}

bool VirtualDisplay::is_installed() {
  return std::filesystem::exists(kServer);
}

VirtualDisplay::VirtualDisplay()
    : m_server({kEndsWithParent, "--pdeathsig", "TERM", kServer, "-displayfd", "1", "-screen", "0",
                "1280x1024x24", "-nolisten", "tcp", "-noreset"}),
      m_environment("DISPLAY=:" + m_server.read_line()) {}

}  // namespace supple::tools
