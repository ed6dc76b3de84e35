// Offsets without an inverse: each sample x solves y + u(y) = x for itself, by Newton on the
// displacement, and reads the source at y (design.md section 4). For pictures while a body is being
// dragged: a change costs no more than a look at how far the source bricks that it touches have
// moved.
//
// A solution begins at that of the sample before, then at those of places nearby whose images are
// known, until one lies in tissue; air is taken where none does. Where tissue comes from several
// places any of them may be found, not always the one with the smallest |o|, which invert() takes.
// Where deformed bricks crowd, a thin piece of tissue that no beginning leads to is missed.
// Cost: 0.3 kB per source brick, 0.2 kB per output brick that moving ones reach; 0.1 to 0.3 µs per
// sample in one.
#pragma once

#include <limits>
#include <memory>

#include "volumes/field/offset_field.h"

namespace supple {

class DisplacementRanges;

class ForwardOffsets final : public PointwiseOffsets {
 public:
  /// `displacement`: extended, as for invert(); `elements`: tissue, which hides the air that goes
  /// along around it; null: everything is. Both are read where they lie and outlive the offsets.
  /// Throws InputError for values that are not finite or beyond 10^6 voxels.
  explicit ForwardOffsets(const Displacement& displacement,
                          const BrickTopology* elements = nullptr);

  ~ForwardOffsets() override;

  /// The displacement, on the same voxels as before, has changed in these bricks of its topology.
  /// Nobody may sample from before it changed until then. Throws as the constructor.
  void update(const std::vector<std::int32_t>& changed);

  bool sample(std::size_t b, const Vec3d& x, Sample& found) const override;
  void source_box(std::size_t b, Vec3d& lo, Vec3d& hi) const override;
  /// (I + grad u)^-T g at the place that was read.
  Vec3d pull_back(int piece, const Vec3d& x, const Vec3d& y, const Vec3d& gradient) const override;

  std::size_t bytes() const;

 private:
  static constexpr int kSeeds = 8;  // one in every octant

  /// Sources that can be seen in an output brick.
  struct Reached {
    Reached() { seed.fill(Vec3f(std::numeric_limits<float>::quiet_NaN())); }

    IndexBox source;                       // the cells that reach it
    std::array<Vec3f, kSeeds> seed;        // offsets; not a number: none is known
    std::array<bool, kSeeds> is_tissue{};  // that they come from
  };
  struct Corners;  // of a cell
  /// Displacement and derivatives at a place.
  struct Place {
    int piece;
    Vec3d u;
    Vec3d along[3];  // columns of grad u
  };

  void find_ranges(const std::vector<std::int32_t>& changed);
  void find_reached();
  bool is_tissue(const Vec3d& y) const;
  bool is_tissue(const Vec3d& y, int piece) const;
  int seed_node(std::size_t b, const Vec3i& low) const;
  void plant_seeds(std::size_t b, const BrickIndex& index, std::vector<Reached>& reached) const;
  static void set_derivatives(const Corners& corners, const Vec3f& f, Place& place);
  bool place_at(const Vec3d& y, std::int32_t& brick, Place& place) const;
  bool corners_at(std::size_t b, const Vec3i& voxel, Corners& corners) const;
  bool is_beyond_border(const Vec3d& y) const;
  bool solve(const Vec3d& x, const Vec3d& offset, Sample& found) const;

  const VectorBricks& m_u;
  const Vec3i m_dims;
  const BrickTopology* m_elements;
  std::unique_ptr<DisplacementRanges> m_ranges;
  std::vector<IndexBox> m_reach;          // nodes that their cells reach
  std::vector<std::uint8_t> m_still;      // no corner of their cells moves
  std::vector<std::int32_t> m_tissue_of;  // the same bricks among the elements, or -1
  std::vector<Reached> m_reached;         // of bricks()
};

}  // namespace supple
