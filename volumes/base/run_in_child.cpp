#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <new>
#include <string>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "volumes/base/parallel.h"
#include "volumes/base/process.h"

namespace supple {

namespace {

std::atomic<bool> g_allowed{false};

constexpr int kRefused = 40, kOutOfMemory = 41;

/// Both ends of a pipe, closed when the trial is over.
struct Pipe {
  int ends[2] = {-1, -1};

  bool open() { return ::pipe2(ends, O_CLOEXEC) == 0; }
  ~Pipe() {
    close(0);
    close(1);
  }
  void close(int end) {
    if (ends[end] >= 0) ::close(ends[end]);
    ends[end] = -1;
  }
};

/// Data that the process has mapped, in bytes (proc(5), statm).
std::int64_t data_bytes() {
  std::int64_t pages[6] = {};
  std::ifstream statm("/proc/self/statm");
  for (std::int64_t& count : pages) statm >> count;
  return pages[5] * ::sysconf(_SC_PAGESIZE);
}

void limit(int resource, rlim_t most) {
  rlimit bound{};
  if (::getrlimit(__rlimit_resource_t(resource), &bound) != 0) return;
  bound.rlim_cur = std::min(bound.rlim_max, most);
  ::setrlimit(__rlimit_resource_t(resource), &bound);
}

/// The child neither reports nor outlives its bounds: handlers of debuggers and sanitizers are for
/// the parent's faults.
void confine(const ChildBounds& bounds) {
  for (const int signal :
       {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGINT, SIGTERM, SIGXCPU, SIGALRM}) {
    ::signal(signal, SIG_DFL);
  }
  ::alarm(unsigned(bounds.seconds));
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, rlim_t(bounds.processor_seconds));
  limit(RLIMIT_DATA, rlim_t(data_bytes() + bounds.bytes));
}

std::string packed(const Problem& problem) {
  std::string text;
  for (const std::string* part :
       {&problem.file, &problem.field, &problem.found, &problem.expected}) {
    text += *part;
    text += '\0';
  }
  return text;
}

Problem unpacked(const std::string& text) {
  Problem problem;
  std::size_t at = 0;
  for (std::string* part : {&problem.file, &problem.field, &problem.found, &problem.expected}) {
    const std::size_t end = std::min(text.find('\0', at), text.size());
    *part = text.substr(at, end - at);
    at = std::min(end + 1, text.size());
  }
  return problem;
}

/// Returns the exit status of the child; a problem goes through the pipe.
int trial_status(int out, const std::function<void()>& parse) {
  try {
    parse();
  } catch (const InputError& error) {
    const std::string text = packed(error.problem());
    for (std::size_t at = 0; at < text.size();) {
      const ssize_t sent = ::write(out, text.data() + at, text.size() - at);
      if (sent <= 0) return EXIT_FAILURE;
      at += std::size_t(sent);
    }
    return kRefused;
  } catch (const std::bad_alloc&) {
    return kOutOfMemory;
  } catch (...) {
    return EXIT_SUCCESS;
  }
  return EXIT_SUCCESS;
}

std::string read_all(int in) {
  std::string text;
  char buffer[4096];
  for (;;) {
    const ssize_t count = ::read(in, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(buffer, std::size_t(count));
  }
}

}  // namespace

void allow_child_processes(bool allowed) {
  g_allowed = allowed;
}

void run_in_child(const Problem& about, const ChildBounds& bounds,
                  const std::function<void()>& parse) {
  if (!g_allowed) return;
  Pipe pipe;
  if (!pipe.open()) return;
  // The child has none of oneTBB's threads, one of which may have held a lock. An arena without
  // them, made before, asks for no lock.
  OneThread alone;
  const pid_t child = ::fork();
  if (child < 0) return;
  if (child == 0) {
    confine(bounds);
    alone.run([&] { ::_exit(trial_status(pipe.ends[1], parse)); });
  }
  pipe.close(1);
  const std::string text = read_all(pipe.ends[0]);
  const int status = wait_for_end(child);
  if (WIFEXITED(status) && WEXITSTATUS(status) == EXIT_SUCCESS) return;
  // The user stops parent and child alike.
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGINT || WTERMSIG(status) == SIGTERM)) return;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kRefused) throw InputError(unpacked(text));

  Problem problem = about;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kOutOfMemory) {
    problem.found = "damage that takes more than " + std::to_string(bounds.bytes >> 20) +
                    " MiB of memory to parse";
  } else if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGALRM)) {
    const int seconds = WTERMSIG(status) == SIGXCPU ? bounds.processor_seconds : bounds.seconds;
    problem.found = "damage that takes more than " + std::to_string(seconds) + " s to parse";
  } else {
    problem.found = "damage that the library does not survive";
  }
  throw InputError(problem);
}

}  // namespace supple
