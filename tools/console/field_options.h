// Settings as options of the command line. Their names, help, units and defaults come from the list
// of fields of each struct (volumes/base/fields.h); their values are read as a scene's are.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "volumes/base/fields.h"
#include "volumes/base/table.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// The option of a field: "--" + prefix + its name with '-' for '_'; of a flag that is on by
/// default "--no-" and so on.
std::string option_name(const Field& field, const std::string& prefix = "");

/// Every field as an option that sets it when the command line is parsed. The values of the fields
/// must outlive the parsing.
void add_field_options(CLI::App& app, const Fields& fields);

/// Options that stand for keys of a scene: those that are given become a scene, and are read as
/// one.
class SceneOptions {
 public:
  explicit SceneOptions(CLI::App& app) : m_app(app) {}
  SceneOptions(const SceneOptions&) = delete;

  /// The fields of a table, "volume", "step", "step.relax" …: "--" + prefix + name. A table that
  /// holds others comes before them.
  void add(const std::string& table, const Fields& fields, const std::string& prefix = "");
  /// A key with its value; `option` stands for it in errors.
  void set(const std::string& table, const std::string& key, Value value,
           const std::string& option);
  /// Sets the name of a key or table in errors; `full_name` is "step[1].relax" and the like.
  void call(const std::string& full_name, const std::string& option) {
    m_names[full_name] = option;
  }
  /// Makes the table even where nothing of it was given.
  void include(const std::string& table) { m_given[table]; }
  /// Whether the table has anything.
  bool has(const std::string& table) const { return m_given.count(table) != 0; }

  /// The root of the scene that the options describe.
  Table scene() const;

 private:
  Value& made(Value& root, const std::string& name) const;

  CLI::App& m_app;
  std::vector<std::string> m_tables;           // those that hold others before these
  std::map<std::string, Value> m_given;        // of each table
  std::map<std::string, std::string> m_names;  // full name of a key to its option
};

/// True if the text is meant as a table, "{ … }".
bool is_table(const std::string& text);
/// One table as it stands in a scene. Throws UsageError naming the option for anything else.
Value table_value(const std::string& option, const std::string& text);
/// A number. Throws UsageError naming the option for text that is none.
Value number_value(const std::string& option, const std::string& text);
/// Numbers "A,B,C" as a list. Throws UsageError naming the option for another count of numbers, and
/// for text that is none.
Value numbers_value(const std::string& option, const std::string& text, std::size_t count = 3);

}  // namespace supple::tools
