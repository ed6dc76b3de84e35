#include "tools/viewer/kept_sessions.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tools/scene/file/live_event.h"
#include "volumes/base/error.h"
#include "volumes/base/table.h"
#include "volumes/base/text.h"
#include "volumes/base/toml.h"
#include "volumes/base/value.h"

namespace supple::tools {

DiskSync::DiskSync(std::function<void()> sync, std::chrono::milliseconds every)
    : m_sync(std::move(sync)), m_every(every), m_thread([this] { run(); }) {}

DiskSync::~DiskSync() {
  {
    const std::lock_guard lock(m_guard);
    m_ends = true;
  }
  m_changed.notify_all();
  m_thread.join();
}

void DiskSync::wrote() {
  {
    const std::lock_guard lock(m_guard);
    m_is_behind = true;
  }
  m_changed.notify_all();
}

void DiskSync::run() {
  std::unique_lock lock(m_guard);
  for (;;) {
    m_changed.wait(lock, [this] { return m_is_behind || m_ends; });
    if (!m_is_behind) return;
    m_is_behind = false;
    lock.unlock();
    m_sync();
    lock.lock();
    m_changed.wait_for(lock, m_every, [this] { return m_ends; });
  }
}

namespace {

namespace fs = std::filesystem;

constexpr const char* kTitle =
    "# A session of supple view, written as it happened; supple replay runs it.\n";
constexpr const char* kInput = "# input: ";
constexpr const char* kVolume = "# volume: ";
constexpr const char* kSaved = "# saved\n";
constexpr const char* kEvent = "\n[[event]]\n";
constexpr std::size_t kMostKept = 20;
constexpr std::time_t kTryAgainSeconds = 10;
constexpr auto kSyncEvery = std::chrono::milliseconds(800);
constexpr std::size_t kMostRead = std::size_t(256) << 20;

/// A file that no running session has open, as its lock says; -1: none.
class LeftFile {
 public:
  explicit LeftFile(const fs::path& path)
      : m_file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW)) {
    if (m_file >= 0 && ::flock(m_file, LOCK_EX | LOCK_NB) != 0) close();
  }
  ~LeftFile() { close(); }
  LeftFile(const LeftFile&) = delete;
  LeftFile& operator=(const LeftFile&) = delete;
  bool is_left() const { return m_file >= 0; }

 private:
  void close() {
    if (m_file >= 0) ::close(m_file);
    m_file = -1;
  }
  int m_file;
};

std::string contents_of(const fs::path& path) {
  std::error_code error;
  if (fs::file_size(path, error) > kMostRead || error) return "";
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string local_time(std::time_t time, const char* format) {
  std::tm parts{};
  ::localtime_r(&time, &parts);
  char text[64];
  return {text, std::strftime(text, sizeof text, format, &parts)};
}

/// The rest of the line that begins with `key`; the comments come before everything else.
std::string comment(const std::string& text, const std::string& key) {
  const std::size_t at = text.find("\n" + key);
  if (at == std::string::npos) return "";
  const std::size_t begin = at + 1 + key.size();
  return text.substr(begin, text.find('\n', begin) - begin);
}

int unsaved_events(const std::string& text) {
  const std::size_t saved = text.rfind(std::string("\n") + kSaved);
  int count = 0;
  for (std::size_t at = text.find(kEvent, saved == std::string::npos ? 0 : saved);
       at != std::string::npos; at = text.find(kEvent, at + 1)) {
    const std::size_t keys = at + std::strlen(kEvent);
    count += int(text.compare(keys, 15, "kind = \"camera\"") != 0);
  }
  return count;
}

/// Journals in a folder, newest first.
std::vector<fs::path> journals_in(const std::string& folder) {
  std::vector<std::pair<fs::file_time_type, fs::path>> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code gone;
    const auto time = entry->last_write_time(gone);
    if (!gone && entry->path().extension() == ".toml") found.emplace_back(time, entry->path());
  }
  std::sort(found.rbegin(), found.rend());
  std::vector<fs::path> paths;
  for (auto& [time, path] : found) paths.push_back(std::move(path));
  return paths;
}

void prune(const std::string& folder) {
  const std::vector<fs::path> all = journals_in(folder);
  for (std::size_t n = kMostKept; n < all.size(); ++n) {
    std::error_code ignored;
    if (LeftFile(all[n]).is_left()) fs::remove(all[n], ignored);
  }
}

/// Waits until names of files in the folder are on the disk.
void sync_folder(const std::string& folder) {
  const int opened = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (opened < 0) return;
  ::fsync(opened);
  ::close(opened);
}

/// Letters of a volume's name that any file system takes.
std::string plain_name(const std::string& path) {
  std::string name = fs::path(path).filename().string().substr(0, 60);
  name = name.substr(0, name.find('.', 1));
  for (char& c : name) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
    if (!is_plain) c = '_';
  }
  return name.empty() ? "session" : name;
}

std::string without_breaks(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
  return text;
}

}  // namespace

std::string folder_of_kept_sessions() {
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && fs::path(state).is_absolute()) {
    return (fs::path(state) / "supple/sessions").string();
  }
  const char* home = std::getenv("HOME");
  if (home == nullptr || !fs::path(home).is_absolute()) return "";
  return (fs::path(home) / ".local/state/supple/sessions").string();
}

std::optional<LeftSession> left_session(const std::string& folder, const std::string& input,
                                        const Folders& folders) {
  for (const fs::path& path : journals_in(folder)) {
    if (!LeftFile(path).is_left()) continue;
    const std::string text = contents_of(path);
    LeftSession left{path.string(), comment(text, kInput), comment(text, kVolume), "", 0};
    left.unsaved = unsaved_events(text);
    const bool fits =
        input.empty() ? folders.holds(left.volume) : left.input == without_breaks(input);
    if (!fits || left.unsaved == 0 || left.input.empty()) continue;
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) continue;
    left.ended = local_time(status.st_mtime, "%Y-%m-%d %H:%M");
    return left;
  }
  return std::nullopt;
}

std::string text_of(const LeftSession& left) {
  return "an earlier session of " + fs::path(left.volume).filename().string() + " ended " +
         left.ended + " with " + with_count(left.unsaved, "event") + " that no file holds";
}

std::string journal_of(const LeftSession& left) {
  std::string text = contents_of(left.path);
  for (;;) {
    try {
      Table::parse(text, left.path);
      return text;
    } catch (const InputError&) {
      const std::size_t last = text.rfind(kEvent);
      if (last == std::string::npos) throw;
      text.resize(last);
    }
  }
}

KeptJournal::KeptJournal(std::string folder, std::string input, std::string replaces, Warn warn)
    : m_folder(std::move(folder)),
      m_input(without_breaks(std::move(input))),
      m_replaces(std::move(replaces)),
      m_warn(std::move(warn)) {}

KeptJournal::~KeptJournal() {
  m_sync.reset();
  if (m_file < 0) return;
  if (m_is_saved && m_pending.empty()) ::unlink(m_path.c_str());
  ::close(m_file);
}

void KeptJournal::add(const Value& event, bool replaces_last,
                      const std::function<Value()>& journal) {
  if (m_folder.empty()) return;
  m_is_saved = m_is_saved && event["kind"] == Value("camera");
  if (m_file < 0) return begin(journal);
  append("\n" + toml_document({{"event", Value::List{event}}}), replaces_last);
}

void KeptJournal::saved() {
  m_is_saved = true;
  if (m_file >= 0) {
    append(std::string("\n") + kSaved, false);
    m_last = m_whole;
  } else if (!m_replaces.empty()) {
    ::unlink(std::exchange(m_replaces, "").c_str());
  }
}

bool KeptJournal::make_folder() {
  std::error_code error;
  fs::create_directories(fs::path(m_folder).parent_path(), error);
  return ::mkdir(m_folder.c_str(), 0700) == 0 || errno == EEXIST;
}

/// Makes the file, complete and on the disk before it has its name: what it replaces can go then.
bool KeptJournal::make_file(const std::string& text) {
  const std::string made = m_path + ".new";
  m_file = ::open(made.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (m_file < 0) return false;
  ::flock(m_file, LOCK_EX | LOCK_NB);
  const ssize_t written = ::write(m_file, text.data(), text.size());
  if (written >= 0 && written != ssize_t(text.size())) errno = ENOSPC;
  if (written == ssize_t(text.size()) && ::fdatasync(m_file) == 0 &&
      ::rename(made.c_str(), m_path.c_str()) == 0) {
    sync_folder(m_folder);
    m_sync.emplace([file = m_file] { ::fdatasync(file); }, kSyncEvery);
    return true;
  }
  const int why = errno;
  ::unlink(made.c_str());
  ::close(std::exchange(m_file, -1));
  errno = why;
  return false;
}

void KeptJournal::begin(const std::function<Value()>& journal) {
  const std::time_t now = std::time(nullptr);
  if (now < m_next_try) return;
  m_next_try = now + kTryAgainSeconds;
  if (!make_folder()) return fail("cannot be made", errno);
  prune(m_folder);
  std::string events = toml_document(journal());
  // What the file that was opened says, and what opening did, nobody loses.
  const std::size_t first = std::min(events.rfind(kEvent), events.size());
  if (m_replaces.empty()) events.insert(first, std::string("\n") + kSaved);
  Table root = Table::parse(events, "journal");
  const std::string volume = root.table("volume")->get<std::string>("path").value_or("");
  const std::string name = m_folder + "/" + plain_name(volume) + local_time(now, "-%Y%m%d-%H%M%S-");
  int number = ::getpid();
  do {
    m_path = name + std::to_string(number++) + ".toml";
  } while (fs::exists(m_path));
  const std::string text = std::string(kTitle) + kInput + m_input + "\n" + kVolume +
                           without_breaks(volume) + "\n" + events;
  if (!make_file(text)) return fail("cannot be written", errno);
  m_whole = std::int64_t(text.size());
  m_last = std::int64_t(std::min(text.rfind(kEvent), text.size()));
  if (!m_replaces.empty()) ::unlink(std::exchange(m_replaces, "").c_str());
}

void KeptJournal::append(const std::string& text, bool replaces_last) {
  if (replaces_last && m_pending.empty() && ::ftruncate(m_file, off_t(m_last)) == 0) {
    m_whole = m_last;
  }
  m_pending += text;
  write_pending();
}

void KeptJournal::write_pending() {
  const ssize_t written = ::pwrite(m_file, m_pending.data(), m_pending.size(), off_t(m_whole));
  if (written != ssize_t(m_pending.size())) {
    const int why = written < 0 ? errno : ENOSPC;
    if (::ftruncate(m_file, off_t(m_whole)) != 0) return fail("cannot be written", errno);
    return fail("cannot be written", why);
  }
  m_last = m_whole;
  m_whole += std::int64_t(written);
  m_pending.clear();
  m_sync->wrote();
}

void KeptJournal::fail(const std::string& what, int error) {
  if (std::exchange(m_has_failed, true)) return;
  m_warn((m_path.empty() ? m_folder : m_path) + ": " + what + " (" + std::strerror(error) +
         "): the session goes on, but would be lost if the program were killed; save it");
}

}  // namespace supple::tools
