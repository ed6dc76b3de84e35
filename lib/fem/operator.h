// Interface of the solvers to a mesh of elements, whatever these are: products with symmetric
// matrices between nodes, three values per node, and a preconditioner. A call is for all nodes at
// once, so that its cost does not count beside the product.
#pragma once

#include <cstddef>
#include <vector>

#include "volumes/base/progress.h"

namespace supple {

class Operator {
 public:
  virtual ~Operator() = default;
  /// y += K x.
  virtual void add(const float* x, double* y) const = 0;
  virtual void add(const double* x, double* y) const = 0;
  /// y -= K x.
  virtual void subtract(const double* x, double* y) const = 0;
  virtual std::vector<float> diagonal() const = 0;
  virtual std::size_t bytes() const = 0;
};

/// A symmetric matrix K and a preconditioner B, nearly its inverse.
class LinearSystem {
 public:
  virtual ~LinearSystem() = default;
  /// y += K x.
  virtual void add(const float* x, double* y) const = 0;
  /// y -= K x.
  virtual void subtract(const double* x, double* y) const = 0;
  /// z = B r; `r` is used up. Its held components are 0, and those of z are to be. Throws
  /// Cancelled.
  virtual void precondition(float* r, float* z, const Progress* progress) = 0;
  /// Levels of meshes in B.
  virtual int level_count() const { return 1; }
  /// Memory of the system itself, without what it refers to.
  virtual std::size_t bytes() const { return 0; }
};

}  // namespace supple
