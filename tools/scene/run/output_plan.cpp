#include "tools/scene/run/output_plan.h"

#include <filesystem>

#include "lib/state/state_source.h"
#include "volumes/base/atomic_file.h"
#include "volumes/base/error.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/volume_writer.h"

namespace supple::tools {

namespace {

std::string canonical(const std::string& path) {
  return std::filesystem::weakly_canonical(path).string();
}

void require_extension(const std::string& path, const std::string& extension) {
  const std::string found = std::filesystem::path(path).extension().string();
  if (found == extension) return;
  throw InputError({path, "output", found.empty() ? "no extension" : "extension " + found,
                    "extension " + extension});
}

}  // namespace

void OutputPlan::protect(const std::string& input, const ReadOptions& read) {
  m_inputs.insert(canonical(file_part(input)));
  m_unopened.emplace_back(input, read);
  protect_source_of(input);
}

void OutputPlan::protect_source_of(const std::string& state) {
  const auto source = source_of_state_file(state);
  if (source != nullptr) protect(source->path, source->read);
}

/// Opens the inputs when an output first meets an existing file, which is rare.
bool OutputPlan::is_read(const std::string& place) {
  for (const auto& [input, read] : std::exchange(m_unopened, {})) {
    try {
      for (const std::string& file : files_of(open_scalars_or_vectors(input, read)->header())) {
        m_inputs.insert(canonical(file));
      }
    } catch (const Error&) {
      continue;  // no volume, or one that the command will refuse
    }
  }
  return m_inputs.count(place) != 0;
}

void OutputPlan::add_image(const std::string& path) {
  require_extension(path, ".png");
  add_file(path);
}

void OutputPlan::add_pictures(const PictureOptions& options, const std::string& image) {
  add_files(picture_files(options, image));
}

void OutputPlan::add_files(const std::vector<std::string>& pictures) {
  for (const std::string& file : pictures) add_file(file);
}

void OutputPlan::add_state(const std::string& path) {
  require_extension(path, ".vdb");
  add_file(path);
}

void OutputPlan::add_report(const std::string& path) {
  require_extension(path, ".json");
  add_file(path);
}

void OutputPlan::add_table(const std::string& path) {
  require_extension(path, ".csv");
  add_file(path);
}

void OutputPlan::add_log(const std::string& path) {
  require_extension(path, ".jsonl");
  add_file(path);
}

void OutputPlan::add_chart(const std::string& path) {
  require_extension(path, ".svg");
  add_file(path);
}

void OutputPlan::add_like(const std::string& path, const std::string& input) {
  require_extension(path, std::filesystem::path(input).extension().string());
  add_file(path);
}

void OutputPlan::add_dense(const std::string& path) {
  for (const std::string& file : output_files(path)) add_file(file);
}

void OutputPlan::add_file(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const bool will_be_made = m_creates_folders && !std::filesystem::exists(folder);
  if (!will_be_made) check_output_place(path);
  const std::string place = canonical(path);
  const bool exists = std::filesystem::exists(path);
  if (m_inputs.count(place) != 0 || (exists && is_read(place))) {
    throw InputError({path, "output", "the name of an input", "another file"});
  }
  if (!m_outputs.insert(place).second) {
    throw InputError({path, "output", "a file that another output writes", "different files"});
  }
  if (!m_may_overwrite && exists) {
    throw UsageError(path + ": output exists, add --force to overwrite it");
  }
  m_files.push_back(path);
}

}  // namespace supple::tools
