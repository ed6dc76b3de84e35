#include "tools/scene/sweep/scene_digests.h"

#include <filesystem>
#include <fstream>
#include <vector>

#include "lib/state/state_source.h"
#include "tools/scene/file/scene.h"
#include "volumes/base/error.h"
#include "volumes/base/json.h"
#include "volumes/base/sha256.h"
#include "volumes/base/version.h"

namespace supple::tools {

namespace fs = std::filesystem;

std::string program_of_results() {
  return std::string("supple ") + kVersion;
}

std::string digest_of_text(const std::string& text) {
  return sha256_hex(text.data(), text.size()).substr(0, 32);
}

std::set<std::string> SceneDigests::inputs_of(const Value& root) {
  std::set<std::string> files;
  Table table(root, m_file);
  table.admit_inputs([&](const std::string& path) { files.insert(path); });
  const Scene scene = read_scene(table);
  add_volume(scene.volume_path, scene.read, files);
  for (const std::string& path : {scene.labels_path, scene.warp_path}) {
    if (!path.empty()) add_volume(path, {}, files);
  }
  return files;
}

void SceneDigests::add_volume(const std::string& path, const ReadOptions& read,
                              std::set<std::string>& files) {
  files.insert(path);
  try {
    if (const auto source = source_of_state_file(path)) {
      add_volume(source->path, source->read, files);
    } else {
      for (const std::string& file : files_of(open_scalars_or_vectors(path, read)->header())) {
        files.insert(file);
      }
    }
  } catch (const Error&) {  // which the run will meet, too
  }
}

const std::string& SceneDigests::digest_of_file(const std::string& path) {
  const auto [known, is_new] = m_file_digests.try_emplace(path);
  if (!is_new || !fs::is_regular_file(path)) return known->second;
  Sha256 digest;
  std::ifstream stream(path, std::ios::binary);
  std::vector<char> bytes(std::size_t(1) << 20);
  while (stream.read(bytes.data(), std::streamsize(bytes.size())) || stream.gcount() > 0) {
    digest.update(bytes.data(), std::size_t(stream.gcount()));
  }
  return known->second = digest.hex();
}

std::string SceneDigests::digest_of(const Value& root, const std::set<std::string>& inputs) {
  const fs::path folder = fs::absolute(m_file).parent_path().lexically_normal();
  std::set<std::pair<std::string, std::string>> files;
  for (const std::string& path : inputs) {
    const fs::path place = fs::absolute(path).lexically_normal().lexically_relative(folder);
    files.insert({place.string(), digest_of_file(path)});
  }
  std::string all = json_text(root);
  for (const auto& [place, digest] : files) all += "\n" + json_string(place) + " " + digest;
  return digest_of_text(all);
}

}  // namespace supple::tools
