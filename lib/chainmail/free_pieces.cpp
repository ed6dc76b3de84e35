#include "lib/chainmail/free_pieces.h"

#include <algorithm>
#include <map>

namespace supple {

namespace {

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
    m_sizes.push_back(is_held ? 0 : piece.elements->size());
    m_count += !is_held;
  }
}

std::vector<Seed> FreePieces::lagging(const BrickValues& now, const Before& before,
                                      Direction direction,
                                      const std::vector<std::size_t>& bricks) const {
  const BrickValues& number_of = *m_body->rigid.number_of;
  std::map<std::size_t, Reach> reached;
  for (const std::size_t b : bricks) {
    const std::int32_t* numbers = number_of.brick(b);
    if (numbers == nullptr) continue;
    const std::int32_t* from = before(b);
    const std::int32_t* to = now.brick_or_zero(b);
    for_each_active(m_body->elements.mask(b), [&](int offset) {
      if (numbers[offset] == 0) return;
      const auto piece = std::size_t(numbers[offset] - 1);
      if (m_is_free[piece] == 0) return;
      const std::int64_t way = std::int64_t(to[offset]) - from[offset];
      Reach& reach = reached[piece];
      if (reach.elements++ == 0) reach.least = reach.most = way;
      reach.least = std::min(reach.least, way);
      reach.most = std::max(reach.most, way);
    });
  }
  std::vector<Seed> seeds;
  for (const auto& [piece, reach] : reached) {
    const bool is_complete = reach.least == 0 || reach.elements == m_sizes[piece];
    if (reach.least == reach.most && is_complete) continue;
    const std::int64_t way = direction == Direction::raise ? reach.most : reach.least;
    for (const SlotSet::Brick& entry : m_body->rigid.list[piece].elements->bricks()) {
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

std::vector<std::size_t> FreePieces::bricks() const {
  std::vector<std::size_t> bricks;
  for (std::size_t b = 0; b < m_body->elements.brick_count(); ++b) {
    if (m_body->rigid.number_of->brick(b) != nullptr) bricks.push_back(b);
  }
  return bricks;
}

}  // namespace supple
