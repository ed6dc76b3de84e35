// JSON in, JSON out: the text of states, records, reports, sockets and foreign programs. Inside the
// program such text is a Value.
#pragma once

#include <string>
#include <string_view>

#include "volumes/base/error.h"
#include "volumes/base/value.h"

namespace supple {

/// Lists and tables within each other that a text may have at most.
constexpr int kDeepestJson = 500;

/// The text is no JSON, or has lists within lists.
class JsonError : public Error {
 public:
  JsonError(const std::string& why, bool too_deep) : Error(why), is_too_deep(too_deep) {}
  const bool is_too_deep;
};

/// Throws JsonError.
Value parse_json(std::string_view text, int deepest = kDeepestJson);
/// Parses text; null for text that is no JSON.
Value json_or_null(std::string_view text);

/// Writes one line; indents by this many spaces where that is above 0. Bytes that are not UTF-8
/// become U+FFFD.
std::string json_text(const Value& value, int indent = 0);

/// Text as a string of JSON, and of TOML.
std::string json_string(const std::string& text);

}  // namespace supple
