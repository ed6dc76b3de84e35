// HTTP and WebSocket, on the loopback unless told otherwise: serves the page, lets in who has the
// token (gatekeeper.h), and passes messages on to the session. Whoever misbehaves loses his own
// connection: requests of more than 8 kB or slower than ten seconds, but for files that a page has
// announced (dropped_files.h), messages of more than 1 MiB,
// more than 400 a second, or that are none; of connections that have not opened a socket at most 64
// are kept, the oldest goes.
//
// One thread, that of run(). Boost is known here, in page_socket.h and in file_upload.h alone.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/viewer/page_session.h"

namespace supple::tools {

// The page: files of tools/viewer/page, which the build embeds in the program.

struct EmbeddedFile {
  const char* path;  // below the folder
  const unsigned char* data;
  std::size_t size;
};
extern const std::vector<EmbeddedFile> kEmbeddedPage;  // in generated/tools/viewer/page.cpp

struct PageFile {
  std::string type;  // of media, as the extension says
  std::string bytes;
};

/// The file of a request's target, "/" being `first`. `folder`: where it is read instead;
/// empty: the embedded one. Nothing for targets that name none; of a folder only names of plain
/// letters.
std::optional<PageFile> page_file(const std::string& target, const std::string& folder,
                                  const std::string& first = "index.html");

struct ServerOptions {
  int port = 0;         // 0: the first free one of 21177 to 21184, or any
  double grace_s = 60;  // that the session outlives its last page; 0: for ever
  std::string page_folder;
  std::string token;
  std::string listen;                // an address instead of the loopback's; empty: those
  std::string base_path = "/";       // before the paths of the page, where a proxy leaves it there
  std::vector<std::string> origins;  // other ones of the page, as plain_origin() has them
  std::vector<std::string> embedders;  // whose pages may show this one, likewise
};

class Server {
 public:
  /// Listens on 127.0.0.1, and on ::1 where there is one, or where it is told to. Throws
  /// SystemError: the port is taken; InputError for what is no address.
  explicit Server(const ServerOptions& options);
  ~Server();

  int port() const;
  /// Address of the page, with the token.
  std::string address() const;
  /// Serves until `stops` says so, the session has ended, or the last page has been gone for long.
  /// Asked twenty times a second.
  void run(PageSession& session, const std::function<bool()>& stops);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace supple::tools
