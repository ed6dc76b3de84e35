// Journals of sessions on disk, written as the events happen, so that a program that is killed
// loses at most the event on its way; and the sessions that were left with something unsaved.
//
// A file is a journal that `supple replay` runs at any moment, with what it needs to know in
// comments: the input that was opened, and a line "# saved" after the events that a save holds. An
// event is one write, what it replaces is cut off before; what a full disk takes in part is cut off
// again and written with the next event. A power cut loses at most a second.
#pragma once

#include <chrono>
#include <condition_variable>
#include <ctime>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tools/viewer/folders.h"
#include "volumes/base/value.h"

namespace supple::tools {

// Brings to the disk what is written into a file, so that a power cut loses no more than a second
// of it, while nobody who writes waits for the disk.

class DiskSync {
 public:
  /// `sync` is called on a thread of its own, at most once in `every`, as long as something was
  /// written since it was called last.
  DiskSync(std::function<void()> sync, std::chrono::milliseconds every);
  /// Calls `sync` a last time where something was written since.
  ~DiskSync();
  DiskSync(const DiskSync&) = delete;
  DiskSync& operator=(const DiskSync&) = delete;

  void wrote();

 private:
  void run();

  const std::function<void()> m_sync;
  const std::chrono::milliseconds m_every;
  std::mutex m_guard;
  std::condition_variable m_changed;
  bool m_is_behind = false, m_ends = false;
  std::thread m_thread;
};

/// $XDG_STATE_HOME/supple/sessions, by default ~/.local/state/supple/sessions; empty: neither the
/// variable nor a home is there.
std::string folder_of_kept_sessions();

/// A journal whose program has ended.
struct LeftSession {
  std::string path;   // of the journal
  std::string input;  // that was opened
  std::string volume;
  std::string ended;  // local time
  int unsaved = 0;    // events but for cameras
};

/// Words for it: volume, time and events.
std::string text_of(const LeftSession& left);

/// The session that ended last with something unsaved: of that input, or where none is given of a
/// volume within the folders.
std::optional<LeftSession> left_session(const std::string& folder, const std::string& input,
                                        const Folders& folders);

/// The text of its journal without an event that was written in part. Throws InputError.
std::string journal_of(const LeftSession& left);

/// The journal of one session. Nothing is written before its first event.
class KeptJournal {
 public:
  using Warn = std::function<void(const std::string& line)>;
  /// `replaces`: a journal that this one goes on from, which goes when this one is there; empty:
  /// none.
  KeptJournal(std::string folder, std::string input, std::string replaces, Warn warn);
  /// Removes the file where all was saved.
  ~KeptJournal();
  KeptJournal(const KeptJournal&) = delete;
  KeptJournal& operator=(const KeptJournal&) = delete;

  /// An event as JSON; `journal` gives the journal with it. What cannot be written is warned of
  /// once, and tried again with the next event.
  void add(const Value& event, bool replaces_last, const std::function<Value()>& journal);
  /// A file holds all events so far.
  void saved();
  const std::string& path() const { return m_path; }

 private:
  void begin(const std::function<Value()>& journal);
  bool make_folder();
  bool make_file(const std::string& text);
  void append(const std::string& text, bool replaces_last);
  void write_pending();
  void fail(const std::string& what, int error);

  const std::string m_folder, m_input;
  std::string m_replaces, m_path;
  Warn m_warn;
  int m_file = -1;
  std::int64_t m_whole = 0;  // bytes of whole events that are written
  std::int64_t m_last = 0;   // where the last of them begins
  std::string m_pending;     // not written yet
  bool m_is_saved = true, m_has_failed = false;
  std::time_t m_next_try = 0;      // to begin a file, after a failure
  std::optional<DiskSync> m_sync;  // of m_file
};

}  // namespace supple::tools
