#include "tools/console/console.h"

#include <csignal>
#include <cstdio>

#include <unistd.h>

namespace supple::tools {

namespace {

volatile std::sig_atomic_t g_signal = 0;

void remember_signal(int number) {
  g_signal = number;
  std::signal(number, SIG_DFL);
}

}  // namespace

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
    if ((c >= 0 && c < ' ') || c == 127) c = '?';
  }
  return text;
}

void install_signal_handlers() {
  std::signal(SIGINT, remember_signal);
  std::signal(SIGTERM, remember_signal);
  std::signal(SIGHUP, remember_signal);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int pending_signal() {
  return g_signal;
}

Console::Console(const GlobalOptions& options)
    : m_level(options.quiet ? LogLevel::error : options.log_level),
      m_shows_progress(!options.quiet && ::isatty(STDERR_FILENO) == 1) {}

Console::~Console() {
  clear_line();
}

void Console::print(LogLevel level, const char* prefix, const std::string& line) {
  if (level > m_level) return;
  clear_line();
  std::fprintf(stderr, "supple: %s%s\n", prefix, one_line(line).c_str());
}

void Console::warn(const std::string& line) {
  print(LogLevel::warning, "warning: ", line);
}
void Console::note(const std::string& line) {
  print(LogLevel::info, "", line);
}
void Console::debug(const std::string& line) {
  print(LogLevel::debug, "debug: ", line);
}

bool Console::cancelled() const {
  return g_signal != 0;
}

void Console::clear_line() {
  if (!m_line_open) return;
  std::fputs("\r\033[K", stderr);
  m_line_open = false;
}

void Console::finish_stage() {
  if (m_stage.empty()) return;
  const double seconds = std::chrono::duration<double>(Clock::now() - m_stage_start).count();
  for (auto& [name, sum] : m_seconds) {
    if (name == m_stage) {
      sum += seconds;
      m_stage.clear();
      return;
    }
  }
  m_seconds.emplace_back(m_stage, seconds);
  m_stage.clear();
}

void Console::stage(std::string_view name) {
  finish_stage();
  clear_line();
  m_stage = name;
  m_stage_start = m_last_print = Clock::now();
  if (m_shows_progress) {
    std::fprintf(stderr, "\r\033[K%s …", m_stage.c_str());
    m_line_open = true;
  }
}

void Console::update(double fraction) {
  if (!m_shows_progress) return;
  const Clock::time_point now = Clock::now();
  if (now - m_last_print < std::chrono::milliseconds(100)) return;
  m_last_print = now;
  const double elapsed = std::chrono::duration<double>(now - m_stage_start).count();
  std::fprintf(stderr, "\r\033[K%s %3.0f %%", m_stage.c_str(), 100 * fraction);
  if (fraction > 0.02) {
    std::fprintf(stderr, ", %.0f s left", elapsed * (1 - fraction) / fraction);
  }
  std::fflush(stderr);
  m_line_open = true;
}

std::vector<std::pair<std::string, double>> Console::stage_seconds() {
  finish_stage();
  return m_seconds;
}

}  // namespace supple::tools
