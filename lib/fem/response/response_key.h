// A key of all that responses depend on: hashes of its parts, each with a name for people.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace supple {

/// A 64-bit hash of contents, the same on every machine of one byte order.
class ContentHash {
 public:
  void add_bytes(const void* data, std::size_t size);
  template <class T>
  void add(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>, "no padding");
    add_bytes(&value, sizeof value);
  }
  template <class T>
  void add(const std::vector<T>& values) {
    static_assert(std::is_arithmetic_v<T>, "no padding");
    add(values.size());
    add_bytes(values.data(), values.size() * sizeof(T));
  }
  std::uint64_t value() const { return m_value; }

 private:
  std::uint64_t m_value = 0x9e3779b97f4a7c15u;
};

class ResponseKey {
 public:
  void add(const char* part, const ContentHash& hash) { m_parts.emplace_back(part, hash.value()); }
  bool empty() const { return m_parts.empty(); }
  /// Says what is another in `now`, such as "other held elements"; empty where nothing is.
  std::string change_to(const ResponseKey& now) const;

 private:
  std::vector<std::pair<std::string, std::uint64_t>> m_parts;
};

}  // namespace supple
