// What a page asks that changes nothing.
#pragma once

#include <nlohmann/json.hpp>

#include "tools/viewer/folders.h"
#include "tools/viewer/open_scene.h"
#include "tools/viewer/page_message.h"

namespace supple::tools {

/// Answers to `list`, `presets`, `options`, `materials`. Throws InputError.
nlohmann::ordered_json query(const PageMessage& message, const Folders& folders);

int histogram_bins(Table& table);
/// Of the densities of the elements.
nlohmann::ordered_json histogram_json(OpenScene& scene, int bins);
/// The material as its file has it.
nlohmann::ordered_json material_json(OpenScene& scene);

/// As the page sees them, but for the range of the overlay.
nlohmann::ordered_json slices_json(SliceSettings slices);

}  // namespace supple::tools
