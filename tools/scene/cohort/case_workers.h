// Threads that wait for processes: each runs one task and hands on its end, or its exception.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "volumes/base/progress.h"

namespace supple::tools {

/// Up to `most` tasks at a time. Used by one thread, but for stops().
template <class End>
class CaseWorkers {
 public:
  CaseWorkers(int most, const Progress& progress) : m_most(most), m_progress(progress) {}
  /// Asks tasks to stop and waits for them.
  ~CaseWorkers() {
    m_stops = true;
    for (auto& [number, thread] : m_threads) thread.join();
  }
  CaseWorkers(const CaseWorkers&) = delete;
  CaseWorkers& operator=(const CaseWorkers&) = delete;

  bool is_full() const { return int(m_threads.size()) >= m_most; }
  bool is_idle() const { return m_threads.empty(); }
  /// True once tasks are to end; asked by them.
  bool stops() const { return m_stops || m_progress.cancelled(); }

  void start(std::function<End()> task) {
    const int number = m_count++;
    m_threads.emplace(number, std::thread([this, number, task = std::move(task)] {
                        Ended ended{number, std::nullopt, nullptr};
                        try {
                          ended.end = task();
                        } catch (...) {
                          ended.thrown = std::current_exception();
                        }
                        const std::lock_guard<std::mutex> lock(m_mutex);
                        m_ended.push_back(std::move(ended));
                        m_has_ended.notify_one();
                      }));
  }

  /// Waits for the end of a task, of which one must run. Throws what it threw; Cancelled.
  End next() {
    std::unique_lock<std::mutex> lock(m_mutex);
    while (m_ended.empty()) {
      m_has_ended.wait_for(lock, std::chrono::milliseconds(20));
      poll(&m_progress);
    }
    Ended ended = std::move(m_ended.front());
    m_ended.pop_front();
    lock.unlock();
    m_threads.at(ended.number).join();
    m_threads.erase(ended.number);
    if (ended.thrown) std::rethrow_exception(ended.thrown);
    return std::move(*ended.end);
  }

 private:
  struct Ended {
    int number;
    std::optional<End> end;
    std::exception_ptr thrown;
  };

  const int m_most;
  const Progress& m_progress;
  int m_count = 0;
  std::map<int, std::thread> m_threads;
  std::atomic<bool> m_stops{false};
  std::mutex m_mutex;
  std::condition_variable m_has_ended;
  std::deque<Ended> m_ended;
};

}  // namespace supple::tools
