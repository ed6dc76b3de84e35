// The session behind a socket: what pages join, speak to and leave. A server knows no more of what
// it serves.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "tools/viewer/pages.h"

namespace supple::tools {

/// Takes the bytes of one file, in order. Of one that was not finished nothing is left.
class FileReceiver {
 public:
  virtual ~FileReceiver() = default;
  /// Throws Error where it cannot be kept.
  virtual void add(const char* bytes, std::size_t count) = 0;
  virtual void finish() = 0;
};

class PageSession {
 public:
  virtual ~PageSession() = default;

  /// Adds a page, from any thread.
  virtual int join(std::shared_ptr<PageOutlet> page) = 0;
  virtual void leave(int page) = 0;
  /// Takes one message. Throws BadMessage: the connection is to be closed.
  virtual void receive(int page, std::string_view text) = 0;
  /// Begins to take a file whose address and length a page has announced. Throws Error.
  virtual std::unique_ptr<FileReceiver> receive_file(const std::string& target,
                                                     std::uint64_t bytes) = 0;
  virtual std::size_t page_count() const = 0;
  virtual int pages_so_far() const = 0;
  /// Says good-bye and ends the session; what runs is cancelled.
  virtual void end(const std::string& reason) = 0;
  /// True if the session's thread has ended by itself, by an error or a signal.
  virtual bool has_ended() const = 0;
  /// Throws what ended it, if anything did.
  virtual void join_thread() = 0;
  /// The file that the page begins with.
  virtual std::string first_file() const { return "index.html"; }
};

}  // namespace supple::tools
