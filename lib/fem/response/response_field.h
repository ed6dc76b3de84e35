// Displacements of elements by each of some responses, and their sums: what is seen of a body that
// follows a hand. 12 bytes per element and response; a sum reads as much of the elements that are
// wanted, eight numbers at a time.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

/// A response: three values per element.
using ResponseValues = std::shared_ptr<const std::vector<float>>;

/// Lengths of the difference of two responses, at every n-th element of those where `now` is at
/// least this part of its largest.
std::vector<float> changes_between(const std::vector<float>& now, const std::vector<float>& then,
                                   std::size_t every, double least_part = 0);

class ResponseField {
 public:
  /// Adds a response, of as many elements as the others have.
  void add(ResponseValues values) { m_values.push_back(std::move(values)); }
  std::size_t size() const { return m_values.size(); }

  /// out[n] = sum of parts[r] times response r at element `begin` + n, up to `end`. Elements may be
  /// divided among threads in any way: the bits stay.
  void sum(const std::vector<double>& parts, std::size_t begin, std::size_t end, Vec3f* out) const;

  std::size_t bytes() const;

 private:
  std::vector<ResponseValues> m_values;
};

}  // namespace supple
