// Files that a page uploads because the program has no path to them: each group in a folder of its
// own below one that nobody else may read, and that goes with this object. A page announces names
// and lengths first; what is too much, or no plain name, is refused before a byte comes.
//
// May be asked by several threads at once.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "tools/viewer/page_session.h"
#include "volumes/base/table.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// A file as a page announces it.
struct AnnouncedFile {
  std::string name;
  std::uint64_t bytes = 0;
};

/// Owned by shared pointers: what is on its way shares it, so that all goes with the last one.
class DroppedFiles : public std::enable_shared_from_this<DroppedFiles> {
 public:
  /// `most_bytes`: of all that is there at once; 0: nothing is taken.
  explicit DroppedFiles(std::uint64_t most_bytes) : m_most_bytes(most_bytes) {}
  ~DroppedFiles();
  DroppedFiles(const DroppedFiles&) = delete;
  DroppedFiles& operator=(const DroppedFiles&) = delete;

  /// Makes a folder for these files; the answer is its number. Throws InputError for names with
  /// folders, hidden ones, the same twice, too many, too long; SystemError.
  int announce(int page, const std::vector<AnnouncedFile>& files);
  /// Takes the bytes of file `target` ("3/0": the first one of group 3), once. Throws InputError
  /// for one that was not announced, with another length, or is there.
  std::unique_ptr<FileReceiver> receiver_of(const std::string& target, std::uint64_t bytes);
  /// The folder of a group whose files are all there. Throws InputError.
  std::string folder_of(int group);
  /// Removes a group, or nothing.
  void forget(int group);
  /// Removes the groups of a page but for `kept`, whose files are open.
  void forget_page(int page, int kept);

 private:
  struct Group {
    int page = 0;
    std::string folder;
    std::vector<AnnouncedFile> files;
    std::vector<bool> is_begun, is_there;
  };
  class Receiver;
  Group& group(int number);
  void remove(std::map<int, Group>::iterator group);
  void done(int number, std::size_t file, bool is_there);

  const std::uint64_t m_most_bytes;
  std::mutex m_guard;  // of what follows
  std::string m_root;  // empty: not made so far
  std::map<int, Group> m_groups;
  int m_last = 0;
};

/// Chooses what is opened of the files in a folder: the scene, else the state, else the header of a
/// volume, else the volume, where there is one of them; the folder itself where there are several,
/// as of a DICOM series. Throws InputError for several scenes, states or headers.
std::string file_to_open(const std::string& folder);

/// Answers the message `drop` of a page: the number of a group for `files`, or `forget` of one that
/// is not open. Throws InputError.
Value answer_drop(DroppedFiles& dropped, int page, Table& table, int open_group);

}  // namespace supple::tools
