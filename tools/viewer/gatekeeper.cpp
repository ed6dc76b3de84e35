#include "tools/viewer/gatekeeper.h"

#include <algorithm>
#include <array>
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
constexpr std::array<std::string_view, 3> kHosts = {"localhost", "127.0.0.1", "[::1]"};

bool is_token(const std::string& text) {
  return text.size() == 2 * kTokenBytes &&
         text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

}  // namespace

Gatekeeper::Gatekeeper(int port, std::string token)
    : m_port(std::to_string(port)), m_token(std::move(token)), m_protocol("supple." + m_token) {}

bool Gatekeeper::is_own_host(std::string_view host) const {
  return std::any_of(kHosts.begin(), kHosts.end(), [&](std::string_view name) {
    return host == std::string(name) + ":" + m_port;
  });
}

bool Gatekeeper::is_own_origin(std::string_view origin) const {
  constexpr std::string_view kScheme = "http://";
  if (origin.empty()) return true;
  if (origin.substr(0, kScheme.size()) != kScheme) return false;
  return is_own_host(origin.substr(kScheme.size()));
}

bool Gatekeeper::has_token(std::string_view protocols) const {
  bool found = false;
  while (!protocols.empty()) {
    const std::size_t comma = std::min(protocols.find(','), protocols.size());
    const std::string_view one = trimmed(protocols.substr(0, comma));
    protocols.remove_prefix(std::min(comma + 1, protocols.size()));
    if (one.size() != m_protocol.size()) continue;
    unsigned differs = 0;
    for (std::size_t i = 0; i < one.size(); ++i) differs |= unsigned(one[i] ^ m_protocol[i]);
    found = found || differs == 0;
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
