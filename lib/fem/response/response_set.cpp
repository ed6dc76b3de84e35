#include "lib/fem/response/response_set.h"

#include <algorithm>
#include <cmath>

#include "lib/fem/node_vectors.h"

namespace supple {

namespace {

std::shared_ptr<UnitResponse> response_of(const std::vector<double>& g_mm, std::vector<double> u_mm,
                                          double seen_mn) {
  auto made = std::make_shared<UnitResponse>();
  for (std::size_t n = 0; n < g_mm.size(); ++n) {
    if (g_mm[n] == 0) continue;
    made->at.push_back(std::uint32_t(n));
    made->prescribed_mm.push_back(g_mm[n]);
    made->square += g_mm[n] * g_mm[n];
  }
  made->u_mm = std::move(u_mm);
  made->seen_mn = seen_mn;
  return made;
}

void subtract(const UnitResponse& of, double part, std::vector<double>& g_mm) {
  for (std::size_t n = 0; n < of.at.size(); ++n) g_mm[of.at[n]] -= part * of.prescribed_mm[n];
}

/// Rounding makes what is orthogonal less so: once more takes out what it has left.
constexpr int kPasses = 2;

}  // namespace

std::size_t UnitResponse::bytes() const {
  return sizeof *this + at.capacity() * sizeof at[0] +
         (prescribed_mm.capacity() + u_mm.capacity()) * sizeof(double);
}

int ResponseParts::used() const {
  return int(std::count_if(of.begin(), of.end(), [](double part) { return part != 0; }));
}

std::string ResponseSet::require(const ResponseKey& key) {
  const std::string change = m_key.change_to(key);
  const bool is_new = empty();
  if (change.empty()) return {};
  *this = {};
  m_key = key;
  return is_new ? std::string() : change;
}

ResponseParts ResponseSet::parts_of(std::vector<double> g_mm, const UnitResponse* base) const {
  ResponseParts parts;
  parts.of.assign(m_responses.size(), 0);
  if (base != nullptr) subtract(*base, 1, g_mm);
  for (int pass = 0; pass < kPasses; ++pass) {
    for (std::size_t r = 0; r < m_responses.size(); ++r) {
      const UnitResponse& response = *m_responses[r];
      double product = 0;
      for (std::size_t n = 0; n < response.at.size(); ++n) {
        product += response.prescribed_mm[n] * g_mm[response.at[n]];
      }
      const double part = product / response.square;
      subtract(response, part, g_mm);
      parts.of[r] += part;
    }
  }
  for (const double left : g_mm) parts.beyond_mm = std::max(parts.beyond_mm, std::abs(left));
  parts.left_mm = std::move(g_mm);
  return parts;
}

std::vector<double> ResponseSet::sum(const ResponseParts& parts, std::size_t unknowns) const {
  std::vector<double> u(unknowns, 0.0);
  for_ranges(unknowns, [&](std::size_t begin, std::size_t end) {
    if (m_base) std::copy(&m_base->u_mm[begin], m_base->u_mm.data() + end, &u[begin]);
    for (std::size_t r = 0; r < parts.of.size(); ++r) {
      if (parts.of[r] == 0) continue;
      const double* of = m_responses[r]->u_mm.data();
      for (std::size_t n = begin; n < end; ++n) u[n] += parts.of[r] * of[n];
    }
  });
  return u;
}

double ResponseSet::seen_mn(const ResponseParts& parts) const {
  double seen = m_base ? m_base->seen_mn : 0;
  for (std::size_t r = 0; r < parts.of.size(); ++r) {
    seen = std::max(seen, std::abs(parts.of[r]) * m_responses[r]->seen_mn);
  }
  return seen;
}

void ResponseSet::add(const std::vector<double>& g_mm, std::vector<double> u_mm, double seen_mn,
                      double rounding_mm) {
  const ResponseParts parts = parts_of(g_mm, nullptr);
  if (parts.beyond_mm <= rounding_mm) return;
  for (std::size_t r = 0; r < parts.of.size(); ++r) {
    if (parts.of[r] == 0) continue;
    const double* of = m_responses[r]->u_mm.data();
    for_ranges(u_mm.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) u_mm[n] -= parts.of[r] * of[n];
    });
  }
  m_responses.push_back(response_of(parts.left_mm, std::move(u_mm), seen_mn));
}

void ResponseSet::set_base(const std::vector<double>& g_mm, std::vector<double> u_mm,
                           double seen_mn) {
  m_base = response_of(g_mm, std::move(u_mm), seen_mn);
}

std::size_t ResponseSet::bytes_beyond(const ResponseSet& other) const {
  const auto& shared = other.m_responses;
  std::size_t sum = m_base && m_base != other.m_base ? m_base->bytes() : 0;
  for (const auto& own : m_responses) {
    if (std::find(shared.begin(), shared.end(), own) == shared.end()) sum += own->bytes();
  }
  return sum;
}

}  // namespace supple
