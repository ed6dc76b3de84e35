#include "tools/bench/peers/vtk_peer.h"

#include <array>
#include <fstream>

#include "tools/bench/peers/vtk_programs.h"

namespace supple::tools {

bool VtkPeer::is_installed() {
  return VirtualDisplay::is_installed() &&
         has_python_with_vtk({"vtkRenderingVolumeOpenGL2", "vtkIOImage"});
}

VtkPeer::VtkPeer(const nlohmann::json& job, const VirtualDisplay& display)
    : m_height(job.at("size").at(1)) {
  std::ofstream(m_scratch / "job.json") << job;
  std::ofstream(m_scratch / "frame.py") << kVtkFrame;
  m_process = std::make_unique<PeerProcess>(
      std::vector<std::string>{kPythonWithVtk, m_scratch / "frame.py", m_scratch / "job.json"},
      std::vector<std::string>{display.environment()});
}

VtkAnswer VtkPeer::draw(const VtkPicture& picture) {
  nlohmann::json request = {{"step", picture.step_mm},
                            {"shade", picture.is_shaded},
                            {"fresh", picture.is_fresh},
                            {"image", nullptr}};
  if (!picture.image.empty()) request["image"] = picture.image;
  const auto answer = nlohmann::json::parse(m_process->ask(request.dump()));
  const double growth =
      answer.at("peak_mbytes").get<double>() - answer.at("base_mbytes").get<double>();
  const std::array<int, 2> origin = answer.at("cast_origin"), size = answer.at("cast_size");
  const int bottom = m_height - origin[1];
  return {answer.at("frame_ms"),
          answer.at("cast_ms"),
          growth,
          {origin[0], bottom - size[1], origin[0] + size[0], bottom}};
}

}  // namespace supple::tools
