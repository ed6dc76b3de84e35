#include "tools/viewer/dropped_files.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <set>

#include <fcntl.h>
#include <unistd.h>

#include "volumes/base/atomic_file.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFiles = 5000;
constexpr std::size_t kLongestName = 200;
constexpr std::size_t kMostGroups = 16;
/// Left free on the disk.
constexpr std::uint64_t kSpareBytes = std::uint64_t(64) << 20;

std::string megabytes(std::uint64_t bytes) {
  return std::to_string((bytes + 999999) / 1000000) + " MB";
}

void require_plain(const std::string& name) {
  const bool is_plain = std::none_of(name.begin(), name.end(), [](char c) {
    return (c >= 0 && c < ' ') || c == 127 || c == '/' || c == '\\';
  });
  if (is_plain && !name.empty() && name.front() != '.' && name.size() <= kLongestName) return;
  throw InputError({name.substr(0, 100), "name", "no plain name",
                    "one without folders and control characters, that no dot begins"});
}

std::string new_root() {
  std::string name = (fs::temp_directory_path() / "supple-dropped-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw_write_error(name, errno);
  return name;
}

/// Reads a number in a target; -1: none.
int number_in(const std::string& text) {
  const bool is_number =
      !text.empty() && text.size() < 9 && text.find_first_not_of("0123456789") == std::string::npos;
  return is_number ? std::stoi(text) : -1;
}

/// Ranks a file by what it is opened as: the least of a folder is opened.
int rank_of(const std::string& name) {
  static const std::vector<std::vector<std::string>> ranks = {
      {".toml"}, {".vdb"}, {".nhdr", ".mhd", ".hdr"}};
  for (std::size_t rank = 0; rank < ranks.size(); ++rank) {
    for (const std::string& end : ranks[rank]) {
      if (ends_with(name, end)) return int(rank);
    }
  }
  return int(ranks.size());
}

}  // namespace

/// The bytes go into a hidden file, whose name no other has, until they are complete.
class DroppedFiles::Receiver final : public FileReceiver {
 public:
  Receiver(std::shared_ptr<DroppedFiles> all, int number, std::size_t file, const std::string& path)
      : m_all(std::move(all)),
        m_number(number),
        m_file(file),
        m_path(path),
        m_part(fs::path(path).parent_path().string() + "/." + std::to_string(file)),
        m_descriptor(::open(m_part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600)) {
    if (m_descriptor < 0) throw_write_error(m_path, errno);
  }
  ~Receiver() override {
    if (m_descriptor < 0) return;
    ::close(m_descriptor);
    ::unlink(m_part.c_str());
    m_all->done(m_number, m_file, false);
  }

  void add(const char* bytes, std::size_t count) override {
    while (count > 0) {
      const ssize_t written = ::write(m_descriptor, bytes, count);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) throw_write_error(m_path, errno);
      bytes += written;
      count -= std::size_t(written);
    }
  }
  void finish() override {
    if (::rename(m_part.c_str(), m_path.c_str()) != 0) throw_write_error(m_path, errno);
    ::close(std::exchange(m_descriptor, -1));
    m_all->done(m_number, m_file, true);
  }

 private:
  const std::shared_ptr<DroppedFiles> m_all;
  const int m_number;
  const std::size_t m_file;
  const std::string m_path, m_part;
  int m_descriptor;
};

DroppedFiles::~DroppedFiles() {
  std::error_code ignored;
  if (!m_root.empty()) fs::remove_all(m_root, ignored);
}

int DroppedFiles::announce(int page, const std::vector<AnnouncedFile>& files) {
  if (files.empty() || files.size() > kMostFiles) {
    throw InputError({"", "files", std::to_string(files.size()),
                      "1 to " + std::to_string(kMostFiles) + " files at once"});
  }
  std::set<std::string> names;
  std::uint64_t bytes = 0;
  const auto add = [&](std::uint64_t more) { bytes += std::min(more, UINT64_MAX - bytes); };
  for (const AnnouncedFile& file : files) {
    require_plain(file.name);
    if (!names.insert(file.name).second) {
      throw InputError({file.name, "name", "two files of this name", "files of one folder"});
    }
    add(file.bytes);
  }
  const std::uint64_t announced = bytes;
  const std::lock_guard lock(m_guard);
  for (const auto& [number, group] : m_groups) {
    for (const AnnouncedFile& file : group.files) add(file.bytes);
  }
  if (bytes > m_most_bytes || m_groups.size() == kMostGroups) {
    throw InputError({files.front().name, "drop", megabytes(announced) + " to be copied",
                      "at most " + megabytes(m_most_bytes) +
                          " together (see --drop-limit); Open reads larger files in their place"});
  }
  if (m_root.empty()) m_root = new_root();
  const std::uint64_t free = fs::space(m_root).available;
  if (announced + kSpareBytes > free) {
    throw InputError({files.front().name, "drop", megabytes(announced) + " to be copied",
                      "at most the " + megabytes(free) + " that are free in " + m_root});
  }
  Group made;
  made.page = page;
  made.folder = m_root + "/" + std::to_string(++m_last);
  made.files = files;
  made.is_begun.resize(files.size());
  made.is_there.resize(files.size());
  fs::create_directory(made.folder);
  m_groups[m_last] = std::move(made);
  return m_last;
}

DroppedFiles::Group& DroppedFiles::group(int number) {
  const auto found = m_groups.find(number);
  if (found != m_groups.end()) return found->second;
  throw InputError({"", "drop", std::to_string(number), "files that were announced"});
}

std::unique_ptr<FileReceiver> DroppedFiles::receiver_of(const std::string& target,
                                                        std::uint64_t bytes) {
  const std::size_t slash = target.find('/');
  const int number = number_in(target.substr(0, slash));
  const int file = number_in(slash == std::string::npos ? "" : target.substr(slash + 1));
  if (number < 0 || file < 0) {
    throw InputError({"", "drop", "another address", "drop/GROUP/FILE"});
  }
  const std::lock_guard lock(m_guard);
  Group& of = group(number);
  const auto at = std::size_t(file);
  if (at >= of.files.size() || of.is_begun[at]) {
    throw InputError({"", "drop", target, "a file that was announced, once"});
  }
  if (of.files[at].bytes != bytes) {
    throw InputError({of.files[at].name, "length", std::to_string(bytes) + " bytes",
                      "the " + std::to_string(of.files[at].bytes) + " that were announced"});
  }
  auto receiver = std::make_unique<Receiver>(shared_from_this(), number, at,
                                             of.folder + "/" + of.files[at].name);
  of.is_begun[at] = true;
  return receiver;
}

void DroppedFiles::done(int number, std::size_t file, bool is_there) {
  const std::lock_guard lock(m_guard);
  const auto found = m_groups.find(number);
  if (found == m_groups.end()) return;
  found->second.is_there[file] = is_there;
  found->second.is_begun[file] = is_there;
}

std::string DroppedFiles::folder_of(int number) {
  const std::lock_guard lock(m_guard);
  const Group& of = group(number);
  for (std::size_t n = 0; n < of.files.size(); ++n) {
    if (!of.is_there[n]) throw InputError({of.files[n].name, "drop", "no file", "all its bytes"});
  }
  return of.folder;
}

void DroppedFiles::remove(std::map<int, Group>::iterator group) {
  std::error_code ignored;
  fs::remove_all(group->second.folder, ignored);
  m_groups.erase(group);
}

void DroppedFiles::forget(int number) {
  const std::lock_guard lock(m_guard);
  const auto found = m_groups.find(number);
  if (found != m_groups.end()) remove(found);
}

void DroppedFiles::forget_page(int page, int kept) {
  const std::lock_guard lock(m_guard);
  for (auto at = m_groups.begin(); at != m_groups.end();) {
    const auto group = at++;
    if (group->second.page == page && group->first != kept) remove(group);
  }
}

std::string file_to_open(const std::string& folder) {
  std::vector<std::pair<int, std::string>> ranked;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    ranked.emplace_back(rank_of(name), name);
  }
  std::sort(ranked.begin(), ranked.end());
  const auto& [rank, name] = ranked.front();
  const bool is_alone = ranked.size() == 1 || ranked[1].first != rank;
  if (is_alone) return folder + "/" + name;
  if (rank == rank_of("")) return folder;
  throw InputError({name, "drop", ranked[1].second + " beside it", "one that is to be opened"});
}

Value answer_drop(DroppedFiles& dropped, int page, Table& table, int open_group) {
  if (const auto group = table.get<long long>("forget")) {
    table.finish();
    if (*group != open_group) dropped.forget(int(*group));
    return true;
  }
  std::vector<AnnouncedFile> files;
  for (Table& file : table.tables("files")) {
    const auto bytes = file.get<long long>("bytes").value_or(-1);
    if (bytes < 0) file.fail("bytes", "another number", "the length of the file");
    const std::string name = file.require(file.get<std::string>("name"), "name", "a name");
    files.push_back({name, std::uint64_t(bytes)});
    file.finish();
  }
  table.finish();
  return dropped.announce(page, files);
}

}  // namespace supple::tools
