#include "volumes/state/state_vdb.h"

#include <fstream>

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr std::size_t kMaxMessage = 1000;

/// The steps of io::Stream, grid by grid.
class StateArchive : public openvdb::io::Archive {
 public:
  StateContent read(std::istream& in) {
    readHeader(in);
    auto about = std::make_shared<openvdb::io::StreamMetadata>();
    openvdb::io::setStreamMetadataPtr(in, about, /*transfer=*/false);
    openvdb::io::setVersion(in, libraryVersion(), fileVersion());
    openvdb::io::setDataCompression(in, compression());
    StateContent content;
    content.metadata.readMeta(in);
    const int count = readGridCount(in);
    for (int n = 0; n < count; ++n) {
      openvdb::io::GridDescriptor descriptor;
      const openvdb::GridBase::Ptr grid = descriptor.read(in);
      const std::string& name = descriptor.gridName();
      if (name == kDisplacementGrid || name == kOffsetGrid) break;
      readGrid(grid, descriptor, in);
      content.grids.push_back(grid);
    }
    return content;
  }
};

}  // namespace

StateContent read_state_grids(const std::string& path) {
  try {
    std::ifstream in(path, std::ios::binary);
    in.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
    return StateArchive().read(in);
  } catch (const std::bad_alloc&) {
    throw SystemError(path + ": not enough memory");
  } catch (const std::exception& error) {
    throw InputError({path, "", std::string(error.what()).substr(0, kMaxMessage), "OpenVDB grids"});
  }
}

}  // namespace supple
