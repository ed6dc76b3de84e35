// TOML in, TOML out: the text of scenes, materials, cameras, journals of live sessions and tables
// on the command line. Inside the program such text is a Value.
#pragma once

#include <string>

#include "volumes/base/value.h"

namespace supple {

/// The root of a text, with the keys of every table in ascending order; `source` names it in
/// errors. Throws InputError for a syntax error, with its line.
Value parse_toml(const std::string& text, const std::string& source);
/// The root of a file. Throws InputError likewise, and for a missing or empty file.
Value read_toml(const std::string& path);

/// The tables of a root, one after the other, each with a key per line. Throws InputError for text
/// that is not UTF-8.
std::string toml_document(const Value& root);

/// A value as messages show it: shortest numbers, in one line that is not too long.
std::string shown_text(const Value& value);

}  // namespace supple
