#include "tools/scene/peers/vtk_peer.h"

#include <array>
#include <fstream>

#include "tools/scene/peers/vtk_frame.h"

namespace supple::tools {

namespace {

nlohmann::json to_json(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

}  // namespace

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

void VtkPeer::open(const nlohmann::json& job) {
  m_height = job.at("size").at(1);
  std::ofstream(m_scratch / "job.json") << job;
  m_process->ask(m_scratch / "job.json", m_progress);
}

VtkAnswer VtkPeer::draw(const VtkPicture& picture) {
  nlohmann::json request = {{"step", picture.step_mm},
                            {"shade", picture.is_shaded},
                            {"fresh", picture.is_fresh},
                            {"image", nullptr}};
  if (!picture.image.empty()) request["image"] = picture.image;
  const auto answer = nlohmann::json::parse(m_process->ask(request.dump(), m_progress));
  const double growth =
      answer.at("peak_mbytes").get<double>() - answer.at("base_mbytes").get<double>();
  const std::array<int, 2> origin = answer.at("cast_origin"), size = answer.at("cast_size");
  const int bottom = m_height - origin[1];
  return {answer.at("frame_ms"),
          answer.at("cast_ms"),
          growth,
          {origin[0], bottom - size[1], origin[0] + size[0], bottom}};
}

nlohmann::json vtk_job(const std::string& volume, const Camera& camera,
                       const TransferFunction& function, const RenderSettings& settings,
                       int threads, bool is_transparent) {
  nlohmann::json opacity, colour, lights, height;
  for (const OpacityKey& key : function.opacity) opacity.push_back({key.density, key.opacity});
  for (const ColourKey& key : function.colour) {
    colour.push_back({key.density, nlohmann::json(key.rgb)});
  }
  std::vector<Light> given = settings.lighting.lights;
  if (given.empty()) given.emplace_back();
  for (const Light& light : given) {
    lights.push_back({{"direction", to_json(light.direction)},
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
          {"position", to_json(camera.position_lps_mm)},
          {"target", to_json(camera.target_lps_mm)},
          {"up", to_json(camera.up_lps)},
          {"fov", camera.vertical_fov_degrees},
          {"height", height},
          {"lights", lights},
          {"size", {settings.width, settings.height}},
          {"threads", threads},
          {"transparent", is_transparent}};
}

}  // namespace supple::tools
