#include "tools/viewer/page_socket.h"

#include <deque>
#include <variant>

#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include "tools/viewer/page_message.h"

namespace supple::tools {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using namespace std::chrono_literals;

constexpr auto kHandshakeTime = 10s;
constexpr auto kIdleTime = 60s;
constexpr double kMessagesPerSecond = 400, kBurst = 800;  // that a page may send
constexpr std::size_t kMostQueuedBytes = std::size_t(64) << 20;

/// Limits messages by tokens that come back with time.
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

/// A page's socket. Everything runs on the thread of the server, but for send_…(), which hand over.
class PageSocket final : public PageOutlet, public std::enable_shared_from_this<PageSocket> {
 public:
  PageSocket(Tcp::socket&& socket, const ServedSession& served)
      : m_socket(std::move(socket)), m_served(served) {}

  void accept(http::request<http::empty_body> request) {
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = kHandshakeTime;
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
    m_page = m_served.session.join(shared_from_this());
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
      m_served.session.receive(m_page, text);
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

  /// Closes a page that does not read what it is sent.
  void abandon() {
    end();
    beast::get_lowest_layer(m_socket).close();
  }

  void end() {
    m_is_closing = true;
    leave();
  }
  void leave() {
    if (m_page != 0) m_served.session.leave(std::exchange(m_page, 0));
  }

  websocket::stream<beast::tcp_stream> m_socket;
  const ServedSession& m_served;
  http::request<http::empty_body> m_request;
  beast::flat_buffer m_incoming{kMostMessageBytes};
  MessageRate m_rate;
  int m_page = 0;
  std::deque<std::variant<Text, Picture>> m_outgoing;
  std::size_t m_queued_bytes = 0;
  bool m_is_closing = false;
  websocket::close_reason m_reason;
};

}  // namespace

void open_page_socket(Tcp::socket&& socket, const ServedSession& served,
                      http::request<http::empty_body> request) {
  const auto page = std::make_shared<PageSocket>(std::move(socket), served);
  page->accept(std::move(request));
}

}  // namespace supple::tools
