#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "lib/material/material.h"
#include "lib/material/presets.h"
#include "volumes/base/error.h"
#include "volumes/base/table.h"

namespace supple {

namespace {

constexpr const char* kAxisNames = "ijk";

constexpr const char* kCurveExpected = "a number or a list of [density, value] pairs";

/// Reads key points, or a number for all densities of the domain.
std::optional<Curve> read_curve(Table& table, const std::string& key, const LimitTable& limits) {
  const Value* value = table.find(key);
  if (value != nullptr && value->is_number()) {
    return Curve{{{limits.domain_lo, *table.get<double>(key)}}};
  }
  const auto rows = table.rows(key, {2}, kCurveExpected);
  if (!rows) return std::nullopt;
  if (rows->empty()) table.fail(key, "an empty list", "at least one [density, value] pair");
  Curve curve;
  for (const auto& row : *rows) curve.keys.emplace_back(row[0], row[1]);
  return curve;
}

void read_range(Table& table, const std::string& key, double& lo, double& hi) {
  const auto values = table.get<std::vector<double>>(key);
  if (!values) return;
  if (values->size() != 2) {
    table.fail(key, std::to_string(values->size()) + " values", "two numbers [low, high]");
  }
  lo = (*values)[0];
  hi = (*values)[1];
}

/// Reads [LO, HI] or "foreground"; a preset's choice where the table has none.
void read_active(Table& table, const MaterialTable* tissue, MaterialTable& material) {
  material.active_lo = material.domain_lo;
  material.active_hi = material.domain_hi;
  if (is_text(table.find("active"))) {
    const std::string name = *table.get<std::string>("active");
    if (name != "foreground") table.fail("active", '"' + name + '"', "[LO, HI] or \"foreground\"");
    material.finds_foreground = true;
  } else {
    read_range(table, "active", material.active_lo, material.active_hi);
    material.finds_foreground =
        tissue != nullptr && tissue->finds_foreground && !table.has("active");
  }
  material.fits_active =
      material.fits_domain && (material.finds_foreground || !table.has("active"));
}

Combine read_combine(Table& table) {
  const std::string name = table.get<std::string>("combine").value_or("density");
  if (name == "density") return Combine::density;
  if (name == "limits") return Combine::limits;
  table.fail("combine", "\"" + name + "\"", "\"density\" or \"limits\"");
}

/// Reads true, false or "poisson".
void read_relax(Table& table, MaterialTable& material) {
  try {
    material.relaxes = table.get<bool>("relax").value_or(material.relaxes);
    material.relaxes_by_poisson = material.relaxes_by_poisson && !table.has("relax");
  } catch (const InputError&) {
    const std::string name = table.get<std::string>("relax").value_or("");
    if (name != "poisson") {
      table.fail("relax", '"' + name + '"', "true, false or \"poisson\"");
    }
    material.relaxes = material.relaxes_by_poisson = true;
  }
  if (material.relaxes_by_poisson && material.links != 6) {
    table.fail("relax", "\"poisson\" with " + std::to_string(material.links) + " links",
               "6 links, or true");
  }
}

int read_components(Table& table) {
  if (!table.has("components")) return 0;
  try {
    const std::string name = table.get<std::string>("components").value_or("");
    if (name == "all") return 0;
    if (name == "largest") return 1;
  } catch (const InputError&) {
    const long long count = table.get<long long>("components").value_or(0);
    if (count >= 1 && count <= 1000000) return int(count);
  }
  table.fail("components", "another value", "\"all\", \"largest\" or a count from 1");
}

int read_links(Table& table) {
  const long long links = table.get<long long>("links").value_or(6);
  if (links == 6 || links == 18 || links == 26) return int(links);
  table.fail("links", std::to_string(links), "6, 18 or 26");
}

std::optional<std::pair<double, double>> read_rigid(Table& table) {
  std::pair<double, double> range;
  read_range(table, "rigid", range.first, range.second);
  if (!(range.first <= range.second)) {
    table.fail("rigid", number_text(range.first) + " before " + number_text(range.second),
               "densities [LEAST, LARGEST]");
  }
  return range;
}

void append_curve(std::string& text, const std::string& name, const Curve& curve) {
  text += name + " = [";
  for (const auto& [density, value] : curve.keys) {
    text += "[" + number_text(density, 17) + ", " + number_text(value, 17) + "], ";
  }
  text.replace(text.size() - 2, 2, "]\n");
}

void append_range(std::string& text, const std::string& name, double lo, double hi) {
  text += name + " = [" + number_text(lo, 17) + ", " + number_text(hi, 17) + "]\n";
}

void append_limits(std::string& text, const LimitTable& limits) {
  for (const NamedCurve& named : curves_of(limits)) append_curve(text, named.name, *named.curve);
}

void know_limits(Table& table) {
  table.know({"domain", "max_length", "min_length", "shear", "shear1", "shear2", "max_length_i",
              "max_length_j", "max_length_k", "min_length_i", "min_length_j", "min_length_k",
              "preset"});
  for (const PhysicalColumn& column : kPhysicalColumns) table.know({column.name});
}

/// Reads the curves that stand for keys that are not given: those of the preset, or none. `tissue`:
/// the table of a tissue preset, which only the common table can have.
LimitTable read_preset(Table& table, const LimitTable& limits, const MaterialTable* tissue) {
  const auto name = table.get<std::string>("preset");
  if (!name) return {};
  if (tissue != nullptr) return *tissue;
  try {
    return preset_table(*name, limits.domain_lo, limits.domain_hi);
  } catch (const InputError& error) {
    table.fail("preset", error.problem().found, error.problem().expected);
  }
}

/// Reads curves over the domain of `limits`.
void read_curves(Table& table, LimitTable& limits, const MaterialTable* tissue = nullptr) {
  const LimitTable preset = read_preset(table, limits, tissue);
  const auto or_else = [](std::optional<Curve> curve, const Curve& of_preset) {
    return curve || of_preset.keys.empty() ? std::move(curve) : std::optional<Curve>(of_preset);
  };
  const auto required = [&](const std::string& key, const Curve& of_preset) {
    return table.require(or_else(read_curve(table, key, limits), of_preset), key, kCurveExpected);
  };
  limits.max_length = required("max_length", preset.max_length);
  limits.min_length = required("min_length", preset.min_length);
  const auto shear = read_curve(table, "shear", limits);
  const auto shear1 = read_curve(table, "shear1", limits);
  const auto shear2 = read_curve(table, "shear2", limits);
  if (shear && (shear1 || shear2)) {
    table.fail("shear", "shear beside shear1 or shear2", "either shear or both shear1 and shear2");
  }
  limits.shear1 = table.require(or_else(shear ? shear : shear1, preset.shear1),
                                shear2 ? "shear1" : "shear", kCurveExpected);
  limits.shear2 =
      table.require(or_else(shear ? shear : shear2, preset.shear2), "shear2", kCurveExpected);
  for (int axis = 0; axis < 3; ++axis) {
    const std::string suffix = std::string("_") + kAxisNames[axis];
    limits.max_length_axis[axis] = read_curve(table, "max_length" + suffix, limits);
    limits.min_length_axis[axis] = read_curve(table, "min_length" + suffix, limits);
  }
  for (const PhysicalColumn& column : kPhysicalColumns) {
    limits.*column.curve = read_curve(table, column.name, limits);
    if (!(limits.*column.curve)) limits.*column.curve = preset.*column.curve;
  }
}

/// Reads [label.N] tables, N a number or a name, each with the domain of `material` unless it has
/// its own.
void read_labels(Table& labels, const LabelNames& names, MaterialTable& material) {
  for (const std::string& key : labels.keys()) {
    const auto label = find_label(names, key);
    if (!label) labels.fail(key, "\"" + key + "\"", expected_label(names));
    if (material.labels.count(*label) != 0) {
      labels.fail(key, "a second table of label " + std::to_string(*label), "one");
    }
    Table table = *labels.table(key);
    LimitTable& limits = material.labels[*label];
    know_limits(table);
    limits.domain_lo = material.domain_lo;
    limits.domain_hi = material.domain_hi;
    read_range(table, "domain", limits.domain_lo, limits.domain_hi);
    read_curves(table, limits);
    table.finish();
  }
}

/// The table of a tissue preset, if the table names one. Curves of one that fits its domain to the
/// volume are constant.
std::optional<MaterialTable> read_tissue(Table& table) {
  if (!is_text(table.find("preset"))) return std::nullopt;
  const std::string name = *table.get<std::string>("preset");
  const TissuePreset* preset = find_tissue_preset(name);
  if (preset == nullptr) {
    const auto& others = material_presets();
    const bool is_known = std::any_of(others.begin(), others.end(),
                                      [&](const auto& other) { return name == other.name; });
    if (is_known) return std::nullopt;
    table.fail("preset", '"' + name + '"', "one of " + all_preset_names());
  }
  MaterialTable tissue = parse_material(preset->table, preset->name);
  tissue.fits_domain = std::string(preset->table).rfind("domain", 0) != 0;
  return tissue;
}

}  // namespace

MaterialTable read_material_table(Table& table, const LabelNames& names) {
  know_limits(table);
  table.know({"active", "combine", "components", "links", "rigid", "relax", "contact", "label"});
  const std::optional<MaterialTable> tissue = read_tissue(table);
  MaterialTable material;
  if (tissue) {
    material.domain_lo = tissue->domain_lo;
    material.domain_hi = tissue->domain_hi;
    material.components = tissue->finds_foreground ? 0 : tissue->components;
    material.links = tissue->links;
    material.rigid = tissue->rigid;
    material.relaxes = tissue->relaxes;
    material.relaxes_by_poisson = tissue->relaxes_by_poisson;
    material.has_contact = tissue->has_contact;
    material.fits_domain = tissue->fits_domain;
  } else {
    material.fits_domain = table.has("preset");
  }
  read_range(table, "domain", material.domain_lo, material.domain_hi);
  material.fits_domain = material.fits_domain && !table.has("domain");
  read_active(table, tissue ? &*tissue : nullptr, material);
  read_curves(table, material, tissue ? &*tissue : nullptr);
  material.combine = read_combine(table);
  if (table.has("components")) {
    material.components = read_components(table);
  } else if (material.finds_foreground) {
    material.components = 1;
  }
  if (table.has("links")) material.links = read_links(table);
  if (table.has("rigid")) material.rigid = read_rigid(table);
  read_relax(table, material);
  material.has_contact = table.get<bool>("contact").value_or(material.has_contact);
  if (auto labels = table.table("label")) read_labels(*labels, names, material);
  table.finish();
  material.validate(table.place());
  return material;
}

MaterialTable parse_material(const std::string& text, const std::string& source) {
  Table table = Table::parse(text, source);
  return read_material_table(table);
}

MaterialTable preset_material(const std::string& preset) {
  Table table({{"preset", preset}}, preset);
  return read_material_table(table);
}

MaterialTable read_material(const std::string& path, const LabelNames& names) {
  if (find_tissue_preset(path) != nullptr && !std::filesystem::exists(path)) {
    return preset_material(path);
  }
  Table table = Table::read(path);
  return read_material_table(table, names);
}

std::string material_to_toml(const MaterialTable& material) {
  std::string text;
  append_range(text, "domain", material.domain_lo, material.domain_hi);
  if (material.finds_foreground) {
    text += "active = \"foreground\"\n";
  } else {
    append_range(text, "active", material.active_lo, material.active_hi);
  }
  append_limits(text, material);
  if (material.combine == Combine::limits) text += "combine = \"limits\"\n";
  if (material.components > 0) {
    text += "components = " + std::to_string(material.components) + "\n";
  }
  if (material.links != 6) text += "links = " + std::to_string(material.links) + "\n";
  if (material.rigid) append_range(text, "rigid", material.rigid->first, material.rigid->second);
  if (material.relaxes) {
    text += material.relaxes_by_poisson ? "relax = \"poisson\"\n" : "relax = true\n";
  }
  if (!material.has_contact) text += "contact = false\n";
  for (const auto& [label, limits] : material.labels) {
    text += "\n[label." + std::to_string(label) + "]\n";
    append_range(text, "domain", limits.domain_lo, limits.domain_hi);
    append_limits(text, limits);
  }
  return text;
}

MaterialTable homogeneous_material(double min, double max) {
  MaterialTable material;
  material.domain_lo = min;
  material.domain_hi = max > min ? max : min + 1;
  material.active_lo = std::nextafter(float(min), float(material.domain_hi));
  material.active_hi = material.domain_hi;
  material.max_length.keys = {{min, 1.2}};
  material.min_length.keys = {{min, 0.8}};
  material.shear1.keys = material.shear2.keys = {{min, 0.3}};
  return material;
}

}  // namespace supple
