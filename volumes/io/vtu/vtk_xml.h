// VTK's XML files: the document in front of appended data, and how arrays are coded.
#pragma once

#include <pugixml.hpp>

#include "volumes/io/vtu/vtu_arrays.h"

namespace supple {

/// The whole file, and what is in front of appended data as XML that ends.
struct VtkXml {
  std::string bytes;
  pugi::xml_document xml;
  VtuEncoding encoding;
};

/// Throws InputError for what is no such file, and for other compressions than zlib.
void open_vtk_xml(const std::string& path, VtkXml& content);

/// The attributes of a <DataArray>.
VtuArray array_of(const pugi::xml_node& node);

}  // namespace supple
