// One tree of values between files, sockets, the command line and the structs that say what is
// done: null, truth, number, text, list and table, each with the line that it was read from.
// Whole numbers and others are told apart, and tables keep the order of their keys, so that what
// was read is written again byte for byte. JSON is read and written by json.h, TOML by toml.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "volumes/base/vec.h"

namespace supple {

/// A date or a time of TOML, which no setting takes.
struct TomlMoment {
  std::string text;
  bool operator==(const TomlMoment& other) const { return text == other.text; }
};

class Value;
/// True for the types that become a value without being asked to.
template <class T>
inline constexpr bool makes_value =
    std::is_arithmetic_v<T> || std::is_convertible_v<T, std::string_view>;
template <>
inline constexpr bool makes_value<Value> = false;
template <>
inline constexpr bool makes_value<Vec3i> = true;
template <>
inline constexpr bool makes_value<Vec3d> = true;
template <>
inline constexpr bool makes_value<IndexBox> = true;
template <>
inline constexpr bool makes_value<TomlMoment> = true;
template <class T>
inline constexpr bool makes_value<std::vector<T>> = true;
template <class T, std::size_t count>
inline constexpr bool makes_value<std::array<T, count>> = true;

class Value {
 public:
  struct Entry;
  using List = std::vector<Value>;
  using Entries = std::vector<Entry>;
  using Moment = TomlMoment;

  Value() = default;
  /// Makes a null, a truth, a whole number or another one, a text, or a list of the like; of a box
  /// one list of both corners.
  template <class T, std::enable_if_t<makes_value<T>, int> = 0>
  Value(T given) {
    if constexpr (std::is_same_v<T, std::nullptr_t>) {
      m_data = std::monostate();
    } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
      m_data = std::int64_t(given);
    } else if constexpr (std::is_floating_point_v<T>) {
      m_data = double(given);
    } else if constexpr (std::is_same_v<T, Vec3i> || std::is_same_v<T, Vec3d>) {
      m_data = List{given.x, given.y, given.z};
    } else if constexpr (std::is_same_v<T, IndexBox>) {
      m_data = List{given.lo.x, given.lo.y, given.lo.z, given.hi.x, given.hi.y, given.hi.z};
    } else if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, List> ||
                         std::is_same_v<T, Entries> || std::is_same_v<T, Moment>) {
      m_data = std::move(given);
    } else if constexpr (std::is_convertible_v<T, std::string_view>) {
      m_data = std::string(std::move(given));
    } else {
      m_data = List(given.cbegin(), given.cend());
    }
  }
  /// A table where every value is a list of a text and another value, and else a list.
  Value(std::initializer_list<Value> values);

  bool is_null() const { return std::holds_alternative<std::monostate>(m_data); }
  bool is_truth() const { return std::holds_alternative<bool>(m_data); }
  bool is_whole() const { return std::holds_alternative<std::int64_t>(m_data); }
  bool is_number() const { return is_whole() || std::holds_alternative<double>(m_data); }
  bool is_text() const { return std::holds_alternative<std::string>(m_data); }
  bool is_moment() const { return std::holds_alternative<Moment>(m_data); }
  bool is_list() const { return std::holds_alternative<List>(m_data); }
  bool is_table() const { return std::holds_alternative<Entries>(m_data); }

  /// The value, which must be of this kind. All throw std::invalid_argument for another one.
  bool truth() const;
  std::int64_t whole() const;
  double number() const;
  /// The text, also of a moment.
  const std::string& text() const;

  /// Values of a list and entries of a table; none of anything else. They live as long as this.
  const List& items() const&;
  const List& items() const&& = delete;
  const Entries& entries() const&;
  const Entries& entries() const&& = delete;
  /// Number of items or entries.
  std::size_t size() const;
  bool empty() const { return size() == 0; }

  /// The value of a key, or null where there is none.
  const Value& operator[](const std::string& key) const;
  /// The same, but throws std::out_of_range where there is none.
  const Value& at(const std::string& key) const;
  /// A null becomes a table, and a missing key one with the value null.
  Value& operator[](const std::string& key);
  bool contains(const std::string& key) const { return find(key) != nullptr; }
  const Value* find(const std::string& key) const;
  void erase(const std::string& key);
  /// Sets the keys of another table here, too.
  void update(const Value& other);

  /// An item, which must be there: throws std::out_of_range otherwise.
  const Value& at(std::size_t index) const { return items().at(index); }
  const Value& operator[](std::size_t index) const { return at(index); }
  Value& operator[](std::size_t index) { return const_cast<Value&>(items().at(index)); }
  const Value& front() const { return at(0); }
  Value& back() { return (*this)[size() - 1]; }
  /// A null becomes a list. Returns the value in it.
  Value& push_back(Value value);
  void erase(std::size_t index);

  int line = 0;  // of the file, from 1; 0: there is none

  /// Compares values, whatever their lines.
  friend bool operator==(const Value& a, const Value& b) {
    if (a.is_whole() != b.is_whole() && a.is_number() && b.is_number()) {
      return a.number() == b.number();
    }
    return a.m_data == b.m_data;
  }
  friend bool operator!=(const Value& a, const Value& b) { return !(a == b); }

 private:
  friend void for_each_text(Value& value, const std::string& key,
                            const std::function<void(const std::string&, std::string&)>& change);
  friend Value sorted(Value value);

  std::variant<std::monostate, bool, std::int64_t, double, std::string, Moment, List, Entries>
      m_data;
};

struct Value::Entry {
  std::string key;
  Value value;
  bool operator==(const Entry& other) const { return key == other.key && value == other.value; }
};

/// Numbers of a list. Throws std::invalid_argument for anything else.
std::vector<double> numbers_of(const Value& list);

/// The value with the keys of all its tables in ascending order.
Value sorted(Value value);

/// Visits every text with the nearest key above it; `key` is that of the value itself.
void for_each_text(Value& value, const std::string& key,
                   const std::function<void(const std::string& key, std::string& text)>& change);

}  // namespace supple
