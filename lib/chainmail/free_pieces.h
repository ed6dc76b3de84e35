// Rigid pieces in the difference constraints of one coordinate. While a piece only shifts, the
// offsets of its elements keep their differences: it is one node of the graph, joined to the tissue
// by all links of its elements. The engines know nothing of pieces. Between their runs every
// element of a piece is brought as far as the one that went furthest, until none lags behind. A
// shortest path visits a piece at most once, so there are at most as many runs as pieces on a path.
// The result is exact, the same bits whatever the order.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "lib/body/body.h"
#include "lib/chainmail/propagation.h"

namespace supple {

class FreePieces {
 public:
  FreePieces() = default;
  /// The pieces of the body, but those that one of the sets holds as a whole: these have targets or
  /// stay.
  FreePieces(const Body& body, const std::vector<const SlotSet*>& held);

  bool empty() const { return m_count == 0; }
  /// Shift of each piece by a run, from `before` to `now`; 0 for pieces that are left out.
  std::vector<std::int32_t> shifts(const BrickValues& now, const UndoLog& before) const;

  /// The offsets of a brick before the run; where it has not touched the brick, the present ones.
  /// Called from several threads.
  using Before = std::function<const std::int32_t*(std::size_t brick)>;
  /// Targets of elements that lag behind their piece.
  std::vector<Seed> lagging(const BrickValues& now, const Before& before,
                            Direction direction) const;
  /// The elements of all pieces that were not left out.
  SlotSet elements() const;

 private:
  /// The least and the most that elements of a piece went.
  struct Reach {
    std::int64_t least = INT64_MAX, most = INT64_MIN;

    void add(std::int64_t way) {
      least = std::min(least, way);
      most = std::max(most, way);
    }
  };
  Reach reach_of(const SlotSet& elements, const BrickValues& now, const Before& before) const;

  const Body* m_body = nullptr;
  std::vector<char> m_is_free;  // per piece
  std::size_t m_count = 0;
};

}  // namespace supple
