#include "tools/viewer/server.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <list>
#include <optional>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

#include "tools/viewer/file_upload.h"
#include "tools/viewer/page_socket.h"
#include "volumes/base/error.h"

namespace supple::tools {

namespace {

std::string type_of_file(const std::string& name) {
  const std::string extension = std::filesystem::path(name).extension().string();
  if (extension == ".html") return "text/html; charset=utf-8";
  if (extension == ".js" || extension == ".mjs") return "text/javascript; charset=utf-8";
  if (extension == ".css") return "text/css; charset=utf-8";
  if (extension == ".svg") return "image/svg+xml";
  if (extension == ".png") return "image/png";
  if (extension == ".json") return "application/json";
  return "application/octet-stream";
}

/// Folders and files of letters, digits, "-", "_" and single dots that do not begin a name.
bool is_plain_path(const std::string& path) {
  bool begins = true;
  for (const char c : path) {
    const bool is_letter = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_';
    if (!is_letter && (begins || (c != '.' && c != '/'))) return false;
    begins = c == '/' || c == '.';
  }
  return !path.empty() && !begins;
}

}  // namespace

std::optional<PageFile> page_file(const std::string& target, const std::string& folder,
                                  const std::string& first) {
  std::string path = target.substr(0, target.find('?'));
  if (path == "/") path += first;
  if (path.empty() || path.front() != '/') return std::nullopt;
  path.erase(0, 1);
  if (!is_plain_path(path)) return std::nullopt;
  if (!folder.empty()) {
    std::ifstream file(folder + "/" + path, std::ios::binary);
    if (!file || !std::filesystem::is_regular_file(folder + "/" + path)) return std::nullopt;
    return PageFile{type_of_file(path), {std::istreambuf_iterator<char>(file), {}}};
  }
  const auto found = std::find_if(kEmbeddedPage.begin(), kEmbeddedPage.end(),
                                  [&](const EmbeddedFile& file) { return path == file.path; });
  if (found == kEmbeddedPage.end()) return std::nullopt;
  return PageFile{type_of_file(path), {reinterpret_cast<const char*>(found->data), found->size}};
}

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using namespace std::chrono_literals;

constexpr auto kRequestTime = 10s;
constexpr auto kLookEvery = 50ms;
constexpr const char* kDrop = "/drop/";  // before the address of a file that a page uploads
constexpr const char* kModule = "/supple-view.js";
constexpr std::uint32_t kMostHeaderBytes = 8192, kMostPending = 64;  // connections without a socket
constexpr unsigned short kFirstPort = 21177, kLastPort = 21184;

/// A connection that asks for files of the page, until it opens a socket.
class Visitor final : public std::enable_shared_from_this<Visitor> {
 public:
  Visitor(Tcp::socket&& socket, const ServedSession& served)
      : m_stream(std::move(socket)), m_served(served) {}

  void read() {
    m_parser.emplace();
    m_parser->header_limit(kMostHeaderBytes);
    m_parser->body_limit(UINT64_MAX);  // bodies are not read, but files from who has the token
    m_stream.expires_after(kRequestTime);
    http::async_read_header(
        m_stream, m_buffer, *m_parser, [self = shared_from_this()](Error_code error, std::size_t) {
          if (error == http::error::end_of_stream) return self->close();
          if (!error) return self->respond();
          if (error.category() == http::make_error_code(http::error::bad_method).category()) {
            self->send(http::status::bad_request, "text/plain", "bad request\n", false);
          }
        });
  }

  /// True while it brings a file that was asked for.
  bool is_trusted() const { return m_is_trusted; }
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
        !is_own(http::field::origin, [&](const std::string& origin) {
          return gatekeeper.is_own_origin(origin) || is_module_for(origin);
        })) {
      return send(http::status::forbidden, "text/plain",
                  gatekeeper.refusal(std::string(request[http::field::host]),
                                     std::string(request[http::field::origin])),
                  false);
    }
    m_location =
        std::string(request.target()) + "/" == m_served.base_path ? m_served.base_path : "";
    if (!m_location.empty()) return send(http::status::permanent_redirect, "text/plain", "", true);
    const std::string target = below_base(std::string(request.target()));
    const bool is_upload = request.method() == http::verb::post && target.rfind(kDrop, 0) == 0;
    if (is_upload) return upload(target.substr(std::string(kDrop).size()));
    if (!m_parser->is_done())
      return send(http::status::bad_request, "text/plain", "no body\n", false);
    if (target == "/socket") return upgrade();
    const bool is_head = request.method() == http::verb::head;
    if (!is_head && request.method() != http::verb::get) {
      return send(http::status::method_not_allowed, "text/plain", "GET or HEAD\n", false);
    }
    const std::optional<PageFile> file =
        page_file(target, m_served.page_folder, m_served.session.first_file());
    if (!file) return send(http::status::not_found, "text/plain", "no such file\n", true);
    send(http::status::ok, file->type, file->bytes, true);
  }

  /// True for the one file that pages of other origins may read, those that may show this page.
  bool is_module_for(const std::string& origin) const {
    const auto& request = m_parser->get();
    return request.method() == http::verb::get && m_served.gatekeeper.may_embed(origin) &&
           below_base(std::string(request.target())) == kModule;
  }

  /// A proxy may leave the base path before the target or take it away.
  std::string below_base(const std::string& target) const {
    const std::string& base = m_served.base_path;
    return target.rfind(base, 0) == 0 ? target.substr(base.size() - 1) : target;
  }

  /// Takes a file from who has the token, as a page has announced it.
  void upload(const std::string& target) {
    const auto& request = m_parser->get();
    if (request.count(http::field::authorization) != 1 ||
        !m_served.gatekeeper.is_authorized(std::string(request[http::field::authorization]))) {
      return send(http::status::forbidden, "text/plain", "another token\n", false);
    }
    const auto length = m_parser->content_length();
    if (!length) return send(http::status::length_required, "text/plain", "a length\n", false);
    try {
      std::unique_ptr<FileReceiver> receiver = m_served.session.receive_file(target, *length);
      if (m_parser->is_done()) {
        receiver->finish();
        return send(http::status::ok, "text/plain", "", true);
      }
      m_is_trusted = true;
      receive_upload(m_stream, m_buffer, std::move(*m_parser), std::move(receiver),
                     [self = shared_from_this()](http::status status, const std::string& text) {
                       self->m_is_trusted = false;
                       self->m_parser.emplace();
                       self->send(status, "text/plain", text + "\n", status == http::status::ok);
                     });
    } catch (const std::exception& error) {
      send(http::status::conflict, "text/plain", error.what() + std::string("\n"), false);
    }
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
    open_page_socket(m_stream.release_socket(), m_served, std::move(request));
  }

  void send(http::status status, const std::string& type, std::string bytes, bool stays) {
    const auto& request = m_parser->get();
    m_response = {};
    m_response.result(status);
    m_response.version(11);
    m_response.set(http::field::content_type, type);
    m_response.set(http::field::cache_control, "no-store");
    if (!m_location.empty()) m_response.set(http::field::location, m_location);
    set_policies();
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

  /// Admits nothing from elsewhere, and of pages around this one those that were named.
  void set_policies() {
    std::string embedders;
    for (const std::string& origin : m_served.gatekeeper.embedders()) embedders += " " + origin;
    const std::string policy =
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
        "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors";
    m_response.set("Content-Security-Policy", policy + (embedders.empty() ? " 'none'" : embedders));
    if (embedders.empty()) m_response.set("X-Frame-Options", "DENY");
    m_response.set("X-Content-Type-Options", "nosniff");
    m_response.set("Referrer-Policy", "no-referrer");
    m_response.set("Cross-Origin-Opener-Policy", "same-origin");
    const std::string origin(m_parser->get()[http::field::origin]);
    const bool is_shared = is_module_for(origin);
    m_response.set("Cross-Origin-Resource-Policy", is_shared ? "cross-origin" : "same-origin");
    if (!is_shared) return;
    m_response.set("Access-Control-Allow-Origin", origin);
    m_response.set("Vary", "Origin");
  }

  beast::tcp_stream m_stream;
  const ServedSession& m_served;
  bool m_is_trusted = false;
  std::string m_location;  // beside a redirection: the page's relative addresses need its "/"
  beast::flat_buffer m_buffer{kMostHeaderBytes};
  std::optional<http::request_parser<http::empty_body>> m_parser;
  http::response<http::string_body> m_response;
  std::optional<http::response_serializer<http::string_body>> m_serializer;
};

asio::ip::address address_to_listen_on(const std::string& text) {
  if (text.empty()) return asio::ip::address_v4::loopback();
  Error_code error;
  const asio::ip::address address = asio::ip::make_address(text, error);
  if (!error) return address;
  throw InputError({"", "--listen", "'" + text + "'",
                    "an address of this machine, such as 0.0.0.0 for all of them"});
}

Tcp::acceptor listener(asio::io_context& context, const Tcp::endpoint& endpoint) {
  Tcp::acceptor acceptor(context);
  acceptor.open(endpoint.protocol());
  acceptor.set_option(asio::socket_base::reuse_address(true));
  if (endpoint.protocol() == Tcp::v6()) acceptor.set_option(asio::ip::v6_only(true));
  acceptor.bind(endpoint);
  acceptor.listen();
  return acceptor;
}

/// Port 0 takes a usual one while it is free: browsers keep what they remember by the port.
Tcp::acceptor first_listener(asio::io_context& context, const asio::ip::address& address,
                             int port) {
  for (unsigned short usual = kFirstPort; port == 0 && usual <= kLastPort; ++usual) {
    try {
      return listener(context, {address, usual});
    } catch (const boost::system::system_error&) {  // another program has it
    }
  }
  return listener(context, {address, static_cast<unsigned short>(port)});
}

}  // namespace

struct Server::Impl {
  explicit Impl(const ServerOptions& given) : options(given), timer(context) {}

  void accept(Tcp::acceptor& acceptor);
  void admit(Tcp::socket&& socket);
  void look();

  const ServerOptions options;
  asio::io_context context{1};
  std::optional<Tcp::acceptor> first, v6;
  asio::steady_timer timer;
  std::optional<Gatekeeper> gatekeeper;
  std::optional<ServedSession> served;
  std::list<std::weak_ptr<Visitor>> visitors;  // oldest first
  std::function<bool()> stops;
  int pages_seen = 0;
  SteadyClock::time_point last_page = SteadyClock::now();
};

Server::Server(const ServerOptions& options) : m_impl(std::make_unique<Impl>(options)) {
  const asio::ip::address address = address_to_listen_on(options.listen);
  try {
    m_impl->first = first_listener(m_impl->context, address, options.port);
  } catch (const boost::system::system_error& error) {
    throw SystemError("port " + std::to_string(options.port) + ": cannot listen on " +
                      address.to_string() + ": " + error.code().message());
  }
  const bool is_named = !options.listen.empty() && !address.is_unspecified();
  m_impl->gatekeeper.emplace(port(), options.token, options.origins,
                             is_named ? address.to_string() : "", options.embedders);
  if (!options.listen.empty()) return;
  try {
    m_impl->v6 = listener(m_impl->context,
                          {asio::ip::address_v6::loopback(), static_cast<unsigned short>(port())});
  } catch (const boost::system::system_error&) {
    m_impl->v6.reset();  // a system without it, or another program's port there
  }
}

Server::~Server() = default;

int Server::port() const {
  return m_impl->first->local_endpoint().port();
}

std::string Server::address() const {
  const ServerOptions& options = m_impl->options;
  const asio::ip::address own = m_impl->first->local_endpoint().address();
  std::string host = own.is_unspecified() ? "127.0.0.1" : own.to_string();
  if (host.find(':') != std::string::npos) host = "[" + host + "]";
  const std::string own_origin = "http://" + host + ":" + std::to_string(port());
  const std::string& origin = options.origins.empty() ? own_origin : options.origins.front();
  return origin + options.base_path + "#" + options.token;
}

void Server::Impl::accept(Tcp::acceptor& acceptor) {
  acceptor.async_accept([this, &acceptor](Error_code error, Tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) admit(std::move(socket));
    accept(acceptor);
  });
}

/// Adds a visitor. Where too many wait, closes the first ones, which have waited longest.
void Server::Impl::admit(Tcp::socket&& socket) {
  visitors.remove_if([](const std::weak_ptr<Visitor>& visitor) { return visitor.expired(); });
  const auto may_go = [](const std::weak_ptr<Visitor>& visitor) {
    const auto there = visitor.lock();
    return !there || !there->is_trusted();
  };
  while (visitors.size() >= kMostPending) {
    const auto oldest = std::find_if(visitors.begin(), visitors.end(), may_go);
    if (oldest == visitors.end()) break;
    if (const auto there = oldest->lock()) there->close();
    visitors.erase(oldest);
  }
  Error_code ignored;
  socket.set_option(Tcp::no_delay(true), ignored);
  const auto visitor = std::make_shared<Visitor>(std::move(socket), *served);
  visitors.push_back(visitor);
  visitor->read();
}

void Server::Impl::look() {
  const int so_far = served->session.pages_so_far();
  if (served->session.page_count() > 0 || so_far != pages_seen) last_page = SteadyClock::now();
  pages_seen = so_far;
  const std::chrono::duration<double> alone = SteadyClock::now() - last_page;
  const bool is_left = so_far > 0 && options.grace_s > 0 && alone.count() > options.grace_s;
  if (stops() || served->session.has_ended() || is_left) {
    served->session.end("the server was stopped");
    // Messages in the queues go out; then every connection ends.
    timer.expires_after(kLookEvery);
    timer.async_wait([this](Error_code) { context.stop(); });
    return;
  }
  timer.expires_after(kLookEvery);
  timer.async_wait([this](Error_code error) {
    if (!error) look();
  });
}

void Server::run(PageSession& session, const std::function<bool()>& stops) {
  Impl& impl = *m_impl;
  impl.served.emplace(
      ServedSession{session, *impl.gatekeeper, impl.options.page_folder, impl.options.base_path});
  impl.stops = stops;
  impl.accept(*impl.first);
  if (impl.v6) impl.accept(*impl.v6);
  impl.look();
  impl.context.run();
}

}  // namespace supple::tools
