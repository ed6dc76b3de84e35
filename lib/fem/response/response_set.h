// Answers of a linear body to what moves it: displacements are linear in what is prescribed, so
// that all motions of what is held are sums of a few solutions,
//
//   u = u0 + sum of c_i u_i,   g = g0 + sum of c_i g_i at all that is held,
//
// with prescribed displacements g and a base solution u0 of the loads (0 where no force acts). A
// set grows as it is used: of what a new g has beyond the g_i known so far the solution is found,
// and joins them. So no more solutions are made than motions have directions: one for all of a
// straight way, two for a plane or for a ring about an axis, twelve for the shifts and linear maps
// of a handle; soft edges, pieces and several handles at once need no rule of their own. Beyond
// what is known is what rounding of places does not explain.
//
// Memory of each: 8 bytes per unknown, and 12 per component that is held and moves.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "lib/fem/nodal_loads.h"
#include "lib/fem/response/response_key.h"

namespace supple {

/// Measures of a solution that are known beside itself.
struct SolvedTo {
  double seen_mn = 0;             // ResidualSize::seen_mn
  double error_mm = 0;            // that is left of displacements by the estimate; 0: none was made
  double reaction_change_mn = 0;  // in the last iteration
};

/// Solutions that others may be sums of are solved to this part of the error that is asked for: a
/// motion may grow and have several directions before they have to be solved further.
constexpr double kErrorShare = 1.0 / 16;

/// A solution of what is prescribed at some held components; orthogonal to those of the others.
struct UnitResponse {
  std::vector<std::uint32_t> at;      // 3 node + component
  std::vector<double> prescribed_mm;  // there
  double square = 0;                  // sum of their squares
  std::vector<double> u_mm;           // three per node
  SolvedTo to;

  std::size_t bytes() const;
};

/// Parts that a set has of what is prescribed.
struct ResponseParts {
  std::vector<double> of;       // one per response
  double beyond_mm = 0;         // the largest displacement that is left
  std::vector<double> left_mm;  // three per node, 0 where nothing is held
  int used() const;
};

class ResponseSet {
 public:
  /// More solutions, or memory, are not kept: those before are forgotten then.
  static constexpr std::size_t kMost = 36, kMostBytes = std::size_t(1) << 30;

  /// Forgets all, unless this is the key of what is known; says what is another than before.
  std::string require(const ResponseKey& key);

  /// Forgets all but the key.
  void forget() { m_base = nullptr, m_responses.clear(); }

  bool empty() const { return m_base == nullptr && m_responses.empty(); }
  std::size_t size() const { return m_responses.size(); }
  const UnitResponse& operator[](std::size_t n) const { return *m_responses[n]; }
  const UnitResponse* base() const { return m_base.get(); }
  bool is_full() const { return m_responses.size() >= kMost || bytes() >= kMostBytes; }

  /// Takes `g_mm` (three per node, 0 where nothing is held) apart.
  ResponseParts parts_of(std::vector<double> g_mm) const {
    return parts_of(std::move(g_mm), m_base.get());
  }
  /// Computes the sum of such parts, with the base: three per node of a mesh of so many unknowns.
  std::vector<double> sum(const ResponseParts& parts, std::size_t unknowns) const;
  /// The largest force of a node that the solutions of a sum have seen, and what they leave at the
  /// most together: the sum of |c_i| times that of each.
  SolvedTo solved_to(const ResponseParts& parts) const;
  /// Returns the error that the term of the base, `n` = -1, or of a response leaves in the sum.
  double error_mm(const ResponseParts& parts, int n) const;

  /// A solution without forces joins the set, less what the set has of it: nothing where that is
  /// all of it but `rounding_mm`.
  void add(const std::vector<double>& g_mm, std::vector<double> u_mm, const SolvedTo& to,
           double rounding_mm = 0);
  /// The first solution, with the forces that act.
  void set_base(const std::vector<double>& g_mm, std::vector<double> u_mm, const SolvedTo& to);
  /// A better solution of the base, -1, or of a response takes its place.
  void replace(int n, std::vector<double> u_mm, const SolvedTo& to);

  /// The smallest Ritz value that solutions with this key have seen; others can only lower it.
  double ritz_value() const { return m_ritz_value; }
  void see(double ritz_value) { m_ritz_value = std::min(m_ritz_value, ritz_value); }

  /// Memory of those that `other` does not share.
  std::size_t bytes_beyond(const ResponseSet& other) const;
  std::size_t bytes() const { return bytes_beyond({}); }

 private:
  ResponseParts parts_of(std::vector<double> g_mm, const UnitResponse* base) const;
  ResponseKey m_key;
  std::shared_ptr<const UnitResponse> m_base;  // null: 0
  std::vector<std::shared_ptr<const UnitResponse>> m_responses;
  double m_ritz_value = 1;
};

}  // namespace supple
