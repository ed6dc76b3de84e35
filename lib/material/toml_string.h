// Any bytes as strings of TOML. TOML holds UTF-8 without control characters, and names of files may
// be any bytes: each byte that TOML refuses becomes a code point of a private area, U+F700 + byte.
#pragma once

#include <string>

namespace supple {

/// The bytes as a string of TOML, with its quotation marks.
std::string toml_string(const std::string& bytes);

/// The bytes as a key, with quotation marks where it is no bare one.
std::string toml_key(const std::string& bytes);

/// The bytes behind the value of such a string.
std::string bytes_of_toml_string(const std::string& text);

}  // namespace supple
