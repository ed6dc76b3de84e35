#include "volumes/geometry/geometry_text.h"

#include <nlohmann/json.hpp>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr std::size_t kMaxFoundText = 80;

int to_int(const nlohmann::json& json) {
  const auto value = json.is_number_integer() ? json.get<std::int64_t>() : std::int64_t(1) << 40;
  if (value != std::int64_t(int(value))) throw std::out_of_range("no 32-bit integer");
  return int(value);
}

Vec3d to_vec3d(const nlohmann::json& json) {
  if (json.size() != 3) throw std::out_of_range("no three numbers");
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

nlohmann::json from_vec(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

}  // namespace

std::string geometry_to_json(const Geometry& geometry) {
  const Vec3i& dims = geometry.dims();
  const auto& axes = geometry.axes_mm();
  return nlohmann::json{{"dims", {dims.x, dims.y, dims.z}},
                        {"origin_lps_mm", from_vec(geometry.origin_lps_mm())},
                        {"axes_mm", {from_vec(axes[0]), from_vec(axes[1]), from_vec(axes[2])}}}
      .dump();
}

Geometry geometry_from_json(const std::string& text, const std::string& file) {
  const nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) {
    throw InputError({file, "geometry", text.substr(0, kMaxFoundText), "JSON"});
  }
  try {
    const nlohmann::json& dims = json.at("dims");
    const nlohmann::json& axes = json.at("axes_mm");
    return Geometry({to_int(dims.at(0)), to_int(dims.at(1)), to_int(dims.at(2))},
                    to_vec3d(json.at("origin_lps_mm")),
                    {to_vec3d(axes.at(0)), to_vec3d(axes.at(1)), to_vec3d(axes.at(2))});
  } catch (const InputError& error) {
    Problem problem = error.problem();
    problem.file = file;
    throw InputError(problem);
  } catch (const std::exception&) {
    throw InputError(
        {file, "geometry", text.substr(0, kMaxFoundText), "dims, origin_lps_mm and axes_mm"});
  }
}

}  // namespace supple
