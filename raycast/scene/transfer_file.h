// Transfer functions as TOML: presets written out, edited, and read again.
#pragma once

#include <string>

#include "raycast/scene/transfer_function.h"
#include "volumes/base/table.h"

namespace supple {

/// Throws InputError: missing or bad file, unknown key, values that TransferFunction refuses.
TransferFunction read_transfer_function(const std::string& path);
/// Reads it from a table, with the same errors.
TransferFunction read_transfer_function(Table& table);

/// Text that read_transfer_function() reads back exactly.
std::string to_toml(const TransferFunction& function);

}  // namespace supple
