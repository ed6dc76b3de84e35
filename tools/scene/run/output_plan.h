// The files that a command is going to create, checked before anything is computed: right kind of
// name, place that can be written to, nothing overwritten without --force, no two outputs in one
// file, no output on top of an input.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tools/scene/pictures/picture_options.h"
#include "volumes/base/progress.h"
#include "volumes/io/format/volume_file.h"

namespace supple::tools {

class OutputPlan {
 public:
  /// `creates_folders`: missing folders are no error, since the command makes them.
  explicit OutputPlan(bool may_overwrite, bool creates_folders = false)
      : m_may_overwrite(may_overwrite), m_creates_folders(creates_folders) {}

  /// A file that must not be overwritten, and the files that a volume of that name is read from
  /// beside it: the data files of a header, the slices of a folder, the volume that a state refers
  /// to.
  void protect(const std::string& input, const ReadOptions& read = {});
  /// Protects the volume of a state that may be overwritten.
  void protect_source_of(const std::string& state);

  /// Each throws UsageError (exists, no --force) or InputError (everything else).
  void add_image(const std::string& path);                                     // .png
  void add_pictures(const PictureOptions& options, const std::string& image);  // of one view
  void add_files(const std::vector<std::string>& pictures);                    // of a checked view
  void add_state(const std::string& path);                                     // .vdb
  void add_report(const std::string& path);                                    // .json
  void add_table(const std::string& path);                                     // .csv
  void add_log(const std::string& path);                                       // .jsonl
  void add_chart(const std::string& path);                                     // .svg
  void add_like(const std::string& path, const std::string& input);            // input's extension
  void add_dense(const std::string& path);  // a format of volume_writer.h; pairs count both files

  /// The files, in the order in which they were added.
  const std::vector<std::string>& files() const { return m_files; }

 private:
  void add_file(const std::string& path);
  bool is_read(const std::string& place);

  bool m_may_overwrite;
  bool m_creates_folders;
  std::set<std::string> m_inputs, m_outputs;  // canonical
  std::vector<std::string> m_files;
  std::vector<std::pair<std::string, ReadOptions>> m_unopened;  // inputs whose files are not known
};

}  // namespace supple::tools
