#include "volumes/base/run_program.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "volumes/base/error.h"
#include "volumes/base/progress.h"

namespace supple {

namespace {

constexpr int kLookEveryMs = 50;
constexpr int kLooksToTidy = 10;  // before a program that does not end is killed

struct ReadEnd {
  int file = -1;
  std::string text;

  ~ReadEnd() {
    if (file >= 0) ::close(file);
  }
  /// Reads on; false at the end.
  bool take() {
    char buffer[16384];
    const ssize_t count = ::read(file, buffer, sizeof buffer);
    if (count > 0) text.append(buffer, std::size_t(count));
    return count > 0 || (count < 0 && errno == EINTR);
  }
};

class RunningChild {
 public:
  RunningChild(const std::string& program, const std::vector<std::string>& arguments,
               const std::string& folder) {
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
    if (m_pid == 0) become(words, folder, out[1], err[1], parent);
    ::close(out[1]);
    ::close(err[1]);
    if (m_pid < 0) fail_start(program);
  }
  RunningChild(const RunningChild&) = delete;
  RunningChild& operator=(const RunningChild&) = delete;
  ~RunningChild() {
    if (m_pid < 0) return;
    ::kill(m_pid, SIGTERM);  // it may have files to remove
    for (int looks = 0; looks < kLooksToTidy && m_pid > 0; ++looks) {
      if (::waitpid(m_pid, nullptr, WNOHANG) == m_pid) m_pid = -1;
      if (m_pid > 0) ::usleep(1000 * kLookEveryMs);
    }
    if (m_pid < 0) return;
    end();
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
  std::string take_err() { return std::move(m_err.text); }

 private:
  [[noreturn]] static void fail_start(const std::string& program) {
    throw SystemError(program + ": cannot start: " + std::strerror(errno));
  }
  /// Runs in the copy of the process: calls nothing that other threads could hold a lock of.
  [[noreturn]] static void become(const std::vector<char*>& words, const std::string& folder,
                                  int out, int err, pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(kNoSuchProgram);
    if (!folder.empty() && ::chdir(folder.c_str()) != 0) ::_exit(kNoSuchProgram);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(err, STDERR_FILENO);
    ::execvp(words[0], words.data());
    ::_exit(kNoSuchProgram);
  }

  pid_t m_pid = -1;
  ReadEnd m_out, m_err;
  bool m_out_open = true, m_err_open = true;
};

}  // namespace

ProgramEnd run_program(const std::string& program, const std::vector<std::string>& arguments,
                       const std::string& folder, const ProgramLimits& limits,
                       const std::function<bool()>& cancelled) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  RunningChild child(program, arguments, folder);
  ProgramEnd end;
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
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  end.out = child.take_out();
  end.err = child.take_err();
  return end;
}

}  // namespace supple
