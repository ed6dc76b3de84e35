// Who may speak to the server: requests that name this host, from the page that it serves, with its
// token. A page from elsewhere cannot read the token, whatever name of its own it lets point at
// this machine (DNS rebinding), nor open the socket without it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace supple::tools {

class Gatekeeper {
 public:
  /// `token`: as make_token() gives it. `origins`: others under which a proxy or a forwarded port
  /// shows the page, as plain_origin() gives them. `listen`: an address beside those of the
  /// loopback; empty: none. `embedders`: origins whose pages may show this one in theirs.
  Gatekeeper(int port, std::string token, std::vector<std::string> origins = {},
             const std::string& listen = "", std::vector<std::string> embedders = {});

  /// True for localhost, 127.0.0.1 or [::1] with the port, or the host of another origin.
  bool is_own_host(std::string_view host) const;
  /// True for no Origin, as programs have none, or that of the page.
  bool is_own_origin(std::string_view origin) const;
  /// True for an origin whose pages may show this one, and read the module that does so.
  bool may_embed(std::string_view origin) const;
  const std::vector<std::string>& embedders() const { return m_embedders; }
  /// Text for a request with another host or origin: found, expected, and the option that helps.
  std::string refusal(const std::string& host, const std::string& origin) const;
  /// True if the header Sec-WebSocket-Protocol names the protocol with the token. Takes the same
  /// time however much of it is right.
  bool has_token(std::string_view protocols) const;
  /// True if a header Authorization has the token; likewise.
  bool is_authorized(std::string_view header) const;
  /// The protocol with the token, for the answer.
  const std::string& protocol() const { return m_protocol; }
  const std::string& token() const { return m_token; }

 private:
  std::vector<std::string> m_hosts, m_origins, m_embedders;
  std::string m_token, m_protocol;
};

/// An origin as browsers send it: "https://hub.example", "http://localhost:9000"; without a port
/// that is the scheme's own. Throws InputError, which names the option.
std::string plain_origin(const std::string& text, const std::string& option = "--origin");
/// A path that begins and ends with "/". Throws InputError.
std::string plain_base_path(const std::string& text);

/// 128 random bits of the system, as 32 hexadecimal digits. Throws SystemError.
std::string make_token();
/// The token in a file that nobody else may read, or a new one, which is written there. Throws
/// InputError, SystemError.
std::string token_of_file(const std::string& path);

}  // namespace supple::tools
