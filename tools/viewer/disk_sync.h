// Brings to the disk what is written into a file, so that a power cut loses no more than a second
// of it, while nobody who writes waits for the disk.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace supple::tools {

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

}  // namespace supple::tools
