#include "volumes/base/signals.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <deque>

#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "volumes/base/atomic_file.h"

namespace supple {

namespace {

constexpr int kGraceUs = 200000;     // for what unwinds by itself
constexpr int kLookAgainUs = 20000;  // while files get their final names

/// Any thread may be the one that gets a signal, in the middle of anything.
std::atomic<int> g_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);

class KeptErrno {
 public:
  KeptErrno() = default;
  ~KeptErrno() { errno = m_kept; }
  KeptErrno(const KeptErrno&) = delete;
  KeptErrno& operator=(const KeptErrno&) = delete;

 private:
  int m_kept = errno;
};

/// A chain that a handler may be reading only grows, and is never freed.
struct ChainedRemains {
  Remains what;
  const ChainedRemains* made_before;
};
std::atomic<const ChainedRemains*> g_last{nullptr};

/// Processes that write for this one; 0: a free place. More than these are not ended.
std::array<std::atomic<pid_t>, 64> g_processes{};
static_assert(std::atomic<pid_t>::is_always_lock_free);

/// Changes a place that holds one number to another.
void replace_process(pid_t from, pid_t to) {
  for (std::atomic<pid_t>& process : g_processes) {
    pid_t expected = from;
    if (process.compare_exchange_strong(expected, to)) return;
  }
}

void call_after(int microseconds) {
  itimerval once = {};
  once.it_value.tv_usec = microseconds;
  ::setitimer(ITIMER_REAL, &once, nullptr);
}

void remember_signal(int number) {
  const KeptErrno kept;
  g_signal = number;
  std::signal(number, SIG_DFL);
  call_after(kGraceUs);
}

void write_line(const char* text) {
  if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) return;  // nobody is left to tell
}

/// Calls nothing that a signal handler may not call.
void end_in_handler(int) {
  const KeptErrno kept;
  if (CommonCommit::is_under_way()) return call_after(kLookAgainUs);
  for (const std::atomic<pid_t>& process : g_processes) {
    const pid_t child = process;
    if (child <= 0) continue;
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
  }
  for (const ChainedRemains* last = g_last; last != nullptr; last = last->made_before) {
    last->what.remove();
  }
  if (::isatty(STDERR_FILENO) == 1) write_line("\r\033[K");
  end_by_signal();
}

}  // namespace

void install_signal_handlers() {
  std::signal(SIGINT, remember_signal);
  std::signal(SIGTERM, remember_signal);
  std::signal(SIGHUP, remember_signal);
  std::signal(SIGALRM, end_in_handler);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int pending_signal() {
  return g_signal;
}

void remove_at_signal(const std::vector<Remains>& remains) {
  static auto* const chain = new std::deque<ChainedRemains>;
  for (const Remains& one : remains) g_last = &chain->emplace_back(ChainedRemains{one, g_last});
}

void keep_at_signal() {
  g_last = nullptr;
}

void end_at_signal(pid_t process) {
  replace_process(0, process);
}

void spare_at_signal(pid_t process) {
  replace_process(process, 0);
}

int end_by_signal() {
  call_after(0);
  write_line("supple: stopped, no output was left incomplete\n");
  std::signal(g_signal, SIG_DFL);
  std::raise(g_signal);
  return 128 + g_signal;
}

}  // namespace supple
