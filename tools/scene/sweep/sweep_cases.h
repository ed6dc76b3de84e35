// The cases of a sweep: keys of a scene, and in each case a value for each of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/scene/sweep/scene_key.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// A value as it was written, and as the scene has it.
struct SweptValue {
  std::string text;
  Value value;
};

/// Reads a number, true or false, a list, a table or a quoted text as TOML has them; another word
/// is a text. Throws UsageError, of `option`, for an opened list, table or text that does not end.
SweptValue parse_swept(const std::string& text, const std::string& option = "--vary");

/// Reads values between commas that lie outside of brackets and quotes. Throws UsageError likewise,
/// and for none.
std::vector<SweptValue> parse_swept_list(const std::string& text);

class SweepCases {
 public:
  /// One case that changes nothing. `option`: the name of what gives values, in errors.
  explicit SweepCases(std::string option = "--vary") : m_option(std::move(option)), m_rows(1) {}

  /// Each case so far with each of the values of KEY=A,B,C, which change faster than those before.
  /// Throws UsageError for another text, a key that has values already, and for too many cases.
  void vary(const std::string& text);
  /// Each case so far with the one value of KEY=VALUE. Throws UsageError as vary().
  void set(const std::string& text);
  /// Each case so far with each row of a CSV file whose first line has the keys. An empty field
  /// leaves the scene's value. `names` gets a name per row, fit for a file and each once, of the
  /// column `name`, which then is no key and must be there. Throws InputError for a file that is
  /// none, UsageError as vary().
  void add_file(const std::string& path, std::vector<std::string>* names = nullptr);

  const std::vector<SceneKey>& keys() const { return m_keys; }
  std::size_t size() const { return m_rows.size(); }
  /// One value per key, or none.
  const std::vector<std::optional<SweptValue>>& row(std::size_t n) const { return m_rows[n]; }
  /// "material.poisson = 0.3, volume.spacing = 2".
  std::string title(std::size_t n) const;
  /// Name of a key where few words are to be had: its end that no other key has.
  std::string short_key(std::size_t key) const;

  /// The scene of a case. Throws InputError as SceneKey::set(); UsageError for two keys of which
  /// one replaces a value of the other, since no run would have the values of that row.
  Value scene_of(std::size_t n, const Value& root, const std::string& scene_file) const;

 private:
  using Row = std::vector<std::optional<SweptValue>>;
  void add_key(const std::string& text);
  std::size_t add_head(const std::vector<std::string>& head, bool has_names,
                       const std::string& path);
  std::string take_key(const std::string& text, const char* expected);
  void multiply(const std::vector<Row>& rows);

  std::string m_option;
  std::vector<SceneKey> m_keys;
  std::vector<Row> m_rows;
};

/// The shortest end of a path, from one of its dots on, that no other of the paths has.
std::string short_name(const std::string& path, const std::vector<std::string>& paths);

}  // namespace supple::tools
