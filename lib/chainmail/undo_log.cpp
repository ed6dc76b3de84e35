#include "lib/chainmail/undo_log.h"

#include <algorithm>

namespace supple {

void UndoLog::roll_back(BrickValues& values) {
  for (std::size_t n = 0; n < m_bricks.size(); ++n) {
    if (m_copies[n] == kNotStored) {
      values.release(m_bricks[n]);
    } else {
      std::copy_n(saved(n), kBrickVoxels, values.touch(m_bricks[n]));
    }
  }
  clear();
}

void UndoLog::clear(std::size_t kept_bricks) {
  for (const std::size_t brick : m_bricks) {
    (*m_pages[brick / kPageBricks])[brick % kPageBricks] = 0;
  }
  m_bricks.clear();
  m_copies.clear();
  m_copied = 0;
  const std::size_t kept_chunks = kept_bricks / kChunkBricks;
  while (m_chunks.size() > kept_chunks) m_chunks.pop_back();
}

std::size_t UndoLog::bytes() const {
  std::size_t total = m_chunks.size() * sizeof(Chunk) +
                      (m_bricks.capacity() + m_copies.capacity()) * sizeof(std::size_t);
  for (const auto& page : m_pages) total += page ? sizeof(Page) : 0;
  return total;
}

void UndoLog::record(std::size_t brick, const BrickValues& values) {
  const std::size_t page = brick / kPageBricks;
  if (page >= m_pages.size()) m_pages.resize(page + 1);
  if (!m_pages[page]) m_pages[page] = std::make_unique<Page>();
  const std::int32_t* before = values.brick(brick);
  m_copies.push_back(before == nullptr ? kNotStored : m_copied);
  if (before != nullptr) {
    if (m_copied == m_chunks.size() * kChunkBricks) {
      // Not zeroed: every copy overwrites its part.
      m_chunks.push_back(std::unique_ptr<Chunk>(new Chunk));
    }
    std::copy_n(before, kBrickVoxels, copy(m_copied++));
  }
  m_bricks.push_back(brick);
  (*m_pages[page])[brick % kPageBricks] = std::uint32_t(m_bricks.size());
}

}  // namespace supple
