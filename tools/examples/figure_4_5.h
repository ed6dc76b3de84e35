// The thesis' figure 4.5: a rigid T in soft tissue under Gibson's original ChainMail and under ECM.
#pragma once

#include <string>

#include "volumes/phantom/phantom.h"

namespace supple::examples {

/// Pulls the right brim of the T phantom to the right. Writes figure_4_5_rest.png,
/// figure_4_5_original.png (torn apart) and figure_4_5_ecm.png into `folder`, and prints how many
/// links each result breaks.
void draw_figure_4_5(const Phantom& t_shape, const std::string& folder);

}  // namespace supple::examples
