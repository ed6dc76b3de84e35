// The values of a volume in one file or in several, one after the other. All files are checked when
// the volume is opened; afterwards one of them is open at a time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "volumes/io/bytes/byte_source.h"

namespace supple {

struct DataPart {
  std::string path;
  ByteRange range;
};

using DataParts = std::vector<DataPart>;

/// All bytes of checked parts, from the first on.
std::unique_ptr<ByteSource> open_parts(std::shared_ptr<const DataParts> parts);

}  // namespace supple
