#include "raycast/scene/transfer_file.h"

#include <filesystem>

#include "raycast/pictures/background.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

/// A part of a function that is read and written as one number.
struct Scalar {
  const char* key;
  double TransferFunction::*value;
  const char* comment;
};
constexpr Scalar kScalars[] = {
    {"unit_distance", &TransferFunction::unit_distance_mm, "mm over which an opacity is reached"},
    {"full_shading_gradient", &TransferFunction::full_shading_gradient,
     "density per mm from which a gradient is a surface"},
    {"ambient", &TransferFunction::ambient, "shares of the light, 0 to 1"},
    {"diffuse", &TransferFunction::diffuse, ""},
    {"specular", &TransferFunction::specular, ""},
    {"specular_power", &TransferFunction::specular_power, ""}};

std::vector<OpacityKey> read_opacities(Table& table, const std::string& key) {
  std::vector<OpacityKey> keys;
  const auto rows = table.rows(key, {2}, "a list of [density, opacity] pairs");
  if (!rows) return keys;
  for (const auto& row : *rows) keys.push_back({row[0], row[1]});
  return keys;
}

std::vector<ColourKey> read_colours(Table& table) {
  std::vector<ColourKey> keys;
  const auto rows = table.rows("colour", {4}, "a list of [density, red, green, blue]");
  for (const auto& row : table.require(rows, "colour", "a list of [density, red, green, blue]")) {
    keys.push_back({row[0], {row[1], row[2], row[3]}});
  }
  return keys;
}

Blend read_blend(Table& table) {
  const std::string name = table.get<std::string>("blend").value_or("composite");
  if (name == "composite") return Blend::composite;
  if (name == "maximum") return Blend::maximum;
  table.fail("blend", "\"" + name + "\"", "\"composite\" or \"maximum\"");
}

void check_background(const Table& table, const std::string& background) {
  try {
    parse_background(background);
  } catch (const InputError& error) {
    table.fail("background", "\"" + background + "\"", error.problem().expected);
  }
}

std::string to_toml(const std::string& key, const std::vector<OpacityKey>& keys) {
  std::string text = key + " = [";
  for (const OpacityKey& k : keys)
    text += "[" + exact_text(k.density) + ", " + exact_text(k.opacity) + "], ";
  return text.substr(0, text.size() - 2) + "]\n";
}

}  // namespace

TransferFunction read_transfer_function(const std::string& path) {
  Table table = Table::read(path);
  return read_transfer_function(table);
}

TransferFunction read_transfer_function(Table& table) {
  table.know({"name", "blend", "background", "opacity", "colour", "gradient_opacity"});
  TransferFunction function;
  function.name =
      table.get<std::string>("name").value_or(std::filesystem::path(table.file()).stem().string());
  function.blend = read_blend(table);
  function.background = table.get<std::string>("background").value_or("");
  if (!function.background.empty()) check_background(table, function.background);
  function.opacity = read_opacities(table, "opacity");
  if (function.opacity.empty()) {
    table.fail_missing("opacity", "a list of [density, opacity] pairs");
  }
  function.colour = read_colours(table);
  function.gradient_opacity = read_opacities(table, "gradient_opacity");
  for (const Scalar& scalar : kScalars) {
    function.*scalar.value = table.get<double>(scalar.key).value_or(function.*scalar.value);
  }
  table.finish();
  function.validate(table.file());
  return function;
}

std::string to_toml(const TransferFunction& function) {
  std::string text = "name = \"" + function.name + "\"\n";
  if (function.blend == Blend::maximum) text += "blend = \"maximum\"\n";
  if (!function.background.empty()) text += "background = \"" + function.background + "\"\n";
  text += "# [density, opacity]\n" + to_toml("opacity", function.opacity);
  text += "# [density, red, green, blue]\ncolour = [";
  for (const ColourKey& key : function.colour) {
    text += "[" + exact_text(key.density);
    for (const double channel : key.rgb) text += ", " + exact_text(channel);
    text += "], ";
  }
  text.replace(text.size() - 2, 2, "]\n");
  if (!function.gradient_opacity.empty()) {
    text +=
        "# [density per mm, opacity]\n" + to_toml("gradient_opacity", function.gradient_opacity);
  }
  for (const Scalar& scalar : kScalars) {
    text += std::string(scalar.key) + " = " + exact_text(function.*scalar.value);
    text += *scalar.comment == '\0' ? "\n" : std::string("  # ") + scalar.comment + "\n";
  }
  return text;
}

}  // namespace supple
