// The session behind pages that watch and lead an operation (docs/live.md, "Operations"). A thread
// of its own steps and draws; those of the sockets hand messages in and never wait for it. While no
// page is there, time stands still.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

#include "tools/scene/operation/event_news.h"
#include "tools/scene/operation/live_operation.h"
#include "tools/scene/operation/operation_loop.h"
#include "tools/viewer/folders.h"
#include "tools/viewer/page_message.h"
#include "tools/viewer/page_session.h"
#include "volumes/base/table.h"

namespace supple::tools {

class OperationViewer final : public PageSession, private OperationListener {
 public:
  /// Opens the root of an operation's scene. Throws as LiveOperation.
  OperationViewer(const Table& root, const Folders& folders);
  ~OperationViewer() override;

  int join(std::shared_ptr<PageOutlet> page) override;
  void leave(int page) override;
  void receive(int page, std::string_view text) override;
  std::unique_ptr<FileReceiver> receive_file(const std::string&, std::uint64_t) override {
    throw InputError({"", "drop", "a file", "none; an operation is a scene of its own"});
  }
  std::size_t page_count() const override { return m_pages.count(); }
  int pages_so_far() const override { return m_pages.joined(); }
  void end(const std::string& reason) override;
  bool has_ended() const override { return m_has_ended; }
  void join_thread() override;
  std::string first_file() const override { return "operation.html"; }

 private:
  using Clock = std::chrono::steady_clock;
  using Work = std::function<Value()>;

  void run();
  void stepped(const OperationSample& sample) override;
  void pictured(const Image& image, const PixelSize& size) override;
  Work work_of(const PageMessage& message);
  Work instrument_work(Table table);
  Work view_work(Table table);
  Work membrane_work(Table table);
  Work operation_work(Table table);
  Value save(const std::string& path, bool may_overwrite);
  void watch();
  void do_later(int page, const PageMessage& message, const Work& work);
  void refuse(int page, const PageMessage& message, const std::string& why);
  void tell_status(bool at_once);

  const Folders m_folders;
  const std::string m_session_id;
  LiveOperation m_live;
  OperationLoop m_loop;
  Pages m_pages;
  std::atomic<std::uint64_t> m_next_number{1};

  // Of the loop's thread.
  std::uint64_t m_done = 0;                     // number of the last message
  std::vector<Clock::time_point> m_unpictured;  // arrivals of what no picture shows
  EventNews m_news;
  RecentTimes m_encodings, m_latencies;
  Clock::time_point m_told;

  std::atomic<bool> m_ends{false}, m_has_ended{false};
  std::exception_ptr m_failure;
  std::thread m_thread;
};

}  // namespace supple::tools
