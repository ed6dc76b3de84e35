#include "tools/viewer/curtain.h"

#include <algorithm>

namespace supple::tools {

void Curtain::seen_otherwise() {
  std::fill(m_stale.begin() + 1, m_stale.end(), 1);
  if (m_settings.curtain) return;
  const std::lock_guard lock(m_guard);
  m_rest.reset();
  m_counts = {-1, -1};
}

void Curtain::keep_space(const LivePicture::Counts& before) {
  const bool was_drawn = m_counts.looks == before.looks && m_counts.bodies == before.bodies;
  if (was_drawn) m_counts = m_picture.counts();
}

RestPicture& Curtain::rest() {
  if (!m_rest) {
    auto made = std::make_unique<RestPicture>(m_picture);
    const std::lock_guard lock(m_guard);
    m_rest = std::move(made);
  }
  return *m_rest;
}

const Renderer& Curtain::renderer() {
  if (m_settings.curtain) return rest().renderer();
  throw InputError({"pick", "at_rest", "no curtain", "curtain = true before it"});
}

void Curtain::interrupt() {
  const std::lock_guard lock(m_guard);
  if (m_rest) m_rest->interrupt();
}

std::optional<RestPane> Curtain::next(double budget_ms) {
  if (!m_settings.curtain) return std::nullopt;
  const LivePicture::Counts now = m_picture.counts();
  if (now.bodies != m_counts.bodies) {
    const std::lock_guard lock(m_guard);
    m_rest.reset();
    m_stale.fill(1);
  }
  if (now.bodies != m_counts.bodies || now.looks != m_counts.looks) m_stale[0] = 2;
  m_counts = now;
  for (int view = 0; view < kViewCount; ++view) {
    int& stale = m_stale[std::size_t(view)];
    const PixelSize& size = m_settings.sizes[std::size_t(view)];
    if (size[0] == 0 || size[1] == 0) stale = 0;
    const bool is_due = stale == 2 || (stale == 1 && m_picture.settled());
    if (!is_due) continue;
    if (view == 0) return next_in_space(budget_ms);
    stale = 0;
    return slice(view);
  }
  return std::nullopt;
}

std::optional<RestPane> Curtain::next_in_space(double budget_ms) {
  RestPane pane;
  pane.is_settled = m_stale[0] == 1;
  if (!pane.is_settled) {
    pane.image = rest().draft(budget_ms);
    m_stale[0] = 1;
    return pane;
  }
  std::optional<Image> settled = rest().settled();
  if (!settled) return std::nullopt;
  pane.image = std::move(*settled);
  m_stale[0] = 0;
  return pane;
}

RestPane Curtain::slice(int view) {
  const PixelSize& size = m_settings.sizes[std::size_t(view)];
  SlicePane pane = draw_pane(m_picture.opened(), m_settings.slices, view - 1, size, nullptr,
                             nullptr, ScalarRange(), 1);
  return {view, true, std::move(pane.image), pane.pixels};
}

}  // namespace supple::tools
