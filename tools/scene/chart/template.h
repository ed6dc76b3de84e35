// Templates of HTML and SVG, filled from a tree of values: the tags of Mustache that the page
// needs.
//
// {{name}} is escaped, {{&name}} is not. {{#name}} ... {{/name}} stands once for each item of a
// list, once for any other value that is not null, false or empty; {{^name}} ... {{/name}} stands
// where {{#name}} would not. A name is looked for in the innermost table first; {{.}} is the item
// itself. A tag of a section alone on its line leaves no line.
#pragma once

#include <string>
#include <string_view>

#include "volumes/base/value.h"

namespace supple::tools {

/// Throws std::out_of_range for a name of {{name}} that no table has.
std::string filled(std::string_view text, const Value& values);

/// Text for HTML and XML: & < > " ' as entities, control characters but for ends of lines as ?.
std::string html_text(const std::string& text);

}  // namespace supple::tools
