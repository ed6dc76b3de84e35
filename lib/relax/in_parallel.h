// Loops over bricks and clusters on all threads.
#pragma once

#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace supple {

/// Calls visit(0) … visit(count - 1) in any order.
template <class Visit>
void in_parallel(std::size_t count, Visit&& visit) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 4),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t n = range.begin(); n < range.end(); ++n) visit(n);
                    });
}

}  // namespace supple
