// Volumes of stress, strain and energy density of finite elements, and tables of their motion and
// of forces.
#pragma once

#include <string>
#include <vector>

#include "lib/session/session.h"
#include "volumes/base/progress.h"

namespace supple::tools {

/// Values of the last step that has some of this quantity (FemStep::wanted), as float32 at the
/// voxels where the elements were at rest, 0 elsewhere. The format follows the extension. Throws as
/// write_volume.
void write_element_volume(const std::string& path, const Session& session, FemQuantity quantity,
                          Progress* progress);

/// Writes one value per element, in the order of the bricks, the same way.
void write_element_values(const std::string& path, const Geometry& geometry,
                          const BrickTopology& elements, const std::vector<float>& of_element,
                          Progress* progress);

/// Writes the motion in time of the last step that has one (motion_csv). Throws SystemError.
void write_motion_table(const std::string& path, const Session& session);

/// A row for each handle that is held at the end of a step, and for each shape in contact, with the
/// force with which the body pulls at or presses on it. Throws SystemError.
void write_force_table(const std::string& path, const Session& session);

}  // namespace supple::tools
