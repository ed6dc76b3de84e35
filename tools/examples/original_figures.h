// Gibson's original ChainMail beside ECM: the thesis' figure 4.5, a rigid T in soft tissue, and a U
// of one material.
#pragma once

#include <string>

#include "volumes/phantom/phantom.h"

namespace supple::examples {

/// Pulls the right brim of the T phantom to the right. Writes figure_4_5_rest.png,
/// figure_4_5_original.png (torn apart) and figure_4_5_ecm.png into `folder`, and prints how many
/// links each result breaks.
void draw_figure_4_5(const Phantom& t_shape, const std::string& folder);

/// Pulls the tip of the left arm of a U, 12 x 12 voxels of one material, to the left by 20 voxels.
/// Writes figure_u_shape_rest.png, figure_u_shape_original.png (the other arm stays behind) and
/// figure_u_shape_ecm.png, and prints the same.
void draw_u_shape(const std::string& folder);

}  // namespace supple::examples
