#include "tools/console/people_text.h"

#include <cstdio>

#include "volumes/base/json.h"

namespace supple::tools {

std::string people_text(const Value& value) {
  if (value.is_text()) return value.text();
  if (value.is_number() && !value.is_whole()) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value.number());
    return text;
  }
  if (!value.is_list()) return json_text(value);
  std::string list;
  for (const Value& part : value.items()) list += (list.empty() ? "" : ", ") + people_text(part);
  return "[" + list + "]";
}

}  // namespace supple::tools
