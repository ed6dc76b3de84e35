// VTK's fixed-point ray caster in a Python process of its own (vtk_frame.py), picture by picture.
#pragma once

#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "tools/bench/peers/peer_process.h"

namespace supple::tools {

struct VtkPicture {
  double step_mm;
  bool is_shaded;
  bool is_fresh = false;   // the first of a volume that has just changed
  std::string image = {};  // PNG to write; empty: none
};

/// Pixels from (x0, y0) to below (x1, y1), row 0 at the top.
struct PixelBox {
  int x0, y0, x1, y1;
};

struct VtkAnswer {
  double frame_ms;       // until the window shows the picture
  double cast_ms;        // of that, the ray caster alone
  double growth_mbytes;  // peak resident size above that of Python and VTK without data
  PixelBox cast;         // the pixels that rays were cast for
};

class VtkPeer {
 public:
  /// Debian's VTK for Python, and Xvfb.
  static bool is_installed();

  /// `job` as vtk_job() makes it. Reads the volume.
  VtkPeer(const nlohmann::json& job, const VirtualDisplay& display);

  /// Throws Error when VTK fails.
  VtkAnswer draw(const VtkPicture& picture);
  ProcessCost finish() { return m_process->finish(); }

 private:
  int m_height;  // of the window
  ScratchFolder m_scratch;
  std::unique_ptr<PeerProcess> m_process;
};

}  // namespace supple::tools
