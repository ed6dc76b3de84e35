#include "tools/viewer/pages.h"

#include <algorithm>

#include "volumes/base/json.h"

namespace supple::tools {

namespace {

/// Messages that a picture on its way may be behind: minutes of dragging.
constexpr std::size_t kMostNumbers = 8192;

}  // namespace

int Pages::join(std::shared_ptr<PageOutlet> outlet, const std::string& hello) {
  const std::lock_guard lock(m_guard);
  const int number = m_next_page++;
  Page& page = m_pages[number];
  page.outlet = std::move(outlet);
  page.waiting = m_last;
  if (!hello.empty()) page.outlet->send_text(std::make_shared<const std::string>(hello));
  page.outlet->send_text(scene_for(page));
  send_waiting(page);
  return number;
}

void Pages::leave(int page) {
  const std::lock_guard lock(m_guard);
  m_pages.erase(page);
}

std::size_t Pages::count() const {
  const std::lock_guard lock(m_guard);
  return m_pages.size();
}

int Pages::joined() const {
  const std::lock_guard lock(m_guard);
  return m_next_page - 1;
}

void Pages::note(int page, std::uint64_t number, std::uint32_t n) {
  const std::lock_guard lock(m_guard);
  const auto found = m_pages.find(page);
  if (found == m_pages.end()) return;
  auto& numbers = found->second.numbers;
  numbers.emplace_back(number, n);
  if (numbers.size() > kMostNumbers) numbers.pop_front();
}

std::uint32_t Pages::shown_by(const Page& page, std::uint64_t number) {
  const auto later = std::upper_bound(
      page.numbers.begin(), page.numbers.end(), number,
      [](std::uint64_t wanted, const auto& noted) { return wanted < noted.first; });
  return later == page.numbers.begin() ? 0 : std::prev(later)->second;
}

std::uint32_t Pages::known(int page, std::uint64_t number) const {
  const std::lock_guard lock(m_guard);
  const auto found = m_pages.find(page);
  return found == m_pages.end() ? 0 : shown_by(found->second, number);
}

void Pages::acknowledge(int page, std::uint32_t frame) {
  const std::lock_guard lock(m_guard);
  const auto found = m_pages.find(page);
  if (found == m_pages.end()) return;
  auto& waiting = found->second.unacknowledged;
  waiting.erase(std::remove(waiting.begin(), waiting.end(), frame), waiting.end());
  send_waiting(found->second);
}

void Pages::tell(int page, const std::string& text) {
  const std::lock_guard lock(m_guard);
  const auto found = m_pages.find(page);
  if (found != m_pages.end()) {
    found->second.outlet->send_text(std::make_shared<const std::string>(text));
  }
}

void Pages::tell_all(const std::string& text) {
  const auto shared = std::make_shared<const std::string>(text);
  const std::lock_guard lock(m_guard);
  for (auto& [number, page] : m_pages) page.outlet->send_text(shared);
}

void Pages::tell_scene(const Value& scene, std::uint64_t number) {
  std::string text = text_of({{"scene", scene}});
  const std::lock_guard lock(m_guard);
  m_scene = text;
  m_scene_number = number;
  for (auto& [id, page] : m_pages) page.outlet->send_text(scene_for(page));
}

/// The scene for one page, which ends with the page's own count of events.
std::shared_ptr<const std::string> Pages::scene_for(const Page& page) const {
  std::string text = m_scene;
  const std::size_t end = text.rfind("}}");
  if (end != std::string::npos) {
    text.insert(end, ",\"event\":" + std::to_string(shown_by(page, m_scene_number)));
  }
  return std::make_shared<const std::string>(std::move(text));
}

void Pages::tell_refused(std::uint64_t number, const std::string& why) {
  Value log = {{"level", "error"}, {"text", why}};
  const std::lock_guard lock(m_guard);
  for (auto& [id, page] : m_pages) {
    for (const auto& [noted, n] : page.numbers) {
      if (noted != number) continue;
      log["n"] = n;
      return page.outlet->send_text(std::make_shared<const std::string>(text_of({{"log", log}})));
    }
  }
  const auto text = std::make_shared<const std::string>(text_of({{"log", log}}));
  for (auto& [id, page] : m_pages) page.outlet->send_text(text);
}

std::string Pages::text_of(const Value& json) {
  return json_text(json);
}

void Pages::publish(FrameMessage frame) {
  const std::lock_guard lock(m_guard);
  SharedFrame& last = m_last[frame.slot()];
  if (last != nullptr && last->stamp >= frame.stamp) return;
  last = std::make_shared<const FrameMessage>(std::move(frame));
  for (auto& [number, page] : m_pages) {
    page.waiting[last->slot()] = last;
    send_waiting(page);
  }
}

void Pages::forget_frames() {
  const std::lock_guard lock(m_guard);
  m_last = {};
  for (auto& [number, page] : m_pages) page.waiting = {};
}

void Pages::forget_frames_at_rest() {
  const std::lock_guard lock(m_guard);
  const auto forget = [](auto& frames) {
    std::for_each(frames.begin() + kViewCount, frames.end(), [](auto& frame) { frame.reset(); });
  };
  forget(m_last);
  for (auto& [number, page] : m_pages) forget(page.waiting);
}

std::uint64_t Pages::next_stamp() {
  const std::lock_guard lock(m_guard);
  return m_next_stamp++;
}

void Pages::send_waiting(Page& page) {
  for (SharedFrame& waiting : page.waiting) {
    if (page.unacknowledged.size() >= kMostUnacknowledged) return;
    if (waiting == nullptr) continue;
    const std::uint32_t number = m_next_frame++;
    page.unacknowledged.push_back(number);
    page.outlet->send_frame(head_of(*waiting, shown_by(page, waiting->number), number), waiting);
    waiting.reset();
  }
}

}  // namespace supple::tools
