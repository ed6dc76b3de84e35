#include "lib/chainmail/brick_kernel.h"

#include <algorithm>
#include <cstring>

#include "lib/chainmail/brick_vectors.h"

#ifdef __AVX512VBMI__
#include <immintrin.h>
#endif

namespace supple {

namespace {

constexpr std::uint64_t kAllBits = ~std::uint64_t(0);
/// Distance in a brick to the next voxel along each axis.
constexpr int kOffsetStep[3] = {64, 8, 1};

/// kNoLink in the `Step` lanes that no other lane reaches, and a mask of the other lanes.
template <int Step>
struct Edge {
  Rows no_link{}, reached{};
  Edge() {
    for (int lane = 0; lane < kLanes; ++lane) {
      const int from = lane % kRowLanes - Step;
      const bool inside = from >= 0 && from < kRowLanes;
      no_link[lane] = inside ? 0 : kNoLink;
      reached[lane] = inside ? ~Level(0) : 0;
    }
  }
};

/// a + b for costs up to kNoLink, at most kNoLink.
inline Rows capped_sum(Rows a, Rows b) {
  const Rows room = Rows{} + kNoLink - b;
  return (a < room ? a : room) + b;
}

#ifdef __AVX512VBMI__
/// 64 costs at a time from a table in 16 vector registers: three times as fast as loads.
class ByteTable {
 public:
  explicit ByteTable(const std::vector<std::uint8_t>& bytes) {
    for (int n = 0; n < 8; ++n) {
      m_low[n] = _mm512_loadu_si512(bytes.data() + 64 * n);
      m_high[n] = _mm512_loadu_si512(bytes.data() + 512 + 64 * n);
    }
  }

  void look_up(const std::uint16_t* index, Level* out) const {
    const __m512i first = _mm512_loadu_si512(index), second = _mm512_loadu_si512(index + 32);
    const __m512i within = narrow(first, second);
    const __m512i block = narrow(_mm512_srli_epi16(first, 7), _mm512_srli_epi16(second, 7));
    const __mmask64 odd = _mm512_test_epi8_mask(block, _mm512_set1_epi8(1));
    const __mmask64 upper = _mm512_test_epi8_mask(block, _mm512_set1_epi8(2));
    const __m512i low = entries(m_low, within, odd, upper);
    const __m512i high = entries(m_high, within, odd, upper);
    store(_mm512_extracti32x4_epi32(low, 0), _mm512_extracti32x4_epi32(high, 0), out);
    store(_mm512_extracti32x4_epi32(low, 1), _mm512_extracti32x4_epi32(high, 1), out + 16);
    store(_mm512_extracti32x4_epi32(low, 2), _mm512_extracti32x4_epi32(high, 2), out + 32);
    store(_mm512_extracti32x4_epi32(low, 3), _mm512_extracti32x4_epi32(high, 3), out + 48);
  }

 private:
  static __m512i narrow(__m512i first, __m512i second) {
    return _mm512_inserti64x4(_mm512_castsi256_si512(_mm512_cvtepi16_epi8(first)),
                              _mm512_cvtepi16_epi8(second), 1);
  }
  /// 128 bytes per instruction, chosen by the low 7 bits; the masks choose among the four.
  static __m512i entries(const __m512i* table, __m512i within, __mmask64 odd, __mmask64 upper) {
    const __m512i lower_half =
        _mm512_mask_blend_epi8(odd, _mm512_permutex2var_epi8(table[0], within, table[1]),
                               _mm512_permutex2var_epi8(table[2], within, table[3]));
    const __m512i upper_half =
        _mm512_mask_blend_epi8(odd, _mm512_permutex2var_epi8(table[4], within, table[5]),
                               _mm512_permutex2var_epi8(table[6], within, table[7]));
    return _mm512_mask_blend_epi8(upper, lower_half, upper_half);
  }
  static void store(__m128i low, __m128i high, Level* out) {
    const __m512i cost = _mm512_or_si512(_mm512_cvtepu8_epi32(low),
                                         _mm512_slli_epi32(_mm512_cvtepu8_epi32(high), 8));
    const __mmask16 missing = _mm512_cmpeq_epi32_mask(cost, _mm512_set1_epi32(0xffff));
    _mm512_storeu_si512(out, _mm512_mask_mov_epi32(cost, missing, _mm512_set1_epi32(int(kNoLink))));
  }

  __m512i m_low[8], m_high[8];
};
#endif

}  // namespace

/// Looks costs up. Plain loads beat the gather instructions.
void gather_costs(const CostRow& row, const std::uint16_t* __restrict index, int count,
                  Level* __restrict out) {
  if (row.is_uniform) {
    std::fill(out, out + count, row.levels.front());
    return;
  }
#ifdef __AVX512VBMI__
  if (!row.bytes.empty()) {
    const ByteTable table(row.bytes);
    for (int n = 0; n < count; n += 64) table.look_up(index + n, out + n);
    return;
  }
#endif
  const Level* __restrict levels = row.levels.data();
  for (int n = 0; n < count; ++n) out[n] = levels[index[n]];
}

namespace {

/// Entries of a cost row for the links from every voxel to the one `stride` offsets on.
void link_entries(const std::uint8_t* __restrict classes, int offset_step, int class_stride,
                  std::uint16_t* __restrict out) {
  const int count = kBrickVoxels - offset_step;
  for (int n = 0; n < count; ++n) {
    out[n] = std::uint16_t(classes[n] * class_stride + classes[n + offset_step]);
  }
  std::fill(out + count, out + kBrickVoxels, std::uint16_t(0));
}

/// Costs to reach a voxel in 1, 2 and 4 steps along its row from the cost of each single link,
/// given in the lane of its low end.
template <int Way>
void sum_along_rows(const Level* links, Level (&out)[3][64][8]) {
  static const Edge<Way> one;
  static const Edge<2 * Way> two;
  static const Edge<4 * Way> four;
  Rows* to1 = reinterpret_cast<Rows*>(out[0]);
  Rows* to2 = reinterpret_cast<Rows*>(out[1]);
  Rows* to4 = reinterpret_cast<Rows*>(out[2]);
  for (int n = 0; n < kVectors; ++n) {
    Rows w;
    std::memcpy(&w, links + n * kLanes, sizeof w);
    const Rows entering = Way > 0 ? moved<1>(w) : w;
    const Rows w1 = (entering & one.reached) | one.no_link;
    const Rows w2 = (capped_sum(w1, moved<Way>(w1)) & two.reached) | two.no_link;
    const Rows w4 = (capped_sum(w2, moved<2 * Way>(w2)) & four.reached) | four.no_link;
    to1[n] = w1;
    to2[n] = w2;
    to4[n] = w4;
  }
}

}  // namespace

void remove_missing(std::uint64_t links, int rows, Level* costs) {
  if (links == kAllBits) return;
  constexpr SlackRow kBit = {1, 2, 4, 8, 16, 32, 64, 128};
  for (int r = 0; r < rows; ++r) {
    SlackRow row;
    std::memcpy(&row, costs + 8 * r, sizeof row);
    const SlackRow bits = (SlackRow{} + Level(links >> (8 * r) & 0xff)) & kBit;
    row = bits == 0 ? SlackRow{} + kNoLink : row;
    std::memcpy(costs + 8 * r, &row, sizeof row);
  }
}

namespace {

void look_up_along_i(const CostRow& row, const std::uint16_t* entries, const BrickMask& links,
                     Level (&out)[7][64]) {
  gather_costs(row, entries, 7 * 64, out[0]);
  for (int p = 0; p < 7; ++p) remove_missing(links[p], 8, out[p]);
}

void look_up_along_j(const CostRow& row, const std::uint16_t* entries, const BrickMask& links,
                     Level (&out)[8][8][8]) {
  constexpr std::uint64_t kLastRow = std::uint64_t(0xff) << 56;
  gather_costs(row, entries, kBrickVoxels, out[0][0]);
  for (int plane = 0; plane < 8; ++plane) {
    remove_missing(links[plane] | kLastRow, 7, out[plane][0]);
  }
}

void look_up_along_k(const CostRow& row, const std::uint16_t* entries, const BrickMask& links,
                     Level* out) {
  constexpr std::uint64_t kLastColumn = 0x8080808080808080u;
  gather_costs(row, entries, kBrickVoxels, out);
  for (int plane = 0; plane < 8; ++plane) {
    remove_missing(links[plane] | kLastColumn, 8, out + 64 * plane);
  }
}

/// Mask that maps q to its level and back, but for the bias: to itself or to its mirror image.
Level flip_of(Direction direction) {
  return direction == Direction::raise ? 0 : ~Level(0);
}

bool sweep_i(const BrickCosts& costs, Rows* levels) {
  const Rows* up = reinterpret_cast<const Rows*>(costs.i[1]);
  const Rows* down = reinterpret_cast<const Rows*>(costs.i[0]);
  Rows changed{};
  for (int n = 0; n < kPlaneVectors; ++n) {
    Rows* column = levels + n;
    Rows level = column[0];
    const auto step = [&](int to, Rows cost) {
      const Rows before = column[to * kPlaneVectors];
      level = larger(before, level - cost);
      changed |= level ^ before;
      column[to * kPlaneVectors] = level;
    };
    for (int p = 0; p < 7; ++p) step(p + 1, up[p * kPlaneVectors + n]);
    for (int p = 6; p >= 0; --p) step(p, down[p * kPlaneVectors + n]);
  }
  return any_set(changed);
}

bool sweep_j(const BrickCosts& costs, SlackRow* levels) {
  SlackRow changed{};
  for (int plane = 0; plane < 8; ++plane) {
    const SlackRow* up = reinterpret_cast<const SlackRow*>(costs.j[1][plane]);
    const SlackRow* down = reinterpret_cast<const SlackRow*>(costs.j[0][plane]);
    SlackRow* rows = levels + 8 * plane;
    SlackRow level = rows[0];
    const auto step = [&](int to, SlackRow cost) {
      const SlackRow before = rows[to];
      level = larger(before, level - cost);
      changed |= level ^ before;
      rows[to] = level;
    };
    for (int p = 0; p < 7; ++p) step(p + 1, up[p]);
    for (int p = 6; p >= 0; --p) step(p, down[p]);
  }
  return any_set(changed);
}

bool sweep_k(const BrickCosts& costs, Rows* levels) {
  const Rows *up[3], *down[3];
  for (int n = 0; n < 3; ++n) {
    up[n] = reinterpret_cast<const Rows*>(costs.k[1][n]);
    down[n] = reinterpret_cast<const Rows*>(costs.k[0][n]);
  }
  Rows changed{};
  for (int n = 0; n < kVectors; ++n) {
    const Rows before = levels[n];
    Rows level = before;
    level = larger(level, moved<1>(level) - up[0][n]);
    level = larger(level, moved<2>(level) - up[1][n]);
    level = larger(level, moved<4>(level) - up[2][n]);
    level = larger(level, moved<-1>(level) - down[0][n]);
    level = larger(level, moved<-2>(level) - down[1][n]);
    level = larger(level, moved<-4>(level) - down[2][n]);
    changed |= level ^ before;
    levels[n] = level;
  }
  return any_set(changed);
}

}  // namespace

BrickLinks links_inside(const BrickMask& elements, const LinkCuts::BrickCuts* cuts) {
  constexpr std::uint64_t kLastRow = std::uint64_t(0xff) << 56;
  constexpr std::uint64_t kLastColumn = 0x8080808080808080u;
  BrickLinks links{};
  for (int plane = 0; plane < 8; ++plane) {
    const std::uint64_t bits = elements[plane];
    if (plane < 7) links[0][plane] = bits & elements[plane + 1];
    links[1][plane] = bits & (bits >> 8) & ~kLastRow;
    links[2][plane] = bits & (bits >> 1) & ~kLastColumn;
    if (cuts == nullptr) continue;
    for (int axis = 0; axis < 3; ++axis) links[axis][plane] &= ~(*cuts)[axis][plane];
  }
  return links;
}

void look_up_costs(const LinkCosts& costs, const std::uint8_t* classes, const BrickLinks& links,
                   BrickCosts& out) {
  alignas(64) std::uint16_t entries[kBrickVoxels];
  alignas(64) Level along_k[kBrickVoxels];
  for (int axis = 0; axis < 3; ++axis) {
    out.any[axis] = links[axis] != BrickMask{};
    if (!out.any[axis]) continue;
    link_entries(classes, kOffsetStep[axis], costs.stride(), entries);
    for (const bool upward : {false, true}) {
      const bool looked_up = upward && costs.is_symmetric(axis);
      const CostRow& row = costs.row(axis, upward);
      if (axis == 0 && !looked_up) look_up_along_i(row, entries, links[0], out.i[upward]);
      if (axis == 0 && looked_up) std::memcpy(out.i[1], out.i[0], sizeof out.i[0]);
      if (axis == 1 && !looked_up) look_up_along_j(row, entries, links[1], out.j[upward]);
      if (axis == 1 && looked_up) std::memcpy(out.j[1], out.j[0], sizeof out.j[0]);
      if (axis == 2 && !looked_up) look_up_along_k(row, entries, links[2], along_k);
      if (axis == 2 && upward) sum_along_rows<1>(along_k, out.k[1]);
      if (axis == 2 && !upward) sum_along_rows<-1>(along_k, out.k[0]);
    }
  }
}

void load_levels(const std::int32_t* q, Direction direction, Level* levels) {
  const Level flip = flip_of(direction);
  for (int n = 0; n < kBrickVoxels; ++n) levels[n] = kLevelBias + ((Level(q[n]) ^ flip) - flip);
}

unsigned store_levels(const Level* levels, Direction direction, std::int32_t* q) {
  const Level flip = flip_of(direction);
  SlackRow planes[8] = {}, rows[8] = {}, all{};
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      SlackRow level, before;
      std::memcpy(&level, levels + 64 * i + 8 * j, sizeof level);
      std::memcpy(&before, q + 64 * i + 8 * j, sizeof before);
      const SlackRow after = ((level - kLevelBias) ^ flip) - flip;
      const SlackRow changed = after ^ before;
      planes[i] |= changed;
      rows[j] |= changed;
      std::memcpy(q + 64 * i + 8 * j, &after, sizeof after);
    }
    all |= planes[i];
  }
  const bool faces[6] = {any_set(planes[0]), any_set(planes[7]), any_set(rows[0]),
                         any_set(rows[7]),   all[0] != 0,        all[7] != 0};
  unsigned bits = 0;
  for (int face = 0; face < 6; ++face) bits |= unsigned(faces[face]) << face;
  return bits;
}

void look_up_face_costs(const CostRow& row, int stride, const std::uint8_t* low_classes,
                        const std::uint8_t* high_classes, std::uint64_t links, Level* out) {
  alignas(64) std::uint16_t entries[64];
  for (int n = 0; n < 64; ++n) {
    entries[n] = std::uint16_t(low_classes[n] * stride + high_classes[n]);
  }
  gather_costs(row, entries, 64, out);
  remove_missing(links, 8, out);
}

bool close_rows(const BrickCosts& costs, Level* levels) {
  return sweep_k(costs, reinterpret_cast<Rows*>(levels));
}

int close_brick(const BrickCosts& costs, Level* levels) {
  int axes[3], count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (costs.any[axis]) axes[count++] = axis;
  }
  if (count == 0) return 0;
  Rows* wide = reinterpret_cast<Rows*>(levels);
  int sweeps = 0;
  for (int quiet = 0; quiet < count; ++sweeps) {
    const int axis = axes[sweeps % count];
    const bool changed = axis == 0   ? sweep_i(costs, wide)
                         : axis == 1 ? sweep_j(costs, reinterpret_cast<SlackRow*>(levels))
                                     : sweep_k(costs, wide);
    // A sweep closes its own axis, so it counts as quiet itself.
    quiet = changed ? 1 : quiet + 1;
  }
  return sweeps;
}

}  // namespace supple
