#include "tools/console/people_text.h"

#include <cstdio>

#include <nlohmann/json.hpp>

namespace supple::tools {

std::string people_text(const nlohmann::ordered_json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value.get<double>());
    return text;
  }
  if (!value.is_array()) return value.dump();
  std::string list;
  for (const auto& part : value) list += (list.empty() ? "" : ", ") + people_text(part);
  return "[" + list + "]";
}

}  // namespace supple::tools
