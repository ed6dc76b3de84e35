// A body with cut links, as the inversion sees it: which corners of a lattice cell are still on the
// same side.
//
// Two corners of a cell are on the same side when uncut links of that cell connect them. A cut goes
// on through the shell around the elements, where each voxel belongs to its nearest element; beside
// a surface that is known, to the nearest on its own side of it (cut_planes.h). Links there are cut
// when a cut lies between the elements of their ends, or when no tissue joins these within a few
// voxels and they have moved apart by more than one, so that no tissue is stretched over a slit of
// air through which the cut goes.
//
// All is kept by bricks, and follows where the cuts or the elements of bricks have changed; what a
// brick holds depends on the cuts and displacements around it and on nothing else. Cost: about 1 µs
// per cut link; beyond, 1 µs per shell voxel of bricks in which elements move apart.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "volumes/field/brick_lists.h"
#include "volumes/field/cuts/cut_planes.h"
#include "volumes/field/offset_field.h"
#include "volumes/grid/link_cuts.h"

namespace supple {

/// Sides of the corners of a cell, from 0; corner 4 x + 2 y + z.
struct CellSides {
  std::array<std::uint8_t, 8> of{};
  int count = 1;

  bool operator==(const CellSides& other) const { return of == other.of && count == other.count; }
};

/// A cell whose corners are voxels of several sides.
struct PartedCell {
  Vec3i cell;
  CellSides sides;

  bool operator==(const PartedCell& other) const {
    return cell == other.cell && sides == other.sides;
  }
};

/// Voxels of a brick that are no elements.
BrickMask air_in(const BrickTopology& voxels, const BrickTopology& elements, std::size_t b);

class CutBody {
 public:
  struct Link {
    Vec3i low;  // its end at the lower index
    int axis;
  };

  /// A body without cuts. `voxels`: elements and shell. Along an axis of `dims` with one slice, its
  /// copies below and above count as voxels, too.
  CutBody(const BrickTopology& voxels, const BrickTopology& elements, const Vec3i& dims);
  /// `u`: on elements and shell; those of elements count. `cuts`: links between elements, bricks as
  /// in `elements`, which outlives the body.
  CutBody(const VectorBricks& u, const BrickTopology& elements, const LinkCuts& cuts,
          const Vec3i& dims);

  /// Sets the cuts from the next follow() on.
  void set_cuts(const LinkCuts& cuts);
  struct Changes {
    BrickList links;   // of the voxels: in which links are cut or whole that were not
    BrickList parted;  // of cells(): in which parted cells or their sides are others
  };
  /// Follows displacements of elements that have changed in these bricks of the voxels.
  Changes follow(const VectorBricks& u, const BrickList& changed);

  bool has_cuts() const { return !m_planes.empty() || m_cut_links > 0; }
  bool is_cut(const Vec3i& low, int axis) const;
  /// The place where the surface crosses a link that is cut; 0: unknown.
  LinkCuts::Place place(const Link& link) const;
  const BrickTopology& voxels() const { return m_voxels; }
  const BrickTopology& elements() const { return m_elements; }
  bool is_element(const Vec3i& voxel) const { return m_elements.is_active(in_slice(voxel)); }
  /// True if uncut links lead from one corner of a cell to another.
  bool connects(const Vec3i& from, const Vec3i& to) const;
  /// The voxels with the copies of a slice: cells begin in these bricks.
  const BrickTopology& cells() const { return m_cells; }
  /// The parted cells that begin in brick b, sorted.
  const std::vector<PartedCell>& parted_in(std::size_t b) const { return m_parted[b]; }

 private:
  /// A voxel's element, and its side of the surface.
  struct Owner {
    Vec3i element;
    CutPlanes::Side side;
  };
  enum class Parting { none, always, when_apart };
  /// A link with an end in the air that a cut may part.
  struct Candidate {
    std::int16_t offset;  // of its lower end
    std::int8_t axis;
    Parting parting;
    LinkCuts::Place place;
    Vec3i low, high;  // elements of its ends
  };
  using AxisMasks = std::array<BrickMask, 3>;
  struct OfBrick {
    AxisMasks cut{};                                      // links by their lower ends
    AxisMasks of_elements{};                              // of them, those between elements
    std::vector<LinkCuts::Place> element_places, places;  // empty, or 512 per axis
    BrickMask beside_cuts{};                              // air within three voxels of a cut
    BrickMask contested{};                                // air that touches what has moved apart
    BrickMask air{};                                      // where links may be cut
    AxisMasks known{};                                    // links among which candidates are known
    std::vector<Candidate> candidates;
  };
  /// Displacements of the elements of a brick.
  struct MoveBox {
    Vec3f lo{HUGE_VALF, HUGE_VALF, HUGE_VALF}, hi{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};

    void add(const Vec3f& move) { add({move, move}); }
    void add(const MoveBox& other);
    bool is_apart() const;
  };

  Vec3i in_slice(Vec3i voxel) const;
  bool is_voxel(const Vec3i& voxel) const { return m_voxels.is_active(in_slice(voxel)); }
  const OfBrick* brick_of(const Vec3i& voxel, int& offset) const;
  OfBrick& touch(std::size_t b);
  bool is_element_cut(const Vec3i& low, int axis) const;
  bool take_over(const LinkCuts& cuts, std::size_t element_brick);
  void fit_planes();
  void mark_beside_cuts(const BrickList& bricks);

  CutPlanes::Side side_of(const Vec3i& voxel) const;
  Owner owner_of(const Vec3i& voxel) const;
  bool joins(const IndexBox& box, const Vec3i& from, const Vec3i& to, bool over_cuts) const;
  Parting parting_of(const Vec3i& a, const Vec3i& b) const;

  template <class Find>
  BrickList renew(BrickMask OfBrick::*mask, const BrickList& bricks, Find&& find);
  BrickMask contested_in(const VectorBricks& u, std::size_t b) const;
  BrickMask air_beside(std::size_t b) const;
  AxisMasks links_in_air(std::size_t b) const;
  void find_candidates(std::size_t b, const AxisMasks& links);
  bool cut_links_in(const VectorBricks& u, std::size_t b);
  std::vector<PartedCell> find_parted(std::size_t b) const;
  CellSides sides(const Vec3i& cell) const;
  void join_around(const Vec3i& cell, CellSides& sides) const;

  BrickTopology m_voxels;  // elements and shell
  const BrickTopology& m_elements;
  BrickTopology m_cells;
  Vec3i m_dims;
  std::vector<std::unique_ptr<OfBrick>> m_bricks;  // of the voxels; null: nothing to say
  std::vector<MoveBox> m_moves;                    // of the voxels' bricks
  CutPlanes m_planes;
  std::int64_t m_cut_links = 0;
  BrickList m_newly_cut;  // around what set_cuts() has changed
  std::vector<std::vector<PartedCell>> m_parted;
};

}  // namespace supple
