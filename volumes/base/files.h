// Files and folders beside AtomicFile: which may be read, small texts whole, folders that an output
// needs, names held by one process while it computes their contents, and scratch folders.
#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace supple {

/// Throws InputError for a folder, a pipe, a socket or a device: opening a pipe would wait for its
/// writer, and a device may never end. A missing file passes, since opening it says so.
void require_regular_file(const std::string& path);

/// Reads a file; empty where it cannot be read.
std::string text_of_file(const std::string& path);
/// Reads an input whole. Throws InputError as require_regular_file() and where it is missing;
/// SystemError where not all of it can be read.
std::string text_of_input(const std::string& path);
/// Replaces the file as a whole, or not at all. Throws SystemError, InputError as AtomicFile.
void replace_text_file(const std::string& path, const std::string& text);

/// Folders that are empty in the end vanish with the object, unless keep() was called.
class MadeFolders {
 public:
  MadeFolders() = default;
  ~MadeFolders();
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

  /// Makes a folder and those above it where they are missing.
  void make(const std::filesystem::path& folder);
  void keep() { m_folders.clear(); }
  /// Folders that were made, each after those that it lies in.
  const std::deque<std::filesystem::path>& made() const { return m_folders; }

 private:
  std::deque<std::filesystem::path> m_folders;  // the innermost last
};

/// Remains of an output when its process ends at once.
struct Remains {
  std::string path;  // a file or an empty folder
  int lock = -1;     // descriptor of a lock file, which goes only with the last that uses it

  /// Calls nothing that a signal handler may not call.
  void remove() const;
};

/// Holds one byte for each name of a lock file ".supple.lock" in the folder of the outputs. The
/// locks end with the process, however it ends; the file goes with the last object that uses it.
class ReservedNames {
 public:
  ReservedNames() = default;
  ~ReservedNames();
  ReservedNames(const ReservedNames&) = delete;
  ReservedNames& operator=(const ReservedNames&) = delete;

  /// Makes missing folders, which go with the object unless something is in them, and removes the
  /// temporary files that killed processes left for this name. Returns its possible remains, in the
  /// order of making: folders, the lock file, the temporary file of an AtomicFile. Throws
  /// SystemError where another process or object holds the name, and as AtomicFile.
  std::vector<Remains> add(const std::string& final_path);

 private:
  struct Folder {
    int descriptor = -1;  // of the lock file; -1 on file systems without locks
    std::multimap<std::string, std::filesystem::path> leftovers;  // by the name of the output
  };
  Folder& folder_of(const std::filesystem::path& path, const std::string& final_path);

  MadeFolders m_made;
  std::map<std::filesystem::path, Folder> m_folders;
};

/// A folder of its own, among the temporary ones, for files that no other program is to see. It
/// goes with all that is in it when the object does; where its process is killed first, when the
/// next one is made, at the earliest after a minute.
class ScratchFolder {
 public:
  /// Throws SystemError.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::string& path() const { return m_path; }
  std::string operator/(const std::string& name) const { return m_path + "/" + name; }

 private:
  std::string m_path;
  int m_lock = -1;  // held as long as the folder is in use
};

}  // namespace supple
