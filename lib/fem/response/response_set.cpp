#include "lib/fem/response/response_set.h"

#include <algorithm>
#include <cmath>

#include "lib/fem/node_vectors.h"

namespace supple {

namespace {

std::shared_ptr<UnitResponse> response_of(const std::vector<double>& g_mm, std::vector<double> u_mm,
                                          const SolvedTo& to) {
  auto made = std::make_shared<UnitResponse>();
  for (std::size_t n = 0; n < g_mm.size(); ++n) {
    if (g_mm[n] == 0) continue;
    made->at.push_back(std::uint32_t(n));
    made->prescribed_mm.push_back(g_mm[n]);
    made->square += g_mm[n] * g_mm[n];
  }
  made->u_mm = std::move(u_mm);
  made->to = to;
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

SolvedTo ResponseSet::solved_to(const ResponseParts& parts) const {
  SolvedTo sum = m_base ? m_base->to : SolvedTo();
  for (std::size_t r = 0; r < parts.of.size(); ++r) {
    const SolvedTo& to = m_responses[r]->to;
    const double part = std::abs(parts.of[r]);
    sum.seen_mn = std::max(sum.seen_mn, part * to.seen_mn);
    sum.error_mm += part * to.error_mm;
    sum.reaction_change_mn += part * to.reaction_change_mn;
  }
  return sum;
}

double ResponseSet::error_mm(const ResponseParts& parts, int n) const {
  if (n < 0) return m_base ? m_base->to.error_mm : 0;
  return std::abs(parts.of[std::size_t(n)]) * m_responses[std::size_t(n)]->to.error_mm;
}

void ResponseSet::add(const std::vector<double>& g_mm, std::vector<double> u_mm, const SolvedTo& to,
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
  SolvedTo all = to;
  for (std::size_t r = 0; r < parts.of.size(); ++r) {
    all.error_mm += error_mm(parts, int(r));
    all.reaction_change_mn += std::abs(parts.of[r]) * m_responses[r]->to.reaction_change_mn;
  }
  m_responses.push_back(response_of(parts.left_mm, std::move(u_mm), all));
}

void ResponseSet::set_base(const std::vector<double>& g_mm, std::vector<double> u_mm,
                           const SolvedTo& to) {
  m_base = response_of(g_mm, std::move(u_mm), to);
}

void ResponseSet::replace(int n, std::vector<double> u_mm, const SolvedTo& to) {
  std::shared_ptr<const UnitResponse>& of = n < 0 ? m_base : m_responses[std::size_t(n)];
  of = std::make_shared<UnitResponse>(
      UnitResponse{of->at, of->prescribed_mm, of->square, std::move(u_mm), to});
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
