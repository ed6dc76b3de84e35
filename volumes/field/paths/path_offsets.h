// The offsets of one body along one path: on lattice nodes, and exactly in split bricks.
#pragma once

#include <optional>

#include "volumes/field/paths/sampling_path.h"
#include "volumes/field/split_offsets.h"
#include "volumes/geometry/geometry.h"

namespace supple {

class PathOffsets : public SplitOffsets {
 public:
  /// `body`: at rest; `moved`: its offsets when it has moved.
  PathOffsets(SamplingPath path, const Geometry& geometry, BrickTopology body);
  PathOffsets(SamplingPath path, const OffsetField& moved);

  /// Finds bricks and split bricks and samples the nodes; once.
  VectorBricks run(Progress* progress);

  bool sample(std::size_t b, const Vec3d& x, Sample& found) const override;
  bool offset_of(int piece, const Vec3d& x, Vec3d& offset) const override;
  double depth_mm(int piece, const Vec3d& x) const override;
  void source_box(std::size_t b, Vec3d& lo, Vec3d& hi) const override;

  int pieces() const { return m_pieces; }

 private:
  /// Source of x under a piece of all functions together.
  struct Origin {
    Vec3d step;       // p(x) - x, index space; exactly 0 where the path is straight
    double depth_mm;  // smallest over the functions
  };
  struct Candidate;
  struct Survey {
    Vec3d lo{HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};  // of p(x)
    bool moves = false;
    bool is_split = false;
  };
  struct Cut {
    std::vector<int> pieces;  // that may be seen in the brick
    Vec3d lo, hi;             // of p(x)
  };
  enum class Border { exact, wide };

  void count_pieces();
  double largest_spacing() const;
  std::vector<Candidate> find_candidates(Progress* progress) const;
  void reach_bricks(const std::vector<Vec3d>& points_mm, std::size_t function, int piece,
                    int stride, bool is_split, std::vector<Candidate>& found) const;
  Origin origin_of(int piece, const Vec3d& x) const;
  bool offset_before(const Vec3d& pos, Vec3d& offset) const;
  bool node_offset(const Vec3i& node, const Origin& origin, Border border, Vec3f& offset) const;
  void sample_nodes(const Vec3i& brick, const std::vector<int>& pieces, Border border,
                    BrickMask& valid, Vec3f* out) const;
  Survey survey(const Vec3i& brick, const std::vector<int>& pieces) const;

  SamplingPath m_path;
  Geometry m_geometry;
  int m_pieces = 1;
  BrickTopology m_body;                // at rest, or where the moved body is
  BrickTopology m_wide;                // at rest: nodes beyond the body that cells may need
  std::optional<OffsetField> m_moved;  // extrapolated by a ring
  Vec3d m_moved_lo{0, 0, 0}, m_moved_hi{0, 0, 0};  // its smallest and largest offsets
  std::vector<Cut> m_cuts;                         // of the split bricks
};

}  // namespace supple
