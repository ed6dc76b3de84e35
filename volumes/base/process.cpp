#include "volumes/base/process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "volumes/base/progress.h"

namespace supple {

namespace {

/// Pointers for exec(), which changes nothing of the texts; a null pointer ends them.
std::vector<char*> pointers_to(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

std::string own_program() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

std::string program_beside(const std::string& name) {
  const auto program = std::filesystem::path(own_program()).parent_path() / name;
  return std::filesystem::exists(program) ? program.string() : "";
}

std::string require_program_beside(const std::string& name) {
  const std::string program = program_beside(name);
  if (!program.empty()) return program;
  const auto folder = std::filesystem::path(own_program()).parent_path();
  throw SystemError((folder / name).string() + ": this program is missing");
}

void become_program(const std::string& program, const std::vector<std::string>& arguments) {
  ::execv(program.c_str(), pointers_to(arguments).data());
  throw SystemError(program + ": " + std::generic_category().message(errno));
}

namespace {

/// Runs in the copy of the process: calls nothing that other threads could hold a lock of. Returns
/// where the program cannot be started.
void become(const ProgramStart& start, char* const* words, char* const* variables, pid_t parent) {
  if (start.ends_with_us) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) return;
  }
  if (start.is_apart) {
    ::setpgid(0, 0);
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ}) ::signal(number, SIG_DFL);
  }
  if (!start.folder.empty() && ::chdir(start.folder.c_str()) != 0) return;
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  const int files[] = {start.in, start.out, start.err};
  for (int stream = 0; stream < 3; ++stream) {
    if (files[stream] == ProgramStart::kAsOurs) continue;
    ::dup2(files[stream] == ProgramStart::kNowhere ? nowhere : files[stream], stream);
  }
  ::execvpe(words[0], words, variables);
}

}  // namespace

pid_t start_program(const ProgramStart& start) {
  std::vector<std::string> variables = start.environment;
  for (char** entry = environ; *entry != nullptr; ++entry) variables.emplace_back(*entry);
  const std::vector<char*> words = pointers_to(start.words), environment = pointers_to(variables);
  int failures[2];  // tells the errno of the copy, and nothing once it is the program
  if (::pipe2(failures, O_CLOEXEC) != 0) return -1;
  const pid_t parent = ::getpid(), process = ::fork();
  if (process == 0) {
    become(start, words.data(), environment.data(), parent);
    const int failure = errno;
    ::_exit(::write(failures[1], &failure, sizeof failure) > 0 ? kNoSuchProgram : EXIT_FAILURE);
  }
  int failure = process < 0 ? errno : 0;
  ::close(failures[1]);
  while (process > 0 && ::read(failures[0], &failure, sizeof failure) < 0 && errno == EINTR) {
  }
  ::close(failures[0]);
  if (process > 0 && failure != 0) wait_for_end(process);
  errno = failure;
  return failure == 0 ? process : -1;
}

int wait_for_end(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

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
    ProgramStart start{{program}, folder, {}, ProgramStart::kAsOurs, out[1], err[1], true};
    start.words.insert(start.words.end(), arguments.begin(), arguments.end());
    m_pid = start_program(start);
    const int failure = errno;
    ::close(out[1]);
    ::close(err[1]);
    errno = failure;
    const bool no_process = failure == EAGAIN || failure == ENOMEM || failure == EMFILE;
    if (m_pid < 0 && no_process) fail_start(program);
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

  bool is_there() const { return m_pid >= 0; }
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
    const int status = wait_for_end(m_pid);
    m_pid = -1;
    return status;
  }
  std::string take_out() { return std::move(m_out.text); }
  std::string take_err() { return std::move(m_err.text); }

 private:
  [[noreturn]] static void fail_start(const std::string& program) {
    throw SystemError(program + ": cannot start: " + std::strerror(errno));
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
  if (!child.is_there()) {
    end.exit_code = kNoSuchProgram;
    return end;
  }
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

namespace {

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

/// Returns the complaint of a child that ended by itself.
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
                   const ProgramLimits& limits, const std::function<bool()>& cancelled,
                   const std::string& folder) {
  ChildEnd end{run_program(program, arguments, folder, limits, cancelled), {}, {}};
  for (const std::string& line : lines_of(end.err, "supple: warning: ")) {
    end.warnings += (end.warnings.empty() ? "" : "; ") + line;
  }
  end.complaint = complaint_of(end.err);
  if (end.timed_out) {
    end.complaint = "no result after " + number_text(limits.wall_s) + " s";
  } else if (end.over_memory) {
    end.complaint = "more than " + number_text(limits.resident_mb) + " MB";
  } else if (end.signal != 0) {
    end.complaint = "ended by signal " + std::to_string(end.signal) +
                    (end.complaint.empty() ? "" : ": " + end.complaint);
  }
  return end;
}

}  // namespace supple
