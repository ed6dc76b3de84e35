#include "lib/chainmail/free_pieces.h"

#include <algorithm>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

constexpr std::size_t kPiecesPerTask = 64;

bool holds_all(const SlotSet& set, const SlotSet& part) {
  return std::all_of(part.bricks().begin(), part.bricks().end(), [&](const SlotSet::Brick& entry) {
    const BrickMask* mask = set.find(entry.brick);
    if (mask == nullptr) return false;
    for (std::size_t word = 0; word < mask->size(); ++word) {
      if ((entry.mask[word] & ~(*mask)[word]) != 0) return false;
    }
    return true;
  });
}

}  // namespace

FreePieces::FreePieces(const Body& body, const std::vector<const SlotSet*>& held) : m_body(&body) {
  for (const RigidPiece& piece : body.rigid.list) {
    const bool is_held = std::any_of(held.begin(), held.end(), [&](const SlotSet* set) {
      return holds_all(*set, *piece.elements);
    });
    m_is_free.push_back(!is_held);
    m_count += !is_held;
  }
}

FreePieces::Reach FreePieces::reach_of(const SlotSet& elements, const BrickValues& now,
                                       const Before& before) const {
  const std::vector<SlotSet::Brick>& bricks = elements.bricks();
  return parallel_reduce(
      bricks.size(), Grain{kPiecesPerTask}, Reach(),
      [&](std::size_t n, Reach& reach) {
        const std::int32_t* from = before(bricks[n].brick);
        const std::int32_t* to = now.brick_or_zero(bricks[n].brick);
        if (from == to) return reach.add(0);
        for_each_active(bricks[n].mask,
                        [&](int offset) { reach.add(std::int64_t(to[offset]) - from[offset]); });
      },
      [](Reach a, const Reach& b) {
        a.least = std::min(a.least, b.least);
        a.most = std::max(a.most, b.most);
        return a;
      });
}

std::vector<Seed> FreePieces::lagging(const BrickValues& now, const Before& before,
                                      Direction direction) const {
  std::vector<Seed> seeds;
  for (std::size_t piece = 0; piece < m_is_free.size(); ++piece) {
    if (m_is_free[piece] == 0) continue;
    const SlotSet& elements = *m_body->rigid.list[piece].elements;
    const Reach reach = reach_of(elements, now, before);
    if (reach.least == reach.most) continue;
    const std::int64_t way = direction == Direction::raise ? reach.most : reach.least;
    for (const SlotSet::Brick& entry : elements.bricks()) {
      const std::int32_t* from = before(entry.brick);
      const std::int32_t* to = now.brick_or_zero(entry.brick);
      for_each_active(entry.mask, [&](int offset) {
        const std::int64_t target = from[offset] + way;
        if (direction == Direction::raise ? target <= to[offset] : target >= to[offset]) return;
        seeds.push_back({entry.brick * kBrickVoxels + Slot(offset), std::int32_t(target)});
      });
    }
  }
  return seeds;
}

std::vector<std::int32_t> FreePieces::shifts(const BrickValues& now, const UndoLog& before) const {
  std::vector<std::int32_t> shifts;
  for (std::size_t n = 0; n < m_is_free.size(); ++n) {
    const Slot first = m_body->rigid.list[n].elements->first();
    const std::int32_t* from = before.saved_of(first / kBrickVoxels);
    const bool has_moved = m_is_free[n] != 0 && from != nullptr;
    shifts.push_back(has_moved ? now.at(first) - from[first % kBrickVoxels] : 0);
  }
  return shifts;
}

SlotSet FreePieces::elements() const {
  std::vector<SlotSet::Brick> bricks;
  for (std::size_t n = 0; n < m_is_free.size(); ++n) {
    if (m_is_free[n] == 0) continue;
    const auto& own = m_body->rigid.list[n].elements->bricks();
    bricks.insert(bricks.end(), own.begin(), own.end());
  }
  return SlotSet(std::move(bricks));
}

}  // namespace supple
