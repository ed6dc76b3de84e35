#include "volumes/grid/vdb_grid.h"

namespace supple {

void initialize_vdb() {
  openvdb::initialize();
  openvdb::logging::setLevel(openvdb::logging::Level::Fatal);
}

}  // namespace supple
