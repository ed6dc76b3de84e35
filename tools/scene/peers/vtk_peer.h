// VTK's fixed-point ray caster in a Python process of its own (vtk_frame.py), picture by picture.
#pragma once

#include <memory>
#include <string>

#include "raycast/render.h"
#include "tools/scene/peers/peer_process.h"
#include "volumes/base/value.h"

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
  /// True where Debian's VTK for Python and Xvfb are.
  static bool is_installed();

  /// Starts it. All throw Error when VTK fails, and Cancelled when `progress`, which outlives the
  /// peer, says so.
  explicit VtkPeer(const VirtualDisplay& display, const Progress* progress = nullptr);

  /// Reads the volume of a job as vtk_job() makes it.
  void open(const Value& job);
  VtkAnswer draw(const VtkPicture& picture);
  ProcessCost finish() { return m_process->finish(); }

 private:
  const Progress* m_progress;
  int m_height = 0;  // of the window
  ScratchFolder m_scratch;
  std::unique_ptr<PeerProcess> m_process;
};

/// A view of the volume in a MetaImage file whose axes are those of the world, as VtkPeer draws it.
/// Takes the size and the lights of the settings. On black, unless it is transparent.
Value vtk_job(const std::string& volume, const Camera& camera, const TransferFunction& function,
              const RenderSettings& settings, int threads, bool is_transparent = false);

}  // namespace supple::tools
