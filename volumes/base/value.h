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

class Value {
 public:
  struct Entry;
  using List = std::vector<Value>;
  using Entries = std::vector<Entry>;
  /// A date or a time of TOML, which no setting takes.
  struct Moment {
    std::string text;
    bool operator==(const Moment& other) const { return text == other.text; }
  };

  Value() = default;
  Value(std::nullptr_t) {}
  /// Makes a truth, a whole number or another one.
  template <class T, std::enable_if_t<std::is_arithmetic_v<T>, int> = 0>
  Value(T number) {
    if constexpr (std::is_same_v<T, bool>) {
      m_data = number;
    } else if constexpr (std::is_integral_v<T>) {
      m_data = std::int64_t(number);
    } else {
      m_data = double(number);
    }
  }
  Value(const char* text) : m_data(std::string(text)) {}
  Value(std::string text) : m_data(std::move(text)) {}
  Value(std::string_view text) : m_data(std::string(text)) {}
  Value(Moment moment) : m_data(std::move(moment)) {}
  Value(const Vec3i& v) : Value(std::array<int, 3>{v.x, v.y, v.z}) {}
  Value(const Vec3d& v) : Value(std::array<double, 3>{v.x, v.y, v.z}) {}
  /// Makes one list of both corners.
  Value(const IndexBox& box)
      : Value(std::array<int, 6>{box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z}) {}
  template <class T>
  Value(const std::vector<T>& values) : m_data(List(values.begin(), values.end())) {}
  template <class T, std::size_t count>
  Value(const std::array<T, count>& values) : m_data(List(values.begin(), values.end())) {}
  Value(List&& values) : m_data(std::move(values)) {}
  /// A table where every value is a list of a text and another value, and else a list.
  Value(std::initializer_list<Value> values);
  /// Make an empty list and an empty table.
  static Value list() { return List(); }
  static Value table();

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
  const std::string& text() const;
  const std::string& moment() const;
  /// The value, or this one where it is of another kind.
  bool truth_or(bool otherwise) const { return is_truth() ? truth() : otherwise; }
  std::string text_or(const std::string& otherwise) const { return is_text() ? text() : otherwise; }

  /// Values of a list and entries of a table; none of anything else.
  const List& items() const;
  const Entries& entries() const;
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
  Value& at(std::size_t index);
  const Value& operator[](std::size_t index) const { return at(index); }
  Value& operator[](std::size_t index) { return at(index); }
  const Value& front() const { return at(0); }
  Value& back() { return at(size() - 1); }
  /// A null becomes a list. Returns the value in it.
  Value& push_back(Value value);
  void erase(std::size_t index);

  /// The line of the file, from 1; 0 where there is none.
  int line() const { return m_line; }
  void set_line(int line) { m_line = line; }

  /// Compares values, whatever their lines.
  bool operator==(const Value& other) const;
  bool operator!=(const Value& other) const { return !(*this == other); }

 private:
  friend void for_each_text(Value& value, const std::string& key,
                            const std::function<void(const std::string&, std::string&)>& change);
  friend Value sorted(Value value);

  std::variant<std::monostate, bool, std::int64_t, double, std::string, Moment, List, Entries>
      m_data;
  int m_line = 0;
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
