#include "tools/console/child_process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "volumes/base/error.h"
#include "volumes/base/progress.h"

namespace supple::tools {

namespace {

constexpr int kLookEveryMs = 50;

struct ReadEnd {
  int file = -1;
  std::string text;

  ~ReadEnd() {
    if (file >= 0) ::close(file);
  }
  /// False at the end.
  bool take() {
    char buffer[16384];
    const ssize_t count = ::read(file, buffer, sizeof buffer);
    if (count > 0) text.append(buffer, std::size_t(count));
    return count > 0 || (count < 0 && errno == EINTR);
  }
};

class RunningChild {
 public:
  RunningChild(const std::string& program, const std::vector<std::string>& arguments) {
    int out[2], err[2];
    if (::pipe2(out, O_CLOEXEC) != 0) fail_start(program);
    m_out.file = out[0];
    if (::pipe2(err, O_CLOEXEC) != 0) {
      ::close(out[1]);
      fail_start(program);
    }
    m_err.file = err[0];
    std::vector<char*> words = {const_cast<char*>(program.c_str())};
    for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    const pid_t parent = ::getpid();
    m_pid = ::fork();
    if (m_pid == 0) become(program, words, out[1], err[1], parent);
    ::close(out[1]);
    ::close(err[1]);
    if (m_pid < 0) fail_start(program);
  }
  RunningChild(const RunningChild&) = delete;
  RunningChild& operator=(const RunningChild&) = delete;
  ~RunningChild() {
    if (m_pid < 0) return;
    ::kill(m_pid, SIGKILL);
    wait();
  }

  /// Takes what it says, for at most kLookEveryMs; false once both streams have ended.
  bool listen() {
    std::array<pollfd, 2> ends = {pollfd{m_out_open ? m_out.file : -1, POLLIN, 0},
                                  pollfd{m_err_open ? m_err.file : -1, POLLIN, 0}};
    if (::poll(ends.data(), ends.size(), kLookEveryMs) > 0) {
      if (ends[0].revents != 0) m_out_open = m_out.take();
      if (ends[1].revents != 0) m_err_open = m_err.take();
    }
    return m_out_open || m_err_open;
  }
  void end() { ::kill(m_pid, SIGKILL); }
  /// The largest resident size so far, in millions of bytes; 0 before it is known.
  double peak_mb() const {
    std::ifstream status("/proc/" + std::to_string(m_pid) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.rfind("VmHWM:", 0) == 0) return std::strtod(line.c_str() + 6, nullptr) * 1024e-6;
    }
    return 0;
  }
  /// The status of wait().
  int wait() {
    int status = 0;
    while (::waitpid(m_pid, &status, 0) < 0 && errno == EINTR) {
    }
    m_pid = -1;
    return status;
  }
  std::string take_out() { return std::move(m_out.text); }
  const std::string& err() const { return m_err.text; }

 private:
  [[noreturn]] static void fail_start(const std::string& program) {
    throw SystemError(program + ": cannot start: " + std::strerror(errno));
  }
  /// In the copy of the process: calls nothing that other threads could hold a lock of.
  [[noreturn]] static void become(const std::string& program, const std::vector<char*>& words,
                                  int out, int err, pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(127);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(err, STDERR_FILENO);
    ::execv(program.c_str(), words.data());
    ::_exit(127);
  }

  pid_t m_pid = -1;
  ReadEnd m_out, m_err;
  bool m_out_open = true, m_err_open = true;
};

/// The lines that begin so, without that.
std::vector<std::string> lines_of(const std::string& text, const std::string& prefix) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind(prefix, 0) == 0 && line.size() > prefix.size()) {
      lines.push_back(line.substr(prefix.size()));
    }
  }
  return lines;
}

std::string last_of(const std::vector<std::string>& lines) {
  return lines.empty() ? "" : lines.back();
}

/// What a child that ended by itself had to complain of.
std::string complaint_of(const std::string& err) {
  const std::string error = last_of(lines_of(err, "supple: error: "));
  if (!error.empty()) return error;
  const std::vector<std::string> lines = lines_of(err, "");
  for (const std::string& line : lines) {
    for (const char* report :
         {"runtime error: ", "ERROR: AddressSanitizer", "ERROR: LeakSanitizer"}) {
      if (line.find(report) != std::string::npos) return line;
    }
  }
  return last_of(lines);
}

}  // namespace

ChildEnd run_child(const std::string& program, const std::vector<std::string>& arguments,
                   const ChildLimits& limits, const std::function<bool()>& cancelled) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  RunningChild child(program, arguments);
  ChildEnd end;
  while (child.listen()) {
    if (cancelled()) throw Cancelled();
    end.peak_mb = std::max(end.peak_mb, child.peak_mb());
    if (end.timed_out || end.over_memory) continue;
    end.timed_out = seconds() > limits.wall_s;
    end.over_memory = end.peak_mb > limits.resident_mb;
    if (end.timed_out || end.over_memory) child.end();
  }
  const int status = child.wait();
  end.wall_s = seconds();
  // Ctrl-C reaches the child of a terminal first.
  if (cancelled()) throw Cancelled();
  if (WIFEXITED(status)) end.exit_code = WEXITSTATUS(status);
  end.out = child.take_out();
  for (const std::string& line : lines_of(child.err(), "supple: warning: ")) {
    end.warnings += (end.warnings.empty() ? "" : "; ") + line;
  }
  end.complaint = complaint_of(child.err());
  if (end.timed_out) {
    end.complaint = "no result after " + number_text(limits.wall_s) + " s";
  } else if (end.over_memory) {
    end.complaint = "more than " + number_text(limits.resident_mb) + " MB";
  } else if (WIFSIGNALED(status)) {
    end.complaint = "ended by signal " + std::to_string(WTERMSIG(status)) +
                    (end.complaint.empty() ? "" : ": " + end.complaint);
  }
  return end;
}

}  // namespace supple::tools
