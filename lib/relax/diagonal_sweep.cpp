#include "lib/relax/diagonal_sweep.h"

#include <algorithm>
#include <limits>

#include "lib/relax/node_rows.h"
#include "volumes/base/parallel.h"
#include "volumes/base/simd.h"

namespace supple {

namespace {

/// Fills all 1,000 values of `out`; `sources` by direction of the brick.
template <class From, class To>
void pad(const std::array<const From*, kDirections>& sources, PaddedBrick<To>& out) {
  for (int i = -1; i <= 8; ++i) {
    for (int j = -1; j <= 8; ++j) {
      const From* const* along = &sources[std::size_t(direction_of_step(i >> 3, j >> 3, 0))];
      const int first = 64 * (i & 7) + 8 * (j & 7);
      To* row = out.row(i, j);
      row[-1] = To(along[-1][first + 7]);
      for (int k = 0; k < 8; ++k) row[k] = To(along[0][first + k]);
      row[8] = To(along[1][first]);
    }
  }
}

}  // namespace

std::vector<std::int16_t> classes_of_bricks(const Body& body) {
  std::vector<std::int16_t> classes(body.elements.brick_count());
  parallel_for(classes.size(), Grain{4}, [&](std::size_t b) {
    int least = kLastClass, most = 0;
    for_each_active(body.elements.mask(b), [&](int offset) {
      const int here = body.classes[b * kBrickVoxels + std::size_t(offset)];
      least = std::min(least, here);
      most = std::max(most, here);
    });
    classes[b] = std::int16_t(least == most ? least : -1);
  });
  return classes;
}

int brick_colour(const Vec3i& origin) {
  return (origin.x >> 3 & 1) << 2 | (origin.y >> 3 & 1) << 1 | (origin.z >> 3 & 1);
}

void load_brick(const Body& body, int links, std::size_t b, const BrickArray<double>& offsets,
                const std::vector<std::int16_t>& one_class, DiagonalBrick& out) {
  static constexpr double kAtRest[kBrickVoxels] = {};
  static constexpr std::uint8_t kNoClasses[kBrickVoxels] = {};
  const BrickNeighbours bricks = neighbours_of(body.elements, b);
  find_links(body.elements, body.cuts, links, bricks, out.links);
  out.colour = brick_colour(body.elements.origin(b));
  out.of_one_class = one_class[b];
  std::array<const double*, kDirections> values;
  std::array<const std::uint8_t*, kDirections> classes;
  for (std::size_t direction = 0; direction < kDirections; ++direction) {
    const bool exists = bricks[direction] >= 0;
    const auto other = std::size_t(exists ? bricks[direction] : 0);
    values[direction] = exists ? offsets.brick_or_zero(other) : kAtRest;
    classes[direction] = exists ? body.classes.data() + kBrickVoxels * other : kNoClasses;
    if (exists && one_class[other] != out.of_one_class) out.of_one_class = -1;
  }
  pad(values, out.offsets);
  if (out.of_one_class < 0) pad(classes, out.classes);
}

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr unsigned kWholeRow = 0xff;
using EntryRow = Pack<std::int32_t, 8>;

/// Table of the nodes of a row that come in a pass before their neighbours in a direction.
class PassOrder {
 public:
  PassOrder() {
    for (int colour = 0; colour < 8; ++colour) {
      for (int row = 0; row < 64; ++row) {
        for (int direction = 0; direction < kDirections; ++direction) {
          m_first[colour][row][direction] = first_of(colour, row / 8, row % 8, direction);
        }
      }
    }
  }
  const std::uint8_t* of_row(int colour, int i, int j) const { return m_first[colour][8 * i + j]; }

 private:
  /// Order in a pass of a node of the brick or of the layer around it.
  static int order_of(int colour, int i, int j, int k) {
    const int brick = colour ^ ((i >> 3 & 1) << 2 | (j >> 3 & 1) << 1 | (k >> 3 & 1));
    return brick << 3 | (i & 1) << 2 | (j & 1) << 1 | (k & 1);
  }
  static std::uint8_t first_of(int colour, int i, int j, int direction) {
    const LinkStep step = step_of_direction(direction);
    unsigned bits = 0;
    for (int k = 0; k < 8; ++k) {
      const int here = order_of(colour, i, j, k);
      bits |= unsigned(here < order_of(colour, i + step[0], j + step[1], k + step[2])) << k;
    }
    return std::uint8_t(bits);
  }

  std::uint8_t m_first[8][64][kDirections];
};

/// Values of eight links, in the direction away from a node; `other` is the far end.
struct AwayRow {
  NodeRow stiffness, wider, narrower;  // limits of other - here and of here - other
};

inline NodeRow chosen_or(unsigned bits, NodeRow row, double otherwise) {
  constexpr MaskRow kBit = {1, 2, 4, 8, 16, 32, 64, 128};
  const MaskRow set = (MaskRow{} + std::int64_t(bits)) & kBit;
  return set != 0 ? row : NodeRow{} + otherwise;
}

/// Pull of the links of eight nodes, and how far these may rise and sink.
struct RowAsk {
  NodeRow force{}, stiffness{};
  NodeRow rise = NodeRow{} + kInfinity, sink = NodeRow{} + kInfinity;
};

class BrickSweep {
 public:
  BrickSweep(DiagonalBrick& brick, const LinkTable& table, const DiagonalSweep& sweep)
      : m_brick(brick), m_table(table), m_sweep(sweep), m_kinds(kinds_of(table.links())) {
    for (int kind = 0; kind < kLinkKinds; ++kind) {
      m_kind_of[kDirectionOfKind[std::size_t(kind)]] = kind;
      m_kind_of[opposite_direction(kDirectionOfKind[std::size_t(kind)])] = kind;
      if (kind >= m_kinds || brick.of_one_class < 0) continue;
      const LinkValues& link = table.values(kind, brick.of_one_class, brick.of_one_class);
      m_one_class[kind] = {NodeRow{} + double(link.stiffness),
                           NodeRow{} + double(link.upper) * kFinePerUnit,
                           NodeRow{} + double(link.lower) * kFinePerUnit};
    }
  }

  SweepOutcome run(const BrickMask& free, double* out) {
    for (int colour = 0; colour < 4; ++colour) {
      for (int i = colour >> 1; i < 8; i += 2) {
        for (int j = colour & 1; j < 8; j += 2) {
          step_row(i, j, unsigned(free[std::size_t(i)] >> (8 * j)) & kWholeRow, out);
        }
      }
    }
    return outcome_of(m_energy, m_least, m_largest);
  }

 private:
  AwayRow links_of(int direction, unsigned bits, int i, int j) const {
    const int kind = m_kind_of[direction];
    const bool upwards = direction > kNoStep;
    if (m_brick.of_one_class < 0) {
      const LinkRow link = look_up_row(kind, direction, bits, i, j);
      return upwards ? AwayRow{link.stiffness, link.upper, link.lower}
                     : AwayRow{link.stiffness, link.lower, link.upper};
    }
    AwayRow away = m_one_class[kind];
    if (!upwards) std::swap(away.wider, away.narrower);
    if (bits == kWholeRow) return away;
    return {chosen(bits, away.stiffness), chosen_or(bits, away.wider, kInfinity),
            chosen_or(bits, away.narrower, kInfinity)};
  }

  LinkRow look_up_row(int kind, int direction, unsigned bits, int i, int j) const {
    constexpr EntryRow kBit = {1, 2, 4, 8, 16, 32, 64, 128};
    const LinkStep step = step_of_direction(direction);
    EntryRow here, other;
    std::memcpy(&here, m_brick.classes.row(i, j), sizeof here);
    std::memcpy(&other, m_brick.classes.row(i + step[0], j + step[1]) + step[2], sizeof other);
    const EntryRow set = (EntryRow{} + std::int32_t(bits)) & kBit;
    const EntryRow entries =
        set != 0 ? here * m_table.stride() + other : EntryRow{} + m_table.missing();
    alignas(32) std::int32_t places[8];
    std::memcpy(places, &entries, sizeof places);
    return look_up(m_table.row(kind), places);
  }

  /// Adds links in one direction; their energy counts at nodes that are `counted` and come first.
  void ask_links(int direction, int i, int j, NodeRow here, unsigned counted, RowAsk& ask) {
    const unsigned bits =
        unsigned(m_brick.links[std::size_t(direction)][std::size_t(i)] >> (8 * j)) & kWholeRow;
    if (bits == 0) return;
    const LinkStep step = step_of_direction(direction);
    const AwayRow away = links_of(direction, bits, i, j);
    const NodeRow stretch = load(m_brick.offsets.row(i + step[0], j + step[1]) + step[2]) - here;
    const NodeRow force = away.stiffness * stretch;
    ask.force += force;
    ask.stiffness += away.stiffness;
    ask.rise = lanes_min(ask.rise, away.narrower + stretch);
    ask.sink = lanes_min(ask.sink, away.wider - stretch);
    m_energy += chosen(m_first[direction] & counted, force * stretch);
  }

  NodeRow step_of(const RowAsk& ask, int i, int j, NodeRow here) const {
    const SweepRule& rule = m_sweep.rule;
    const NodeRow wanted = ask.force * rule.relaxation / (ask.stiffness + kNoStiffness);
    NodeRow up = NodeRow{} + kInfinity, down = up;
    if (rule.limited) {
      up = ask.rise * rule.share;
      down = ask.sink * rule.share;
    }
    if (m_sweep.bounds != nullptr) {
      const int first = 64 * i + 8 * j;
      up = lanes_min(up, lanes_max(NodeRow{}, load(m_sweep.bounds->most + first) - here));
      down = lanes_min(down, lanes_max(NodeRow{}, here - load(m_sweep.bounds->least + first)));
    }
    return truncated(lanes_max(-down, lanes_min(up, wanted)));
  }

  /// Steps one row. The eight rows around it stay meanwhile, so their links are asked once.
  void step_row(int i, int j, unsigned free, double* out) {
    static const PassOrder kOrder;
    m_first = kOrder.of_row(m_brick.colour, i, j);
    double* const row = m_brick.offsets.row(i, j);
    NodeRow here = load(row);
    RowAsk around;
    for (int direction = 0; direction < kDirections; ++direction) {
      if (direction / 3 == kNoStep / 3) continue;
      ask_links(direction, i, j, here, kWholeRow, around);
    }
    const unsigned colours[2] = {m_sweep.at_once ? kWholeRow : 0x55u, m_sweep.at_once ? 0u : 0xaau};
    for (const unsigned colour : colours) {
      if (colour == 0) continue;
      RowAsk ask = around;
      ask_links(direction_along(2, false), i, j, here, colour, ask);
      ask_links(direction_along(2, true), i, j, here, colour, ask);
      m_least = lanes_min(m_least, chosen_or(colour, lanes_min(ask.rise, ask.sink), kInfinity));
      const NodeRow step = chosen(free & colour, step_of(ask, i, j, here));
      here += step;
      m_largest = lanes_max(m_largest, lanes_max(step, -step));
      if (!m_sweep.at_once) std::memcpy(row, &here, sizeof here);
    }
    std::memcpy(out + 64 * i + 8 * j, &here, sizeof here);
  }

  DiagonalBrick& m_brick;
  const LinkTable& m_table;
  const DiagonalSweep& m_sweep;
  int m_kinds;
  int m_kind_of[kDirections] = {};
  AwayRow m_one_class[kLinkKinds];  // upwards, of a brick of one class
  const std::uint8_t* m_first = nullptr;
  NodeRow m_energy{}, m_largest{}, m_least = NodeRow{} + kInfinity;
};

}  // namespace

SweepOutcome sweep_brick(DiagonalBrick& brick, const LinkTable& table, const BrickMask& free,
                         const DiagonalSweep& sweep, double* out) {
  return BrickSweep(brick, table, sweep).run(free, out);
}

}  // namespace supple
