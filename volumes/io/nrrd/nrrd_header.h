// The text of a NRRD header as fields and key/value pairs, before any of it is understood.
// Source: http://teem.sourceforge.net/nrrd/format.html.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "volumes/io/bytes/byte_source.h"
#include "volumes/io/bytes/text_header.h"

namespace supple {

struct NrrdHeader {
  std::string path;
  std::map<std::string, std::string> fields;  // by canonical name
  std::map<std::string, std::string> keys;    // of the lines "key:=value"; the last of equals
  std::vector<std::string> files;             // of "data file: LIST"
  std::size_t end = 0;                        // offset behind the blank line, attached data only

  bool has(const std::string& name) const { return fields.count(name) > 0; }
  HeaderField field(const std::string& name) const;
};

/// Throws InputError for a line that is no field of the format and for fields given twice.
NrrdHeader parse_nrrd_header(const InputFile& file);

}  // namespace supple
