#include "tools/viewer/disk_sync.h"

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

}  // namespace supple::tools
