// Displacements of elements by each of some responses, and their sums: what is seen of a body that
// follows a hand. 12 bytes per element and response; a sum reads as much of the elements that are
// wanted, eight numbers at a time.
#pragma once

#include <cstddef>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

class ResponseField {
 public:
  /// Adds a response: three values per element, as many as the others have.
  void add(std::vector<float> values) { m_values.push_back(std::move(values)); }
  std::size_t size() const { return m_values.size(); }

  /// out[n] = sum of parts[r] times response r at element `begin` + n, up to `end`. Elements may be
  /// divided among threads in any way: the bits stay.
  void sum(const std::vector<double>& parts, std::size_t begin, std::size_t end, Vec3f* out) const;

  /// Lengths of the difference of a response from that of another field, at every n-th element of
  /// those where its own is at least this part of the largest.
  std::vector<float> changes(std::size_t response, const ResponseField& before, std::size_t every,
                             double least_part = 0) const;
  std::size_t bytes() const;

 private:
  std::vector<std::vector<float>> m_values;
};

}  // namespace supple
