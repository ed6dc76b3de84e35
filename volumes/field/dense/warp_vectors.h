// The vectors of a dense warp, i fastest, kept in runs of 512 where some is not 0: that of a local
// drag takes memory where tissue moves. Cost: 12 bytes per vector of a run that is kept, 8 bytes
// per run.
#pragma once

#include <vector>

#include "volumes/grid/brick_values.h"

namespace supple {

class WarpVectors {
 public:
  WarpVectors() = default;
  /// Makes `count` vectors, all 0.
  explicit WarpVectors(std::size_t count);
  WarpVectors(const std::vector<Vec3f>& all);

  std::size_t size() const { return m_count; }
  Vec3f operator[](std::size_t n) const { return m_runs.at(n); }
  std::vector<Vec3f> all() const;
  std::size_t bytes() const { return m_runs.bytes(); }

  /// Replaces `count` vectors from number `first` on.
  void put(std::size_t first, const Vec3f* vectors, std::size_t count);

  friend bool operator==(const WarpVectors& a, const WarpVectors& b) {
    return a.m_count == b.m_count && a.m_runs == b.m_runs;
  }

 private:
  std::size_t m_count = 0;
  BrickVectors m_runs;
};

}  // namespace supple
