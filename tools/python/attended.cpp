#include "tools/python/attended.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace py = pybind11;

namespace supple::python {

namespace {

constexpr std::chrono::milliseconds kLook{20};

/// News of the work for the thread that waits.
class WaitingProgress final : public Progress {
 public:
  struct News {
    std::string stage;
    double fraction = 0;
    bool is_new = false;
  };

  void stage(std::string_view name) override {
    const std::lock_guard lock(m_guard);
    m_news = {std::string(name), 0, true};
  }
  void update(double fraction) override {
    const std::lock_guard lock(m_guard);
    m_news.fraction = fraction;
    m_news.is_new = true;
  }
  bool cancelled() const override { return m_is_cancelled.load(std::memory_order_relaxed); }
  void warn(const std::string& line) override { tell("warning", line); }
  void note(const std::string& line) override { tell("note", line); }
  void debug(const std::string& line) override { tell("debug", line); }

  void cancel() { m_is_cancelled = true; }
  void finish() {
    const std::lock_guard lock(m_guard);
    m_is_done = true;
    m_done.notify_one();
  }
  /// True once the work is done, after kLook at the latest.
  bool wait() {
    std::unique_lock lock(m_guard);
    return m_done.wait_for(lock, kLook, [&] { return m_is_done; });
  }
  News take_news() {
    const std::lock_guard lock(m_guard);
    News news = m_news;
    m_news.is_new = false;
    return news;
  }
  /// Kinds and lines, once the work is done.
  const std::vector<std::pair<const char*, std::string>>& lines() const { return m_lines; }

 private:
  void tell(const char* kind, const std::string& line) {
    const std::lock_guard lock(m_guard);
    m_lines.emplace_back(kind, line);
  }

  std::mutex m_guard;
  std::condition_variable m_done;
  News m_news;
  std::vector<std::pair<const char*, std::string>> m_lines;
  std::atomic<bool> m_is_cancelled{false};
  bool m_is_done = false;
};

/// Looks for signals and tells the callback; returns what Python throws.
std::exception_ptr attend_once(const py::object& callback, WaitingProgress& progress) {
  const py::gil_scoped_acquire python;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    const WaitingProgress::News news = progress.take_news();
    if (callback.is_none() || !news.is_new) return nullptr;
    if (callback(news.stage, news.fraction).is(py::bool_(false))) progress.cancel();
    return nullptr;
  } catch (...) {
    return std::current_exception();
  }
}

}  // namespace

void attend(const py::object& callback, const std::function<void(Progress&)>& work) {
  WaitingProgress progress;
  std::exception_ptr of_python, of_work;
  {
    const py::gil_scoped_release others;
    std::thread worker([&] {
      try {
        work(progress);
      } catch (...) {
        of_work = std::current_exception();
      }
      progress.finish();
    });
    while (!progress.wait()) {
      if (of_python) continue;
      of_python = attend_once(callback, progress);
      if (of_python) progress.cancel();
    }
    worker.join();
  }
  if (of_python) std::rethrow_exception(of_python);
  if (!progress.lines().empty()) {
    const py::object tell = py::module_::import("supple._errors").attr("tell");
    for (const auto& [kind, line] : progress.lines()) tell(kind, line);
  }
  if (of_work) std::rethrow_exception(of_work);
}

}  // namespace supple::python
