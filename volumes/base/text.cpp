#include "volumes/base/text.h"

#include <sstream>

namespace supple {

std::string with_count(std::int64_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string to_text(const Vec3i& v) {
  return std::to_string(v.x) + "," + std::to_string(v.y) + "," + std::to_string(v.z);
}

std::string to_text(const Vec3d& v) {
  std::ostringstream text;
  text << v.x << "," << v.y << "," << v.z;
  return text.str();
}

}  // namespace supple
