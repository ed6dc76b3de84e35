// The head phantom of 256^3 voxels as files that other programs read, and a view of it that VTK and
// Supple can share: one light at the camera, every gradient trusted.
#pragma once

#include <string>

#include "raycast/render.h"
#include "volumes/grid/density_grid.h"

namespace supple::tools {

struct PeerHead {
  Geometry geometry;    // the index frame along LPS, which VTK 9.1 needs
  DensityGrid density;  // HU; air is not stored
};

constexpr int kPeerHeadSize = 256;
constexpr int kPeerImageSize = 512;
constexpr int kAirRings = 2;  // sampled around tissue, as `supple render` does

Geometry peer_geometry();
PeerHead make_peer_head();
/// Writes the head's densities as int16.
void write_peer_head(const std::string& path, const PeerHead& head);

/// A camera for the head's box, from anterior.
Camera peer_camera(const Geometry& geometry);
/// Bone without its fading of weak gradients, which VTK does not know.
TransferFunction peer_function();
/// 512 x 512 pixels, lit from the camera, or without shading.
RenderSettings peer_settings(bool shaded);

}  // namespace supple::tools
