// The session behind the pages: takes what they say, answers, and shows them what it leads to. A
// thread of its own solves and renders; those of the sockets hand messages in and never wait for
// it.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "tools/viewer/dropped_files.h"
#include "tools/viewer/open_scene.h"
#include "tools/viewer/opened_file.h"
#include "tools/viewer/page_message.h"
#include "tools/viewer/page_session.h"
#include "volumes/base/value.h"

namespace supple::tools {

struct ViewerOptions {
  std::string input;     // a volume, state, scene or journal; empty: nothing yet
  std::string material;  // of a volume; empty: one that fits its densities
  std::string preset;
  double budget_ms = 40;
  PixelSize size{512, 512};
  std::string sessions;                // folder of the journals that are kept; empty: none
  bool go_on = false;                  // where the last session of the input ended
  std::vector<std::string> embedders;  // origins whose pages may hear what happens
  double drop_limit_mb = 4096;         // of files that pages upload, together; 0: none
};

class Viewer final : public PageSession {
 public:
  /// Throws as OpenScene for what the options open.
  Viewer(const ViewerOptions& options, const Folders& folders, Console& console);
  ~Viewer() override;

  int join(std::shared_ptr<PageOutlet> page) override;
  void leave(int page) override;
  void receive(int page, std::string_view text) override;
  std::unique_ptr<FileReceiver> receive_file(const std::string& target,
                                             std::uint64_t bytes) override {
    return m_dropped->receiver_of(target, bytes);
  }
  std::size_t page_count() const override { return m_pages.count(); }
  int pages_so_far() const override { return m_pages.joined(); }
  void end(const std::string& reason) override;
  bool has_ended() const override { return m_has_ended; }
  void join_thread() override;

 private:
  void begin();
  void run();
  void answer(int page, const PageMessage& message, const Value& ok);
  void answer_error(int page, const PageMessage& message, const std::string& why);
  void dispatch(int page, const PageMessage& message);
  void take_event(int page, const PageMessage& message);
  void take_ack(int page, const PageMessage& message);
  void take_open(int page, const PageMessage& message);
  void take_go_on(int page, const PageMessage& message);
  void take_cancel(int page, const PageMessage& message);
  /// Takes how the pages want to see the scene.
  void take_wish(const PageMessage& message);
  void take_curtain(const PageMessage& message);
  void take_size(const PageMessage& message);
  void take_slices(const PageMessage& message);
  void see();
  void see_soon(int page, const PageMessage& message);
  void interrupt();
  std::uint64_t take_number(int page, const PageMessage& message);
  using Question = std::function<Value(OpenScene&)>;
  /// Runs on the session's thread, and answers with what it returns.
  void answer_later(int page, const PageMessage& message, const Question& work);
  void open(const OpenedFile& file, const std::string& input, const std::string& replaces = "",
            int dropped = 0);
  void open_later(int page, const PageMessage& message, const std::function<void()>& opens);
  void go_on_with(const LeftSession& left, bool is_own_input);
  double now_ms() const;
  OpenScene& opened();

  const ViewerOptions m_options;
  const Folders m_folders;
  const std::shared_ptr<DroppedFiles> m_dropped;
  Console& m_console;
  const std::string m_session_id;
  const std::chrono::steady_clock::time_point m_start = std::chrono::steady_clock::now();
  Pages m_pages;
  FrameEncoder m_encoder;
  PageProgress m_progress;
  EventMailbox m_mailbox;

  std::mutex m_guard;  // of what follows
  ViewSettings m_settings;
  LabelNames m_label_names;
  bool m_has_scene = false, m_is_view_posted = false;
  std::optional<LeftSession> m_left;  // which the pages are asked about
  std::uint64_t m_next_number = 1, m_view_number = 0;
  OpenScene* m_interruptible = nullptr;

  std::unique_ptr<OpenScene> m_scene, m_next;  // of the session's thread
  int m_openings = 0;                          // so far
  std::atomic<int> m_open_drop{0};             // the group that is open; 0: another file
  std::atomic<bool> m_ends{false}, m_has_ended{false};
  std::exception_ptr m_failure;
  std::thread m_thread;
};

}  // namespace supple::tools
