// Extends a sparse vector field ring by ring into voxels where it is not valid yet (design.md
// section 4: u in the air, o beyond the border of the material).
//
// Ring n are the wanted voxels with a 26-neighbour in the field after ring n - 1; each takes the
// mean of all such neighbours, or continues the field linearly from those that have another one
// behind them (Extrapolation in padded_rows.h). Sums are double and in one fixed order. So the
// result depends neither on the thread count nor on the order of bricks, and a constant field, zero
// above all, stays exactly constant. Cost: about 60 ns per new voxel and core, linearly 120 ns.
//
// The displacement of tissue goes on linearly in the two rings that a state keeps around it: with
// means its gradient would end in the outermost cell, which is where surfaces lie. SSIM against the
// displacement known in the air: docs/benchmarks/render.md.
#pragma once

#include <cstdint>
#include <vector>

#include "volumes/field/offset_field.h"

namespace supple {

/// Rings that go on linearly; those beyond take means.
enum class RingFill : int { means = 0, linear = 2 };

/// `seed` extended onto the active voxels of `target` by at most `max_rings` rings. Voxels that no
/// ring reaches stay invalid. `ring_of`, where given, receives the ring of every voxel of the
/// result (0 on the seed), laid out like its vectors.
VectorBricks fill_rings(VectorBricks seed, const BrickTopology& target, int max_rings,
                        RingFill fill, std::vector<std::uint8_t>* ring_of = nullptr);

/// Order in which a field was filled: the voxels of every brick that were valid before a ring.
class RingOrder {
 public:
  RingOrder() = default;
  /// Takes the order from the result of fill_rings().
  RingOrder(const BrickTopology& topology, const std::vector<std::uint8_t>& ring_of);

  int rings() const { return int(m_before.size()); }
  /// The voxels that were valid before ring 1, 2, … rings().
  const BrickMask& before(int ring, std::size_t b) const { return m_before[ring - 1][b]; }
  /// The last ring with voxels in brick b; 0: none.
  int last(std::size_t b) const { return m_last[b]; }

 private:
  std::vector<std::vector<BrickMask>> m_before;
  std::vector<std::uint8_t> m_last;
};

/// Brings a filled field up to date after vectors of its ring 0 have changed in the given bricks
/// (ascending): fills the rings again, linearly as fill_rings() does, wherever they can see that.
/// Returns the given bricks and those in which a vector changed, ascending.
std::vector<std::int32_t> refill_rings(VectorBricks& field, const RingOrder& order,
                                       const std::vector<std::int32_t>& changed);

}  // namespace supple
