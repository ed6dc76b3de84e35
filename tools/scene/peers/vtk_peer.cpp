#include "tools/scene/peers/vtk_peer.h"

#include <array>
#include <fstream>

#include "tools/scene/peers/vtk_frame.h"
#include "volumes/base/json.h"

namespace supple::tools {

bool VtkPeer::is_installed() {
  return VirtualDisplay::is_installed() &&
         has_python_with_vtk({"vtkRenderingVolumeOpenGL2", "vtkIOImage"});
}

VtkPeer::VtkPeer(const VirtualDisplay& display, const Progress* progress) : m_progress(progress) {
  std::ofstream(m_scratch / "frame.py") << kVtkFrame;
  m_process = std::make_unique<PeerProcess>(
      std::vector<std::string>{kPythonWithVtk, m_scratch / "frame.py"},
      std::vector<std::string>{display.environment()});
  m_process->read_line(m_progress);
}

void VtkPeer::open(const Value& job) {
  m_height = int(job.at("size").at(1).whole());
  std::ofstream(m_scratch / "job.json") << json_text(job);
  m_process->ask(m_scratch / "job.json", m_progress);
}

VtkAnswer VtkPeer::draw(const VtkPicture& picture) {
  Value request = {{"step", picture.step_mm},
                   {"shade", picture.is_shaded},
                   {"fresh", picture.is_fresh},
                   {"image", nullptr}};
  if (!picture.image.empty()) request["image"] = picture.image;
  const Value answer = parse_json(m_process->ask(json_text(request), m_progress));
  const double growth = answer.at("peak_mbytes").number() - answer.at("base_mbytes").number();
  const auto pixel = [&](const char* key, std::size_t axis) {
    return int(answer.at(key).at(axis).whole());
  };
  const int left = pixel("cast_origin", 0), bottom = m_height - pixel("cast_origin", 1);
  return {answer.at("frame_ms").number(),
          answer.at("cast_ms").number(),
          growth,
          {left, bottom - pixel("cast_size", 1), left + pixel("cast_size", 0), bottom}};
}

Value vtk_job(const std::string& volume, const Camera& camera, const TransferFunction& function,
              const RenderSettings& settings, int threads, bool is_transparent) {
  Value opacity, colour, lights, height;
  for (const OpacityKey& key : function.opacity) opacity.push_back({key.density, key.opacity});
  for (const ColourKey& key : function.colour) {
    colour.push_back({key.density, key.rgb});
  }
  std::vector<Light> given = settings.lighting.lights;
  if (given.empty()) given.emplace_back();
  for (const Light& light : given) {
    lights.push_back({{"direction", light.direction},
                      {"of_camera", light.is_of_camera},
                      {"rgb", light.rgb},
                      {"intensity", light.intensity}});
  }
  if (camera.projection == Projection::orthographic) height = camera.height_mm;
  return {{"volume", volume},
          {"opacity", opacity},
          {"colour", colour},
          {"unit_distance_mm", function.unit_distance_mm},
          {"ambient", function.ambient},
          {"diffuse", function.diffuse},
          {"specular", function.specular},
          {"specular_power", function.specular_power},
          {"position", camera.position_lps_mm},
          {"target", camera.target_lps_mm},
          {"up", camera.up_lps},
          {"fov", camera.vertical_fov_degrees},
          {"height", height},
          {"lights", lights},
          {"size", {settings.width, settings.height}},
          {"threads", threads},
          {"transparent", is_transparent}};
}

}  // namespace supple::tools
