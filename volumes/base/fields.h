// One list per table of settings. A struct of settings names its fields once, in a function
// `fields`: scene files, the command line, records of steps and the tables of the documentation
// read that list.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "volumes/base/value.h"
#include "volumes/base/vec.h"

namespace supple {

/// Red, green and blue, 0 to 1; written "#RRGGBB".
using Rgb = std::array<double, 3>;
/// Two numbers, the first below the second where the setting wants it so.
using NumberPair = std::pair<double, double>;
/// Width and height.
using PixelSize = std::array<int, 2>;

std::string colour_text(const Rgb& rgb);
/// Reads a colour; none for text other than "#RRGGBB".
std::optional<Rgb> parse_colour(const std::string& text);

/// Traits of a setting, beside its value and the values that are allowed.
struct FieldTraits {
  std::string name, help, unit{};
  std::string record{};       // its name in records, which say the unit; empty: its name
  std::string option{};       // its name on the command line, without dashes, where it is not the
                              // prefix of the table and its name
  std::string former{};       // its name in earlier versions, which is still read, with a warning
  std::string implied{};      // the value of an option that is given without one
  std::string placeholder{};  // of the value in a help text
  bool is_required = false;
  bool is_path = false;            // of an input: in a file, relative ones start at its folder
  bool is_only_in_scenes = false;  // no option of its own on the command line
  bool is_for_slices = false;      // slices have this setting of a view, too
};

/// One setting: its name, the address of its value, its meaning and its allowed values.
class Field {
 public:
  /// An enumeration as its names, in the order of the enumerators from 0.
  struct Names {
    std::vector<std::string> names;
    std::function<int()> get;
    std::function<void(int)> set;
  };
  using Target =
      std::variant<bool*, int*, std::optional<int>*, double*, std::optional<double>*, std::string*,
                   Vec3d*, std::optional<Vec3d>*, NumberPair*, std::optional<NumberPair>*,
                   PixelSize*, Rgb*, std::vector<std::string>*, Names>;

  /// `help`: one line, without a full stop. The value must outlive the field.
  template <class Setting>
  Field(const char* name, Setting& value, const char* help)
      : m_traits{name, help}, m_target(&value) {}
  template <class Enum>
  Field(const char* name, Enum& value, std::vector<std::string> names, const char* help)
      : m_traits{name, help},
        m_target(Names{std::move(names), [&value] { return int(value); },
                       [&value](int index) { value = Enum(index); }}) {}

  /// These set the traits of the same name.
  Field& unit(const char* text) { return m_traits.unit = text, *this; }
  Field& recorded_as(const char* name) { return m_traits.record = name, *this; }
  Field& option(const char* name) { return m_traits.option = name, *this; }
  Field& formerly(const char* name) { return m_traits.former = name, *this; }
  Field& implying(const char* value) { return m_traits.implied = value, *this; }
  Field& shown_as(const char* text) { return m_traits.placeholder = text, *this; }
  Field& required() { return m_traits.is_required = true, *this; }
  Field& path() { return m_traits.is_path = true, *this; }
  Field& only_in_scenes() { return m_traits.is_only_in_scenes = true, *this; }
  Field& for_slices() { return m_traits.is_for_slices = true, *this; }
  /// Bounds the number, or every component of a vector; both ends are allowed.
  Field& range(double lo, double hi) { return m_lo = lo, m_hi = hi, *this; }
  Field& at_least(double lo) { return m_lo = lo, *this; }
  /// Bounds the number to those above 0.
  Field& positive() { return m_lo = 0, m_is_open = true, *this; }
  /// One of these words, or else the path of an input.
  Field& word_or_path(std::vector<std::string> words) { return m_words = std::move(words), path(); }
  /// The names that a string may have.
  Field& one_of(std::vector<std::string> names) { return m_names = std::move(names), *this; }
  /// Another word for one of the names.
  Field& also(const char* word, const char* name) { return m_synonyms[word] = name, *this; }
  /// Replaces the default in help and documentation, where another value holds when the setting is
  /// left out; empty: no default is shown.
  Field& otherwise(std::string text) { return m_otherwise = std::move(text), *this; }

  const std::string& name() const { return m_traits.name; }
  const FieldTraits& traits() const { return m_traits; }
  /// True if the text is the path of an input, and none of the words that stand beside paths.
  bool names_file(const std::string& text) const;
  const Target& target() const { return m_target; }
  /// True if the value is a T, or a T that may be absent.
  template <class T>
  bool holds() const {
    return std::visit(
        [](const auto& target) {
          using Kept = std::decay_t<decltype(target)>;
          return std::is_same_v<Kept, T*> || std::is_same_v<Kept, std::optional<T>*>;
        },
        m_target);
  }
  /// The names that it may have; empty: anything.
  const std::vector<std::string>& names() const;

  /// The name that the word stands for, or the word itself.
  std::string name_for(const std::string& word) const;

  /// True if the number may be the value, or a component of it.
  bool allows(double value) const;
  /// "0 to 40 mm", "a positive number of mm", "one of a, b and c"; empty: anything of its kind.
  std::string allowed() const;
  /// Placeholder on the command line: "N", "X,Y,Z", "MM", "a|b|c".
  std::string placeholder() const;
  /// The present value as one reads it; empty where there is none.
  std::string text() const;
  /// The present value; null where there is none.
  Value value() const;
  /// The default, for help and documentation; empty: there is none.
  std::string default_text() const;

 private:
  FieldTraits m_traits;
  Target m_target;
  std::optional<std::string> m_otherwise;
  std::vector<std::string> m_names, m_words;
  std::map<std::string, std::string> m_synonyms;
  double m_lo = -std::numeric_limits<double>::infinity();
  double m_hi = std::numeric_limits<double>::infinity();
  bool m_is_open = false;
};

using Fields = std::vector<Field>;

/// All values as one table by the names of records. Absent values are left out, and so are those
/// that are the same in `plain`, fields of the same struct.
Value fields_value(const Fields& fields, const Fields& plain = {});

/// Writes "a, b and c".
std::string listed(const std::vector<std::string>& names, const char* last = "and");

}  // namespace supple
