// Comma-separated values as RFC 4180 has them: a field is quoted where it has to be, quotes within
// are doubled.
#pragma once

#include <string>
#include <vector>

namespace supple {

/// A field as it stands in a line.
std::string csv_field(const std::string& text);

/// The line of these fields, with its end.
std::string csv_line(const std::vector<std::string>& fields);

/// Reads the fields of the line at `at`, which goes to the next one. A field in quotes may have
/// ends of lines; a carriage return before one outside of quotes is left out.
std::vector<std::string> take_csv_line(const std::string& text, std::size_t& at);

}  // namespace supple
