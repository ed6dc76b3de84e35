// Supple in one header: open a volume or state, choose its material, drag, anchor, cut, relax,
// undo, and get displacement, offsets, pictures and files.
//
//   supple::SessionOptions options;
//   options.material = supple::read_material("ct_head_material.toml");
//   supple::Session session("ct_head.nhdr", options);
//   session.fix({{20, 20, 60}, {235, 150, 107}});                // voxels that stay
//   session.drag(supple::Vec3i(128, 211, 12), {0, 12, 0});       // mm along the grid axes
//   session.write_warp("warp.nrrd");                             // out(x) = in(x + o(x)), LPS mm
//   session.write_state("jaw.vdb");
//   write_png("jaw.png", show(session.state(), &session.pose()));
//
// Errors are supple::Error and its derived classes (volumes/base/error.h).
#pragma once

#include "lib/material/material.h"
#include "lib/session/session.h"
#include "lib/state/state_outputs.h"
#include "tools/scene/pictures/show.h"
#include "volumes/base/version.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"
