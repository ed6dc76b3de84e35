#include "lib/material/toml_string.h"

#include <algorithm>
#include <cctype>
#include <cstddef>

#include "volumes/base/json.h"

namespace supple {

namespace {

constexpr unsigned char kPrivate[] = {0xEF, 0x9C};  // the first bytes of U+F700 to U+F7FF
constexpr unsigned char kPrivateEnd = 0x9F;

bool is_private(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(text[at + n]); };
  return at + 2 < text.size() && byte(0) == kPrivate[0] && byte(1) >= kPrivate[1] &&
         byte(1) <= kPrivateEnd;
}

/// Length of the well-formed UTF-8 character, 0 where there is none.
std::size_t character_at(const std::string& text, std::size_t at) {
  const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(text[at + n]); };
  if (byte(0) < 0x80) return byte(0) >= 0x20 && byte(0) != 0x7F ? 1 : 0;
  const std::size_t length = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || at + length > text.size() || is_private(text, at))
    return 0;
  for (std::size_t n = 1; n < length; ++n) {
    if ((byte(n) & 0xC0) != 0x80) return 0;
  }
  // Refuse forms longer than need be, surrogates, and code points beyond the last plane.
  if (byte(0) == 0xE0 && byte(1) < 0xA0) return 0;
  if (byte(0) == 0xED && byte(1) > 0x9F) return 0;
  if (byte(0) == 0xF0 && byte(1) < 0x90) return 0;
  if (byte(0) == 0xF4 && byte(1) > 0x8F) return 0;
  return length;
}

}  // namespace

std::string toml_string(const std::string& bytes) {
  std::string text;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t length = character_at(bytes, at);
    if (length > 0) {
      text.append(bytes, at, length);
    } else {
      const unsigned byte = static_cast<unsigned char>(bytes[at]);
      text += {char(kPrivate[0]), char(kPrivate[1] + (byte >> 6)), char(0x80 | (byte & 0x3F))};
    }
    at += std::max<std::size_t>(length, 1);
  }
  return json_string(text);
}

std::string toml_key(const std::string& bytes) {
  const auto is_bare = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  const bool all = !bytes.empty() && std::all_of(bytes.begin(), bytes.end(), is_bare);
  return all ? bytes : toml_string(bytes);
}

std::string bytes_of_toml_string(const std::string& text) {
  std::string bytes;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (!is_private(text, at)) {
      bytes += text[at];
      continue;
    }
    const unsigned high = static_cast<unsigned char>(text[at + 1]) - unsigned(kPrivate[1]);
    bytes += char(high << 6 | (static_cast<unsigned char>(text[at + 2]) & 0x3F));
    at += 2;
  }
  return bytes;
}

}  // namespace supple
