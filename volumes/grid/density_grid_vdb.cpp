#include "volumes/grid/density_grid_vdb.h"

namespace supple {

void initialize_vdb() {
  openvdb::initialize();
  openvdb::logging::setLevel(openvdb::logging::Level::Fatal);
}

}  // namespace supple
