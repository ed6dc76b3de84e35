// Other people's inversions, out of process: VTK by Debian's python3-vtk9, ITK by the program
// supple-itk-inverse, which is built where ITK's headers are.
#pragma once

#include <optional>
#include <string>

#include "volumes/field/offset_field.h"

namespace supple::tools {

struct PeerInverse {
  VectorBricks o;  // at every voxel of the box
  double ms = 0;   // of the inversion alone, without reading and writing
};

/// `peer`: vtk or itk. `u` fills the box of `geometry`, which has unit spacing. Empty when the peer
/// is not installed. Throws SystemError when a file cannot be written, Error when the peer fails.
std::optional<PeerInverse> invert_by_peer(const std::string& peer, const Displacement& displacement,
                                          int threads);

}  // namespace supple::tools
