#include "tools/viewer/page_progress.h"

#include <cmath>

namespace supple::tools {

namespace {

using namespace std::chrono_literals;

constexpr auto kQuiet = 400ms;  // work that is shorter is not told of
constexpr auto kTellEvery = 200ms;

}  // namespace

PageProgress::PageProgress(Pages& pages, Progress& behind) : m_pages(pages), m_behind(behind) {}

void PageProgress::begin() {
  m_is_cancelled = false;
  m_is_running = true;
  m_stage = "working";
  m_begun = m_entered = m_told = std::chrono::steady_clock::now();
}

void PageProgress::end() {
  m_is_running = false;
  if (!m_is_told) return;
  m_is_told = false;
  m_pages.tell_all(Pages::text_of({{"progress", nullptr}}));
}

void PageProgress::stage(std::string_view name) {
  m_stage = name;
  m_entered = std::chrono::steady_clock::now();
  m_behind.stage(name);
}

void PageProgress::update(double fraction) {
  m_behind.update(fraction);
  const auto now = std::chrono::steady_clock::now();
  if (now - m_begun < kQuiet || now - m_told < kTellEvery) return;
  m_told = now;
  m_is_told = true;
  const std::chrono::duration<double, std::milli> since = now - m_entered;
  m_pages.tell_all(Pages::text_of(
      {{"progress", {{"what", m_stage}, {"part", fraction}, {"ms", std::floor(since.count())}}}}));
}

bool PageProgress::cancelled() const {
  return m_is_cancelled || m_behind.cancelled();
}

void PageProgress::log(const char* level, const std::string& line) {
  m_pages.tell_all(Pages::text_of({{"log", {{"level", level}, {"text", line}}}}));
}

void PageProgress::warn(const std::string& line) {
  m_behind.warn(line);
  log("warning", line);
}

void PageProgress::note(const std::string& line) {
  m_behind.note(line);
  log("note", line);
}

}  // namespace supple::tools
