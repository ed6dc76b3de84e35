// A page's socket: messages of the page go to the session, what it sends waits here until
// the page takes it. A page that sends too much, too often or no text, or does not read, is closed.
#pragma once

#include <chrono>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include "tools/viewer/gatekeeper.h"
#include "tools/viewer/page_session.h"

namespace supple::tools {

using Error_code = boost::beast::error_code;
using Tcp = boost::asio::ip::tcp;
using SteadyClock = std::chrono::steady_clock;

/// The objects that all connections share.
struct ServedSession {
  PageSession& session;
  const Gatekeeper& gatekeeper;
  const std::string& page_folder;
  const std::string& base_path;
};

/// Answers the request, whose token has been checked. The socket lives as long as its connection,
/// on the thread of its executor.
void open_page_socket(Tcp::socket&& socket, const ServedSession& served,
                      boost::beast::http::request<boost::beast::http::empty_body> request);

}  // namespace supple::tools
