#include "tools/scene/operation/event_news.h"

namespace supple::tools {

namespace {

constexpr double kOver_s = 0.25;

}  // namespace

std::vector<OperationEvent> EventNews::of(const OperationSample& sample) {
  if (sample.time_s < m_last_s) m_touches.clear();  // it began again
  m_last_s = sample.time_s;
  std::vector<OperationEvent> news;
  for (const OperationEvent& event : sample.events) {
    if (event.kind != "touch") {
      news.push_back(event);
      continue;
    }
    const auto [found, is_new] =
        m_touches.try_emplace({event.instrument, event.at}, Touch{event, event.time_s});
    if (is_new) news.push_back(event);
    Touch& touch = found->second;
    touch.last_s = event.time_s;
    if (event.value > touch.hardest.value) touch.hardest = event;
  }
  for (auto touch = m_touches.begin(); touch != m_touches.end();) {
    if (sample.time_s - touch->second.last_s < kOver_s) {
      ++touch;
      continue;
    }
    OperationEvent end = touch->second.hardest;
    end.kind = "touch_ended";
    end.time_s = sample.time_s;
    news.push_back(end);
    touch = m_touches.erase(touch);
  }
  return news;
}

}  // namespace supple::tools
