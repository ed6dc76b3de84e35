#include "tools/viewer/server.h"

#include <deque>
#include <list>
#include <variant>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "tools/viewer/gatekeeper.h"
#include "tools/viewer/page_files.h"

namespace supple::tools {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Error_code = beast::error_code;
using Tcp = asio::ip::tcp;
using SteadyClock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kRequestTime = 10s;
constexpr auto kIdleTime = 60s;
constexpr auto kLookEvery = 50ms;
constexpr std::uint32_t kMostHeaderBytes = 8192;
constexpr std::size_t kMostPending = 64;                  // connections without a socket
constexpr double kMessagesPerSecond = 400, kBurst = 800;  // that a page may send
constexpr std::size_t kMostQueuedBytes = std::size_t(64) << 20;

/// Tokens that come back with time.
class MessageRate {
 public:
  bool allows_one() {
    const auto now = SteadyClock::now();
    m_left = std::min(
        kBurst, m_left + kMessagesPerSecond * std::chrono::duration<double>(now - m_last).count());
    m_last = now;
    m_left -= 1;
    return m_left >= 0;
  }

 private:
  double m_left = kBurst;
  SteadyClock::time_point m_last = SteadyClock::now();
};

/// What connections share.
struct Served {
  Viewer& viewer;
  const Gatekeeper& gatekeeper;
  const std::string& page_folder;
};

/// A page's socket. Everything runs on the thread of the server, but for send_…(), which hand over.
class PageSocket final : public PageOutlet, public std::enable_shared_from_this<PageSocket> {
 public:
  PageSocket(Tcp::socket&& socket, const Served& served)
      : m_socket(std::move(socket)), m_served(served) {}

  void accept(http::request<http::empty_body> request) {
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = kRequestTime;
    timeout.idle_timeout = kIdleTime;
    timeout.keep_alive_pings = true;
    m_socket.set_option(timeout);
    m_socket.read_message_max(kMostMessageBytes);
    m_socket.auto_fragment(false);
    const std::string protocol = m_served.gatekeeper.protocol();
    m_socket.set_option(
        websocket::stream_base::decorator([protocol](websocket::response_type& response) {
          response.set(http::field::sec_websocket_protocol, protocol);
        }));
    m_request = std::move(request);
    m_socket.async_accept(m_request, [self = shared_from_this()](Error_code error) {
      if (!error) self->begin();
    });
  }

  void send_text(std::shared_ptr<const std::string> text) override {
    asio::post(m_socket.get_executor(), [self = shared_from_this(), text = std::move(text)] {
      self->enqueue(std::move(text), text->size());
    });
  }
  void send_frame(std::vector<std::uint8_t> head,
                  std::shared_ptr<const FrameMessage> frame) override {
    asio::post(m_socket.get_executor(),
               [self = shared_from_this(), head = std::move(head), frame = std::move(frame)] {
                 self->enqueue(Picture{head, frame}, head.size() + frame->picture.size());
               });
  }

 private:
  using Text = std::shared_ptr<const std::string>;
  struct Picture {
    std::vector<std::uint8_t> head;
    std::shared_ptr<const FrameMessage> frame;
  };

  void begin() {
    m_page = m_served.viewer.join(shared_from_this());
    read();
  }

  void read() {
    m_socket.async_read(m_incoming, [self = shared_from_this()](Error_code error, std::size_t) {
      if (error) return self->end();
      self->receive();
    });
  }

  void receive() {
    if (!m_socket.got_text()) return close(websocket::close_code::unknown_data, "text alone");
    if (!m_rate.allows_one()) {
      return close(websocket::close_code::policy_error, "more than 400 messages a second");
    }
    const std::string text = beast::buffers_to_string(m_incoming.data());
    m_incoming.consume(m_incoming.size());
    try {
      m_served.viewer.receive(m_page, text);
    } catch (const BadMessage& bad) {
      return close(websocket::close_code::bad_payload, bad.what());
    }
    if (!m_is_closing) read();
  }

  void enqueue(std::variant<Text, Picture> message, std::size_t bytes) {
    if (m_is_closing) return;
    m_queued_bytes += bytes;
    if (m_queued_bytes > kMostQueuedBytes) return abandon();
    m_outgoing.emplace_back(std::move(message));
    if (m_outgoing.size() == 1) write();
  }

  void write() {
    const auto written = [self = shared_from_this()](Error_code error, std::size_t bytes) {
      if (error) return self->end();
      self->m_outgoing.pop_front();
      self->m_queued_bytes -= std::min(bytes, self->m_queued_bytes);
      if (self->m_is_closing) return self->say_close();
      if (!self->m_outgoing.empty()) self->write();
    };
    if (const Text* text = std::get_if<Text>(&m_outgoing.front())) {
      m_socket.text(true);
      return m_socket.async_write(asio::buffer(**text), written);
    }
    const Picture& picture = std::get<Picture>(m_outgoing.front());
    m_socket.binary(true);
    m_socket.async_write(std::array<asio::const_buffer, 2>{asio::buffer(picture.head),
                                                           asio::buffer(picture.frame->picture)},
                         written);
  }

  void close(websocket::close_code code, const std::string& why) {
    if (m_is_closing) return;
    m_is_closing = true;
    m_reason = websocket::close_reason(code, why.substr(0, 120));
    leave();
    if (m_outgoing.empty()) say_close();
  }

  void say_close() {
    m_socket.async_close(m_reason, [self = shared_from_this()](Error_code) {});
  }

  /// One that does not read what it is sent.
  void abandon() {
    end();
    beast::get_lowest_layer(m_socket).close();
  }

  void end() {
    m_is_closing = true;
    leave();
  }
  void leave() {
    if (m_page != 0) m_served.viewer.leave(std::exchange(m_page, 0));
  }

  websocket::stream<beast::tcp_stream> m_socket;
  const Served& m_served;
  http::request<http::empty_body> m_request;
  beast::flat_buffer m_incoming{kMostMessageBytes};
  MessageRate m_rate;
  int m_page = 0;
  std::deque<std::variant<Text, Picture>> m_outgoing;
  std::size_t m_queued_bytes = 0;
  bool m_is_closing = false;
  websocket::close_reason m_reason;
};

/// One that asks for files of the page, until it opens a socket.
class Visitor final : public std::enable_shared_from_this<Visitor> {
 public:
  Visitor(Tcp::socket&& socket, const Served& served)
      : m_stream(std::move(socket)), m_served(served) {}

  void read() {
    m_parser.emplace();
    m_parser->header_limit(kMostHeaderBytes);
    m_parser->body_limit(0);
    m_stream.expires_after(kRequestTime);
    http::async_read(
        m_stream, m_buffer, *m_parser, [self = shared_from_this()](Error_code error, std::size_t) {
          if (error == http::error::end_of_stream) return self->close();
          if (!error) return self->respond();
          if (error.category() == http::make_error_code(http::error::bad_method).category()) {
            self->send(http::status::bad_request, "text/plain", "bad request\n", false);
          }
        });
  }

  void close() {
    Error_code ignored;
    m_stream.socket().shutdown(Tcp::socket::shutdown_both, ignored);
    m_stream.close();
  }

 private:
  void respond() {
    const auto& request = m_parser->get();
    const Gatekeeper& gatekeeper = m_served.gatekeeper;
    const auto is_own = [&](http::field field, const auto& check) {
      return request.count(field) <= 1 && check(std::string(request[field]));
    };
    if (request.count(http::field::host) != 1 ||
        !gatekeeper.is_own_host(std::string(request[http::field::host])) ||
        !is_own(http::field::origin,
                [&](const std::string& origin) { return gatekeeper.is_own_origin(origin); })) {
      return send(http::status::forbidden, "text/plain", "not from this page\n", false);
    }
    const std::string target(request.target());
    if (target == "/socket") return upgrade();
    const bool is_head = request.method() == http::verb::head;
    if (!is_head && request.method() != http::verb::get) {
      return send(http::status::method_not_allowed, "text/plain", "GET or HEAD\n", false);
    }
    const std::optional<PageFile> file = page_file(target, m_served.page_folder);
    if (!file) return send(http::status::not_found, "text/plain", "no such file\n", true);
    send(http::status::ok, file->type, file->bytes, true);
  }

  void upgrade() {
    auto request = m_parser->release();
    const std::string protocols(request[http::field::sec_websocket_protocol]);
    if (!websocket::is_upgrade(request)) {
      return send(http::status::upgrade_required, "text/plain", "a socket\n", false);
    }
    if (request.count(http::field::sec_websocket_protocol) != 1 ||
        !m_served.gatekeeper.has_token(protocols)) {
      return send(http::status::forbidden, "text/plain", "another token\n", false);
    }
    m_stream.expires_never();
    const auto page = std::make_shared<PageSocket>(m_stream.release_socket(), m_served);
    page->accept(std::move(request));
  }

  void send(http::status status, const std::string& type, std::string bytes, bool stays) {
    const auto& request = m_parser->get();
    m_response = {};
    m_response.result(status);
    m_response.version(11);
    m_response.set(http::field::content_type, type);
    m_response.set(http::field::cache_control, "no-store");
    m_response.set("Content-Security-Policy",
                   "default-src 'none'; script-src 'self'; style-src 'self'; "
                   "img-src 'self' blob: data:; connect-src 'self'; base-uri 'none'; "
                   "form-action 'none'; frame-ancestors 'none'");
    m_response.set("X-Content-Type-Options", "nosniff");
    m_response.set("X-Frame-Options", "DENY");
    m_response.set("Referrer-Policy", "no-referrer");
    m_response.set("Cross-Origin-Opener-Policy", "same-origin");
    m_response.set("Cross-Origin-Resource-Policy", "same-origin");
    m_response.keep_alive(stays && request.keep_alive());
    m_response.content_length(bytes.size());
    if (request.method() != http::verb::head) m_response.body() = std::move(bytes);
    m_stream.expires_after(kRequestTime);
    m_serializer.emplace(m_response);
    http::async_write(m_stream, *m_serializer,
                      [self = shared_from_this()](Error_code error, std::size_t) {
                        if (error) return;
                        if (!self->m_response.keep_alive()) return self->close();
                        self->read();
                      });
  }

  beast::tcp_stream m_stream;
  const Served& m_served;
  beast::flat_buffer m_buffer{kMostHeaderBytes};
  std::optional<http::request_parser<http::empty_body>> m_parser;
  http::response<http::string_body> m_response;
  std::optional<http::response_serializer<http::string_body>> m_serializer;
};

Tcp::acceptor listener(asio::io_context& context, const Tcp::endpoint& endpoint) {
  Tcp::acceptor acceptor(context);
  acceptor.open(endpoint.protocol());
  acceptor.set_option(asio::socket_base::reuse_address(true));
  if (endpoint.protocol() == Tcp::v6()) acceptor.set_option(asio::ip::v6_only(true));
  acceptor.bind(endpoint);
  acceptor.listen();
  return acceptor;
}

}  // namespace

struct Server::Impl {
  explicit Impl(const ServerOptions& given) : options(given), timer(context) {}

  void accept(Tcp::acceptor& acceptor);
  void admit(Tcp::socket&& socket);
  void look();

  const ServerOptions options;
  asio::io_context context{1};
  std::optional<Tcp::acceptor> v4, v6;
  asio::steady_timer timer;
  std::optional<Gatekeeper> gatekeeper;
  std::optional<Served> served;
  std::list<std::weak_ptr<Visitor>> visitors;  // oldest first
  std::function<bool()> stops;
  int pages_seen = 0;
  SteadyClock::time_point last_page = SteadyClock::now();
};

Server::Server(const ServerOptions& options) : m_impl(std::make_unique<Impl>(options)) {
  try {
    const auto port = static_cast<unsigned short>(options.port);
    m_impl->v4 = listener(m_impl->context, {asio::ip::address_v4::loopback(), port});
  } catch (const boost::system::system_error& error) {
    throw SystemError("port " + std::to_string(options.port) +
                      ": cannot listen on 127.0.0.1: " + error.code().message());
  }
  try {
    m_impl->v6 = listener(m_impl->context,
                          {asio::ip::address_v6::loopback(), static_cast<unsigned short>(port())});
  } catch (const boost::system::system_error&) {
    m_impl->v6.reset();  // a system without it, or another program's port there
  }
  m_impl->gatekeeper.emplace(port(), options.token);
}

Server::~Server() = default;

int Server::port() const {
  return m_impl->v4->local_endpoint().port();
}

void Server::Impl::accept(Tcp::acceptor& acceptor) {
  acceptor.async_accept([this, &acceptor](Error_code error, Tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) admit(std::move(socket));
    accept(acceptor);
  });
}

/// Where too many wait the one that came first has waited longest for nothing.
void Server::Impl::admit(Tcp::socket&& socket) {
  visitors.remove_if([](const std::weak_ptr<Visitor>& visitor) { return visitor.expired(); });
  while (visitors.size() >= kMostPending) {
    if (const auto oldest = visitors.front().lock()) oldest->close();
    visitors.pop_front();
  }
  Error_code ignored;
  socket.set_option(Tcp::no_delay(true), ignored);
  const auto visitor = std::make_shared<Visitor>(std::move(socket), *served);
  visitors.push_back(visitor);
  visitor->read();
}

void Server::Impl::look() {
  const int so_far = served->viewer.pages_so_far();
  if (served->viewer.page_count() > 0 || so_far != pages_seen) last_page = SteadyClock::now();
  pages_seen = so_far;
  const std::chrono::duration<double> alone = SteadyClock::now() - last_page;
  const bool is_left = so_far > 0 && options.grace_s > 0 && alone.count() > options.grace_s;
  if (stops() || served->viewer.has_ended() || is_left) {
    served->viewer.end("the server was stopped");
    // What is queued goes out; then every connection ends.
    timer.expires_after(kLookEvery);
    timer.async_wait([this](Error_code) { context.stop(); });
    return;
  }
  timer.expires_after(kLookEvery);
  timer.async_wait([this](Error_code error) {
    if (!error) look();
  });
}

void Server::run(Viewer& viewer, const std::function<bool()>& stops) {
  Impl& impl = *m_impl;
  impl.served.emplace(Served{viewer, *impl.gatekeeper, impl.options.page_folder});
  impl.stops = stops;
  impl.accept(*impl.v4);
  if (impl.v6) impl.accept(*impl.v6);
  impl.look();
  impl.context.run();
}

}  // namespace supple::tools
