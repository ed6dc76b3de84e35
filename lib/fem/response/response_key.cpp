#include "lib/fem/response/response_key.h"

#include <algorithm>
#include <cstring>

namespace supple {

namespace {

/// Mixes all bits of two words into each other (the finaliser of SplitMix64).
std::uint64_t mixed(std::uint64_t value, std::uint64_t word) {
  value = (value ^ word) + 0x9e3779b97f4a7c15u;
  value = (value ^ value >> 30) * 0xbf58476d1ce4e5b9u;
  value = (value ^ value >> 27) * 0x94d049bb133111ebu;
  return value ^ value >> 31;
}

}  // namespace

void ContentHash::add_bytes(const void* data, std::size_t size) {
  const char* bytes = static_cast<const char*>(data);
  for (std::size_t at = 0; at < size; at += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes + at, std::min(size - at, sizeof word));
    m_value = mixed(m_value, word);
  }
}

std::string ResponseKey::change_to(const ResponseKey& now) const {
  for (std::size_t n = 0; n < now.m_parts.size(); ++n) {
    if (n >= m_parts.size() || m_parts[n] != now.m_parts[n]) return "other " + now.m_parts[n].first;
  }
  return {};
}

}  // namespace supple
