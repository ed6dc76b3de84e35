// Strict reading of a table, wherever it came from: every key is asked for by name and type, and
// finish() rejects the keys that nobody asked for, with line number and the nearest known name. All
// errors are InputError with "file:line", the key, what was found and what is expected.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "volumes/base/fields.h"
#include "volumes/base/value.h"

namespace supple {

/// True for a number that an int holds exactly.
bool is_integer(double value);
/// True for a value that is there and is a text.
inline bool is_text(const Value* value) {
  return value != nullptr && value->is_text();
}

class Table {
 public:
  /// The root of a file of TOML. Throws InputError as read_toml().
  static Table read(const std::string& path);
  /// The root of a text of TOML; `source` names it in errors.
  static Table parse(const std::string& text, const std::string& source);
  /// A table that came by another way. `options`: the option behind the full name of a key, for
  /// errors.
  explicit Table(Value table, const std::string& source = "",
                 std::map<std::string, std::string> options = {});

  /// Sets those of the fields that are there. A value that is not allowed is an error, and so is a
  /// required field that is missing.
  void read(const Fields& fields);
  /// `key`, or its former name where the table has that, with a warning.
  std::string present_name(const std::string& key, const std::string& former);
  /// Keys that were read by their former names, of the file and those that it names: one line each.
  const std::vector<std::string>& warnings() const { return *m_file_data->warnings; }
  /// Asks before any input that the file names is read, also by files that it names in turn; an
  /// error that it throws refuses the input.
  using Admits = std::function<void(const std::string& path)>;
  void admit_inputs(Admits admits) { m_file_data->admits = std::move(admits); }
  const Admits& admits() const { return m_file_data->admits; }
  /// The root of the file that the key names.
  Table named_file(const std::string& key);

  /// Declares keys, so that an unknown one is reported before a missing one.
  void know(std::initializer_list<const char*> keys) { m_known.insert(keys.begin(), keys.end()); }
  /// True where the table has the key; also makes it a known one.
  bool has(const std::string& key) { return find(key) != nullptr; }
  /// The value of a key, null where there is none; also makes it a known one.
  const Value* find(const std::string& key);
  /// The place "file:line" of the key or of the table.
  std::string place(const std::string& key = "") const;
  const std::string& file() const { return m_file_data->path; }
  /// Full name of a key, e.g. "step[2].grab", or the option behind it.
  std::string full_name(const std::string& key) const;

  /// The value of a key as bool, std::string, double (finite), long long, Vec3d, Vec3i, or
  /// std::vector of texts or finite numbers.
  template <class T>
  std::optional<T> get(const std::string& key);
  /// The path of an input: relative ones start at the folder of the file.
  std::optional<std::string> path(const std::string& key);
  /// One path or a list of them, as path(); empty when absent.
  std::vector<std::string> paths(const std::string& key);
  /// List of lists of numbers, each of one of the allowed lengths.
  std::optional<std::vector<std::vector<double>>> rows(const std::string& key,
                                                       const std::set<std::size_t>& lengths,
                                                       const std::string& expected);
  std::optional<Table> table(const std::string& key);
  /// The names of all keys, ascending.
  std::vector<std::string> keys() const;
  /// Array of tables; empty when absent.
  std::vector<Table> tables(const std::string& key);
  /// Reads one table or an array of them; empty when absent.
  std::vector<Table> table_or_tables(const std::string& key);
  const Value& value() const { return *m_table; }
  /// The values with absolute paths of the inputs that have been read, so that they mean the same
  /// in any folder.
  Value written() const;

  /// The value must be there; throws InputError naming the key otherwise.
  template <class T>
  T require(std::optional<T> value, const std::string& key, const std::string& expected) const {
    if (!value) fail_missing(key, expected);
    return std::move(*value);
  }
  [[noreturn]] void fail(const std::string& key, const std::string& found,
                         const std::string& expected) const;
  [[noreturn]] void fail_missing(const std::string& key, const std::string& expected) const;

  /// Throws InputError for the first key that was never asked for.
  void finish() const;

 private:
  /// Data that all tables of a file share.
  struct File {
    std::string path;
    std::map<std::string, std::string> options;
    /// The answers of path() and paths() so far: by key and text the absolute path.
    std::map<std::pair<std::string, std::string>, std::string> inputs;
    Admits admits;
    std::shared_ptr<std::vector<std::string>> warnings =
        std::make_shared<std::vector<std::string>>();
  };
  Table(std::shared_ptr<const Value> table, std::shared_ptr<File> file, std::string name);
  Table below(const Value& table, std::string name) const;
  /// Full name in a file, whatever option stands for it.
  std::string own_name(const std::string& key) const;
  std::string input(const std::string& key, const std::string& path);
  void read_field(const Field& field, const std::string& key);

  std::shared_ptr<const Value> m_table;  // keeps the whole file
  std::shared_ptr<File> m_file_data;
  std::string m_name;
  std::set<std::string> m_known;
};

}  // namespace supple
