// The pages that watch a session, and what is on its way to each. Pictures never queue: of a view
// only the newest waits, and a page that has not said that it got the last two gets no more. May be
// called from any thread; nothing here waits for a socket.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "tools/viewer/frame_message.h"
#include "volumes/base/value.h"

namespace supple::tools {

using SharedBytes = std::shared_ptr<const std::vector<std::uint8_t>>;

/// A connection, as seen from here: takes what it is to send, and returns at once.
class PageOutlet {
 public:
  virtual ~PageOutlet() = default;
  virtual void send_text(std::shared_ptr<const std::string> text) = 0;
  virtual void send_frame(std::vector<std::uint8_t> head,
                          std::shared_ptr<const FrameMessage> frame) = 0;
};

class Pages {
 public:
  static constexpr std::size_t kMostUnacknowledged = 2;

  /// Adds a page, which gets a first message, the scene, and the last picture of every view.
  int join(std::shared_ptr<PageOutlet> outlet, const std::string& hello);
  void leave(int page);
  std::size_t count() const;
  /// Number of pages that have ever joined.
  int joined() const;

  /// Notes that message `n` of the page is the session's `number`, which ascends.
  void note(int page, std::uint64_t number, std::uint32_t n);
  /// The last `n` of the page that is not after `number`; 0: none.
  std::uint32_t known(int page, std::uint64_t number) const;
  void acknowledge(int page, std::uint32_t frame);

  void tell(int page, const std::string& text);
  void tell_all(const std::string& text);
  /// A description of the scene as the session's `number` left it, with each page's n of that.
  void tell_scene(const Value& scene, std::uint64_t number);
  /// The message with that number could not be done: for the page that sent it, else for all.
  void tell_refused(std::uint64_t number, const std::string& why);
  /// Sends a picture; left out where a newer one of the view has been published.
  void publish(FrameMessage frame);
  /// As text, whatever bytes the strings hold.
  static std::string text_of(const Value& json);
  /// Pictures of what is not open any more.
  void forget_frames();
  /// Pictures at rest that no curtain shows any more.
  void forget_frames_at_rest();
  std::uint64_t next_stamp();

 private:
  using SharedFrame = std::shared_ptr<const FrameMessage>;
  struct Page {
    std::shared_ptr<PageOutlet> outlet;
    std::deque<std::pair<std::uint64_t, std::uint32_t>> numbers;  // and n, ascending; the last ones
    std::array<SharedFrame, kPictureCount> waiting;
    std::deque<std::uint32_t> unacknowledged;
  };
  static std::uint32_t shown_by(const Page& page, std::uint64_t number);
  std::shared_ptr<const std::string> scene_for(const Page& page) const;
  void send_waiting(Page& page);

  mutable std::mutex m_guard;
  std::map<int, Page> m_pages;
  std::array<SharedFrame, kPictureCount> m_last;
  std::string m_scene = "{\"scene\":null}";
  std::uint64_t m_scene_number = 0;
  int m_next_page = 1;
  std::uint32_t m_next_frame = 1;
  std::uint64_t m_next_stamp = 1;
};

}  // namespace supple::tools
