#include "tools/console/console.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <unistd.h>

#include "volumes/base/error.h"
#include "volumes/base/signals.h"

namespace supple::tools {

namespace {

/// "12.34 MB", to four digits.
std::string size_text(std::int64_t bytes) {
  const char* const units[] = {"bytes", "kB", "MB", "GB", "TB"};
  double size = double(bytes);
  int unit = 0;
  while (size >= 1000 && unit < 4) {
    size /= 1000;
    ++unit;
  }
  return number_text(size, 4) + " " + units[unit];
}

}  // namespace

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
    if ((c >= 0 && c < ' ') || c == 127) c = '?';
  }
  return text;
}

Console::Console(const GlobalOptions& options)
    : m_level(options.quiet ? LogLevel::error : options.log_level),
      m_has_terminal(::isatty(STDERR_FILENO) == 1),
      m_line_every(10) {
  if (const char* seconds = std::getenv("SUPPLE_PROGRESS_SECONDS")) {
    m_line_every = std::chrono::duration<double>(std::strtod(seconds, nullptr));
  }
}

Console::~Console() {
  clear_line();
  m_reserved.reset();
  keep_at_signal();
}

void Console::claim(const std::vector<std::string>& outputs) {
  for (const std::string& path : outputs) {
    poll(this);
    remove_at_signal(m_reserved->add(path));
  }
  m_outputs.insert(m_outputs.end(), outputs.begin(), outputs.end());
}

void Console::tell_outputs() {
  constexpr std::size_t kListed = 8;
  const double seconds = std::chrono::duration<double>(Clock::now() - m_start).count();
  const std::string after = ", after " + number_text(seconds, 4) + " s";
  std::vector<std::pair<std::string, std::int64_t>> found;
  std::int64_t bytes = 0;
  for (const std::string& path : m_outputs) {
    std::error_code missing;
    const auto size = std::int64_t(std::filesystem::file_size(path, missing));
    if (missing) continue;
    found.emplace_back(path, size);
    bytes += size;
  }
  if (found.size() > kListed) {
    return note("wrote " + std::to_string(found.size()) + " files, " + found.front().first +
                " to " + found.back().first + ", " + size_text(bytes) + after);
  }
  for (const auto& [path, size] : found) note("wrote " + path + ", " + size_text(size) + after);
}

void Console::print(LogLevel level, const char* prefix, const std::string& line) {
  if (level > m_level) return;
  clear_line();
  std::fprintf(stderr, "supple: %s%s\n", prefix, one_line(line).c_str());
}

void Console::print_once(LogLevel level, const char* prefix, const std::string& line) {
  const std::optional<std::string> told = m_repeated ? m_repeated->take(line) : line;
  if (told) print(level, prefix, *told);
}

void Console::error(const std::string& line) {
  print(LogLevel::error, "error: ", line);
}
void Console::warn(const std::string& line) {
  print_once(LogLevel::warning, "warning: ", line);
}
void Console::note(const std::string& line) {
  print_once(LogLevel::info, "", line);
}

void Console::enter(const std::string& what, int number) {
  if (!m_repeated) m_repeated.emplace(what);
  m_repeated->enter(number);
}

void Console::tell_repeats() {
  if (!m_repeated) return;
  const std::vector<std::string> lines = m_repeated->repeats();
  m_repeated.reset();
  for (const std::string& line : lines) warn(line);
}
void Console::debug(const std::string& line) {
  print(LogLevel::debug, "debug: ", line);
}

bool Console::cancelled() const {
  return pending_signal() != 0;
}

void Console::clear_line() {
  if (!m_line_open) return;
  std::fputs("\r\033[K", stderr);
  m_line_open = false;
}

void Console::stage(std::string_view name) {
  m_times.begin(name);
  m_filter.begin(std::string(name));
  clear_line();
  m_stage = name;
  m_stage_start = m_last_print = Clock::now();
  if (!m_has_terminal || m_level < LogLevel::warning) return;
  std::fprintf(stderr, "\r\033[K%s …", m_stage.c_str());
  m_line_open = true;
}

void Console::update(double fraction) {
  m_filter.update(fraction);
  const Clock::time_point now = Clock::now();
  const std::chrono::duration<double> least =
      m_has_terminal ? std::chrono::duration<double>(0.1) : m_line_every;
  const bool is_hidden = m_level < (m_has_terminal ? LogLevel::warning : LogLevel::info);
  if (is_hidden || now - m_last_print < least) return;
  m_last_print = now;
  show_progress(fraction, now);
}

void Console::show_progress(double fraction, Clock::time_point now) {
  const double elapsed = std::chrono::duration<double>(now - m_stage_start).count();
  std::fprintf(stderr, m_has_terminal ? "\r\033[K%s %3.0f %%" : "supple: %s %.0f %%",
               m_stage.c_str(), 100 * fraction);
  if (fraction > 0.02) {
    std::fprintf(stderr, ", %.0f s left", elapsed * (1 - fraction) / fraction);
  }
  if (!m_has_terminal) std::fputc('\n', stderr);
  std::fflush(stderr);
  m_line_open = m_has_terminal;
}

std::vector<std::pair<std::string, double>> Console::stage_seconds() {
  m_times.end();
  return m_times.seconds();
}

}  // namespace supple::tools
