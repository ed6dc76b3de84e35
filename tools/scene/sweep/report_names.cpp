#include "tools/scene/sweep/report_names.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "volumes/base/text.h"

namespace supple::tools {

namespace {

struct Unit {
  std::string_view suffix, text;
};

/// Units that keys of reports and scenes end on; of two that fit the longer comes first.
constexpr std::array<Unit, 27> kUnits = {
    {{"_kpa", "kPa"},     {"_mmhg", "mmHg"},     {"_ml", "ml"},       {"_mm2", "mm²"},
     {"_mm3", "mm³"},     {"_nmm", "N mm"},      {"_mm", "mm"},       {"_mn", "mN"},
     {"_n", "N"},         {"_mj", "mJ"},         {"_uj", "µJ"},       {"_j", "J"},
     {"_ms", "ms"},       {"_s", "s"},           {"_hz", "Hz"},       {"_kg", "kg"},
     {"_mb", "MB"},       {"_deg", "°"},         {"_degrees", "°"},   {"degrees", "°"},
     {"_percent", "%"},   {"_voxels", "voxels"}, {"spacing", "mm"},   {"radius", "mm"},
     {"thickness", "mm"}, {"depth", "mm"},       {"stiffness", "kPa"}}};

bool is_vector(const Value& list, const std::string& name) {
  if (list.size() != 3) return false;
  for (const Value& item : list.items()) {
    if (!item.is_number()) return false;
  }
  return ends_with(name, "_n") || ends_with(name, "_nmm") || ends_with(name, "_mm");
}

double length_of(const Value& vector) {
  return std::hypot(vector[0].number(), vector[1].number(), vector[2].number());
}

void add_values(const Value& value, const std::string& name, NamedValues& all) {
  for (const auto& [key, entry] : value.entries()) {
    add_values(entry, name.empty() ? key : name + "." + key, all);
  }
  if (is_vector(value, name)) all.emplace_back(name, length_of(value));
  for (std::size_t n = 0; n < value.items().size(); ++n) {
    add_values(value[n], name + "[" + std::to_string(n) + "]", all);
  }
  const bool is_whole = value.is_list() || value.is_table() || value.is_null();
  if (!is_whole) all.emplace_back(name, value);
}

std::string last_part(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  return dot == std::string::npos ? name : name.substr(dot + 1);
}

}  // namespace

NamedValues named_values(const Value& report) {
  NamedValues all;
  add_values(report, "", all);
  return all;
}

bool is_main_result(const std::string& name) {
  if (name.rfind("steps[", 0) != 0 || name.find(".settings.") != std::string::npos) return false;
  const std::string last = last_part(name);
  // The largest force is what residuals are measured by; a bulk modulus was given.
  if (last == "largest_force_n" || last == "bulk_modulus_kpa") return false;
  for (const char* unit : {"_n", "_ml", "_kpa", "_mmhg"}) {
    if (ends_with(last, unit)) return true;
  }
  return last == "smallest_det_f" || last == "fraction";
}

const std::pair<std::string, Value>* find_named(const NamedValues& values,
                                                const std::string& name) {
  const std::pair<std::string, Value>* found = nullptr;
  int count = 0;
  for (const auto& named : values) {
    if (named.first == name) return &named;
    if (!ends_with(named.first, "." + name)) continue;
    found = &named;
    ++count;
  }
  return count == 1 ? found : nullptr;
}

std::string words_of(const std::string& name) {
  std::string words = last_part(name), unit;
  for (const Unit& one : kUnits) {
    if (!ends_with(words, std::string(one.suffix))) continue;
    unit = one.text;
    if (one.suffix.front() == '_') words.erase(words.size() - one.suffix.size());
    break;
  }
  std::replace(words.begin(), words.end(), '_', ' ');
  return unit.empty() ? words : words + " (" + unit + ")";
}

}  // namespace supple::tools
