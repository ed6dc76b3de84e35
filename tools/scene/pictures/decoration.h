// Background and annotations of a picture, as views and slices ask for them.
#pragma once

#include <string>
#include <vector>

#include "volumes/base/fields.h"

namespace supple::tools {

struct Decoration {
  std::string background;             // empty: transparent, of slices black
  std::vector<std::string> annotate;  // names of annotation_names(), or "all"

  /// True if it asks for an annotation, by its name or as one of all.
  bool shows(const std::string& annotation) const;
};

/// Keys of a [[view]], with slices or in space.
Fields fields(Decoration& decoration);

/// Throws InputError: no background, or an annotation that slices (or pictures in space) lack.
void check_decoration(const Decoration& decoration, bool is_of_slices);

}  // namespace supple::tools
