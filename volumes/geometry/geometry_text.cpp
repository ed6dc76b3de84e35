#include "volumes/geometry/geometry_text.h"

#include "volumes/base/error.h"
#include "volumes/base/json.h"

namespace supple {

namespace {

constexpr std::size_t kMaxFoundText = 80;

int to_int(const Value& value) {
  if (value.whole() != std::int64_t(int(value.whole()))) throw std::out_of_range("no 32 bits");
  return int(value.whole());
}

Vec3d to_vec3d(const Value& value) {
  if (value.size() != 3) throw std::out_of_range("no three numbers");
  return {value.at(0).number(), value.at(1).number(), value.at(2).number()};
}

}  // namespace

std::string geometry_to_json(const Geometry& geometry) {
  return json_text({{"axes_mm", geometry.axes_mm()},
                    {"dims", geometry.dims()},
                    {"origin_lps_mm", geometry.origin_lps_mm()}});
}

Geometry geometry_from_json(const std::string& text, const std::string& file) {
  Value value;
  try {
    value = parse_json(text);
  } catch (const JsonError&) {
    throw InputError({file, "geometry", text.substr(0, kMaxFoundText), "JSON"});
  }
  try {
    const Value& dims = value.at("dims");
    const Value& axes = value.at("axes_mm");
    return Geometry({to_int(dims.at(0)), to_int(dims.at(1)), to_int(dims.at(2))},
                    to_vec3d(value.at("origin_lps_mm")),
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
