// Material tables as TOML (design.md section 2).
#pragma once

#include <string>

#include "lib/material/material.h"
#include "volumes/base/text.h"

namespace supple {

class Table;

/// Reads a material file; throws InputError naming the key point. `names` are those of a
/// segmentation's labels (label_names of volumes/io/load/label_file.h); tables of labels may use
/// them.
MaterialTable read_material(const std::string& path, const LabelNames& names = {});
/// Parses a table from text, e.g. the one that a state carries; `source` names it in errors.
MaterialTable parse_material(const std::string& text, const std::string& source);
/// The material of a tissue preset as if a table named it.
MaterialTable preset_material(const std::string& preset);
/// Reads the keys of a material out of a table (a file's root or a scene's [material]); a preset
/// stands for the keys that are not given.
MaterialTable read_material_table(Table& table, const LabelNames& names = {});

/// Canonical text: parse_material(material_to_toml(m)) equals m.
std::string material_to_toml(const MaterialTable& material);

/// For a volume without a table: every voxel above `min` is tissue of one kind.
MaterialTable homogeneous_material(double min, double max);

}  // namespace supple
