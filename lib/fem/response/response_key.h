// A key of all that responses depend on: digests of its parts, each with a name for people.
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "volumes/base/sha256.h"

namespace supple {

/// A digest of numbers, the same on every machine of one byte order.
class ContentHash {
 public:
  void add_bytes(const void* data, std::size_t size) { m_stream.update(data, size); }
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
  /// The digest; the hash is empty again.
  std::string hex() { return m_stream.hex(); }

 private:
  Sha256 m_stream;
};

class ResponseKey {
 public:
  void add(const char* part, ContentHash hash) { m_parts.emplace_back(part, hash.hex()); }
  bool empty() const { return m_parts.empty(); }
  /// Says what is another in `now`, such as "other held elements"; empty where nothing is.
  std::string change_to(const ResponseKey& now) const;

 private:
  std::vector<std::pair<std::string, std::string>> m_parts;  // names and digests
};

}  // namespace supple
