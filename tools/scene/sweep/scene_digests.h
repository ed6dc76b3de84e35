// Digests of all that the results of a scene depend on: its values, and the contents of the files
// that it names, wherever its folder lies.
#pragma once

#include <map>
#include <set>
#include <string>

#include "volumes/base/value.h"
#include "volumes/io/format/volume_file.h"

namespace supple::tools {

/// The program and its version, "supple 1.2.3": others may have other results.
std::string program_of_results();

/// The first 32 digits of the SHA-256 of a text.
std::string digest_of_text(const std::string& text);

/// Digests of variants of one scene. Each file is read once.
class SceneDigests {
 public:
  /// Paths within the scene start at the folder of this file.
  explicit SceneDigests(std::string scene_file) : m_file(std::move(scene_file)) {}

  /// Files that the scene names, and those that its volumes are read from. Throws InputError as
  /// read_scene().
  std::set<std::string> inputs_of(const Value& root);
  /// Digest of values and files; a file that is not there counts as empty.
  std::string digest_of(const Value& root, const std::set<std::string>& inputs);

 private:
  void add_volume(const std::string& path, const ReadOptions& read, std::set<std::string>& files);
  const std::string& digest_of_file(const std::string& path);

  std::string m_file;
  std::map<std::string, std::string> m_file_digests;
};

}  // namespace supple::tools
