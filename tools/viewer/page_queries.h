// Questions of a page, which change nothing.
#pragma once

#include "tools/viewer/folders.h"
#include "tools/viewer/open_scene.h"
#include "tools/viewer/page_message.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// Answers to `list`, `presets`, `options`, `materials`. Throws InputError.
Value query(const PageMessage& message, const Folders& folders);

int histogram_bins(Table& table);
/// Counts of the densities of the elements, in so many bins.
Value histogram_json(OpenScene& scene, int bins);
/// The material as its file has it.
Value material_json(OpenScene& scene);

/// As the page sees them, but for the range of the overlay.
Value slices_json(SliceSettings slices);

}  // namespace supple::tools
