#include "tools/viewer/gatekeeper.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <fstream>

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "volumes/base/error.h"

namespace supple::tools {

namespace {

constexpr std::size_t kTokenBytes = 16;
constexpr std::array<const char*, 3> kLoopback = {"localhost", "127.0.0.1", "[::1]"};
constexpr std::size_t kLongestShown = 100;

bool is_token(const std::string& text) {
  return text.size() == 2 * kTokenBytes &&
         text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// Compares in the same time however much of it is right.
bool is_same(std::string_view given, const std::string& own) {
  if (given.size() != own.size()) return false;
  unsigned differs = 0;
  for (std::size_t i = 0; i < own.size(); ++i) differs |= unsigned(given[i] ^ own[i]);
  return differs == 0;
}

std::string host_of(const std::string& origin) {
  return origin.substr(origin.find("://") + 3);
}

/// Words of a request for a message to people: short plain ones as they are.
std::string shown(const std::string& text) {
  const bool is_plain =
      std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < 127; });
  if (text.empty()) return "none";
  return is_plain && text.size() <= kLongestShown ? text : "something else";
}

}  // namespace

Gatekeeper::Gatekeeper(int port, std::string token, std::vector<std::string> origins,
                       const std::string& listen, std::vector<std::string> embedders)
    : m_origins(std::move(origins)),
      m_embedders(std::move(embedders)),
      m_token(std::move(token)),
      m_protocol("supple." + m_token) {
  for (const std::string& origin : m_origins) m_hosts.push_back(host_of(origin));
  const auto add = [&](const std::string& name) {
    m_hosts.push_back(name + ":" + std::to_string(port));
    m_origins.push_back("http://" + m_hosts.back());
  };
  for (const char* name : kLoopback) add(name);
  if (!listen.empty()) add(listen.find(':') == std::string::npos ? listen : "[" + listen + "]");
}

bool Gatekeeper::is_own_host(std::string_view host) const {
  return std::find(m_hosts.begin(), m_hosts.end(), host) != m_hosts.end();
}

bool Gatekeeper::is_own_origin(std::string_view origin) const {
  return origin.empty() || std::find(m_origins.begin(), m_origins.end(), origin) != m_origins.end();
}

bool Gatekeeper::may_embed(std::string_view origin) const {
  return std::find(m_embedders.begin(), m_embedders.end(), origin) != m_embedders.end();
}

std::string Gatekeeper::refusal(const std::string& host, const std::string& origin) const {
  std::string expected;
  for (const std::string& own : m_hosts) expected += (expected.empty() ? "" : ", ") + own;
  const std::string came_from = origin.empty() || origin == "null" ? "http://" + host : origin;
  std::string text =
      "supple view does not answer under this address.\n\nhost found:    " + shown(host) + "\n" +
      (is_own_origin(origin) ? "" : "origin found:  " + shown(origin) + "\n") +
      "host expected: " + expected +
      "\n\nOther pages in your browser cannot use the program this way. If you came "
      "through a forwarded port\nor a proxy that you trust, start it with\n\n  "
      "supple view --origin ";
  text += shown(came_from) == came_from ? came_from : "ORIGIN";
  return text +
         "\n\nand with --base-path PATH where the proxy shows it below a path "
         "(docs/viewer.md, \"From another machine\").\n";
}

std::string plain_origin(const std::string& text, const std::string& option) {
  const auto fail = [&]() {
    throw InputError({"", option, "'" + text + "'",
                      "what the address in the browser begins with, such as https://hub.example or "
                      "http://localhost:9000"});
  };
  std::string origin = text;
  if (!origin.empty() && origin.back() == '/') origin.pop_back();
  const std::size_t scheme = origin.find("://");
  if (scheme == std::string::npos) fail();
  const std::string name = origin.substr(0, scheme), host = host_of(origin);
  const bool is_known = name == "http" || name == "https";
  const bool is_host = !host.empty() && host.find_first_not_of(
                                            "abcdefghijklmnopqrstuvwxyz0123456789"
                                            "-._:[]") == std::string::npos;
  if (!is_known || !is_host) fail();
  const std::string own_port = name == "http" ? ":80" : ":443";
  const bool has_own_port =
      origin.size() > own_port.size() &&
      origin.compare(origin.size() - own_port.size(), own_port.size(), own_port) == 0;
  return has_own_port ? origin.substr(0, origin.size() - own_port.size()) : origin;
}

std::string plain_base_path(const std::string& text) {
  const bool is_plain = !text.empty() && text.front() == '/' &&
                        text.find("//") == std::string::npos &&
                        std::all_of(text.begin(), text.end(), [](char c) {
                          return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                                 std::string_view("/-._~@").find(c) != std::string_view::npos;
                        });
  if (!is_plain) {
    throw InputError({"", "--base-path", "'" + text + "'", "a path such as /user/me/proxy/8080/"});
  }
  return text.back() == '/' ? text : text + "/";
}

bool Gatekeeper::is_authorized(std::string_view header) const {
  return is_same(header, "Bearer " + m_token);
}

bool Gatekeeper::has_token(std::string_view protocols) const {
  bool found = false;
  while (!protocols.empty()) {
    const std::size_t comma = std::min(protocols.find(','), protocols.size());
    const std::string_view one = trimmed(protocols.substr(0, comma));
    protocols.remove_prefix(std::min(comma + 1, protocols.size()));
    found = is_same(one, m_protocol) || found;
  }
  return found;
}

std::string make_token() {
  std::array<unsigned char, kTokenBytes> bytes;
  if (::getrandom(bytes.data(), bytes.size(), 0) != ssize_t(bytes.size())) {
    throw SystemError("token: the system gives no random numbers");
  }
  std::string token;
  for (const unsigned char byte : bytes) {
    token += "0123456789abcdef"[byte >> 4];
    token += "0123456789abcdef"[byte & 15];
  }
  return token;
}

std::string token_of_file(const std::string& path) {
  const int made = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (made >= 0) {
    const std::string token = make_token();
    const bool is_written = ::write(made, token.data(), token.size()) == ssize_t(token.size());
    if (::close(made) != 0 || !is_written) throw SystemError(path + ": cannot write");
    return token;
  }
  if (errno != EEXIST) throw_open_error(path, errno);
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) throw_open_error(path, errno);
  if ((status.st_mode & 077) != 0) {
    throw InputError({path, "token", "a file that others may read", "chmod 600"});
  }
  std::ifstream file(path);
  std::string token;
  file >> token;
  if (!is_token(token))
    throw InputError({path, "token", "something else", "32 hexadecimal digits"});
  return token;
}

}  // namespace supple::tools
