// A body cut into elements that are elastic and have mass, as modes of vibration, motion in time
// and the path of loads see it: nodes, pieces, and sums of stiffness and mass.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "lib/fem/elastic_law.h"
#include "lib/fem/fem_report.h"
#include "lib/fem/nodal_loads.h"
#include "lib/fem/operator.h"
#include "volumes/base/progress.h"

namespace supple {

/// Connected pieces of a body.
struct NodePieces {
  std::vector<std::int32_t> of_node;
  std::int32_t count = 0;
};

class ElasticSolid {
 public:
  virtual ~ElasticSolid() = default;

  virtual std::int64_t element_count() const = 0;
  virtual std::int64_t node_count() const = 0;
  /// Positions at rest in LPS mm of all nodes, or of these alone, which ascend.
  virtual std::vector<Vec3d> node_positions() const = 0;
  virtual std::vector<Vec3d> node_positions(const std::vector<NodeIndex>& nodes) const = 0;
  /// Axes of the turns, of unit length, that the components of the last nodes are where these have
  /// no displacement; 0 for a component that is nothing.
  virtual std::vector<std::array<Vec3d, 3>> turn_axes() const { return {}; }
  virtual NodePieces node_pieces() const = 0;
  /// Counts the loose islands and, if asked, holds all their nodes where they are.
  virtual LooseCount hold_loose(bool holds, HeldBits& held) const = 0;

  /// Stiffness matrix K, in mN per mm.
  virtual const Operator& matrix() const = 0;
  /// A sum of stiffness and mass. Throws InputError for a density that is not above 0.
  virtual std::unique_ptr<Operator> weighted(const ElementWeights& weights) const = 0;
  /// K, or such a sum, with a preconditioner. Throws as weighted(), Cancelled.
  virtual std::unique_ptr<LinearSystem> system(const ElementWeights* weights, const HeldBits& held,
                                               Progress* progress) const = 0;
  virtual std::size_t bytes() const = 0;
};

}  // namespace supple
