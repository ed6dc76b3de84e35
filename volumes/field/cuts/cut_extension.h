// The displacement in the air around a body with cuts: from either side of a cut on its own.
// Which voxels carry on to one of the air follows from the links alone and is kept. Cost: about 5
// µs per voxel of air within three voxels of a parted cell once, and 1 kB per brick of it.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "volumes/field/cuts/cut_body.h"
#include "volumes/field/cuts/moved_bricks.h"

namespace supple {

class CutExtension {
 public:
  /// `voxels`: elements and shell; both outlive the extension.
  CutExtension(const BrickTopology& voxels, const BrickTopology& elements);

  /// Follows a body whose links and parted cells have changed, and displacements that have changed
  /// in the `given` bricks: `plain` is extended as if nothing were cut, and has the bricks of `u`,
  /// which is left as extended beside cuts. Returns where u has changed.
  DisplacedBricks follow(VectorBricks& u, const VectorBricks& plain, const CutBody& body,
                         const CutBody::Changes& changes, const BrickList& given);
  /// Bricks that the last follow() has filled.
  std::int64_t filled() const { return m_filled; }

 private:
  /// Rings of voxels around the elements: 0 for elements, kRings + 1 for all beyond the last.
  using Rings = std::array<std::uint8_t, kBrickVoxels>;
  static constexpr int kRingsOfSide = 4;  // beside a cut, from the elements of the own side
  /// A voxel by where its vector is.
  struct Place {
    std::int32_t brick = -1, offset = 0;
  };
  /// A voxel that carries on to another one, and the one behind it, if there is one.
  struct Carrier {
    Place near, behind;
  };
  struct Filled {
    std::int32_t offset;
    std::int32_t end;  // of its carriers
  };
  struct OfBrick {
    BrickMask beside{};  // air beside parted cells
    Rings at_first, rings;
    std::array<std::vector<Filled>, kRingsOfSide + 1> filled;  // by their rings
    std::array<std::vector<Carrier>, kRingsOfSide + 1> carriers;
  };

  BrickList find_beside(const CutBody& body, const BrickList& parted);
  BrickList filled_beside(const BrickList& seen, const BrickList& changed) const;
  void plan(const CutBody& body, const BrickList& bricks);
  std::vector<Carrier> carriers_of(const CutBody& body, const Vec3i& voxel, int ring) const;
  void fill(VectorBricks& u, const BrickList& bricks) const;
  BrickMask beside_parted(const CutBody& body, std::size_t b) const;
  OfBrick& touch(std::size_t b);
  Rings rings_of(std::size_t b) const;
  int ring_at(const Vec3i& voxel) const;

  const BrickTopology& m_voxels;
  const BrickTopology& m_elements;
  std::int64_t m_filled = 0;
  std::vector<std::unique_ptr<OfBrick>> m_bricks;  // null: far from parted cells
};

/// u extended over the shell anew where a cut parts it: each voxel there looks at its own side
/// only. Everything else keeps its bits.
void extend_beside_cuts(VectorBricks& u, const CutBody& body);

}  // namespace supple
