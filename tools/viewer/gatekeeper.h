// Who may speak to the server: requests that name this host, from the page that it serves, with its
// token. A page from elsewhere cannot read the token, whatever name of its own it lets point at
// this machine (DNS rebinding), nor open the socket without it.
#pragma once

#include <string>
#include <string_view>

namespace supple::tools {

class Gatekeeper {
 public:
  /// `token`: as make_token() gives it.
  Gatekeeper(int port, std::string token);

  /// localhost, 127.0.0.1 or [::1] with the port.
  bool is_own_host(std::string_view host) const;
  /// No Origin, as programs have none, or that of the page.
  bool is_own_origin(std::string_view origin) const;
  /// Of the header Sec-WebSocket-Protocol: names the protocol with the token. Takes as long
  /// whatever of it is right.
  bool has_token(std::string_view protocols) const;
  /// That protocol, to be answered.
  const std::string& protocol() const { return m_protocol; }
  const std::string& token() const { return m_token; }

 private:
  std::string m_port, m_token, m_protocol;
};

/// 128 random bits of the system, as 32 hexadecimal digits. Throws SystemError.
std::string make_token();
/// That of a file, which nobody else may read, or a new one, which is written there. Throws
/// InputError, SystemError.
std::string token_of_file(const std::string& path);

}  // namespace supple::tools
