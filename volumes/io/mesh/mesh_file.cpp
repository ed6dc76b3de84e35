#include "volumes/io/mesh/mesh_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "volumes/base/text.h"
#include "volumes/io/bytes/output_file.h"
#include "volumes/io/format/dense_writer.h"
#include "volumes/io/mesh/mesh_formats.h"

namespace supple {

namespace {

bool is_direction(const Vec3d& v) {
  const double length = v.length();
  return std::isfinite(length) && length > 0;
}

template <class Value>
void put(double number, bool is_big, char* out) {
  const Value value = Value(number);
  std::memcpy(out, &value, sizeof value);
  if (is_big) std::reverse(out, out + sizeof value);
}

std::string text_of(double value, NumberCode code) {
  if (code == NumberCode::text) return exact_text(value);
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, float(value)).ptr};
}

}  // namespace

MeshFile::MeshFile(const std::string& path) : m_content(read_mesh_content(path)) {
  m_mesh = parse_mesh(path, m_content, &m_slots);
  m_is_ras = says_ras(m_content);
}

void MeshFile::edit(const VectorSlot& slot, const Vec3d& before, const Vec3d& after,
                    std::vector<Edit>& edits) const {
  for (int a = 0; a < 3; ++a) {
    if (before[a] != after[a]) edits.push_back({slot[std::size_t(a)], in_frame(after)[a] + 0.0});
  }
}

/// The new normal, in LPS; the old one where nothing turns it.
Vec3d MeshFile::new_normal(const MeshSlots::Normal& normal,
                           const std::vector<Vec3d>& positions_lps_mm,
                           const TurnNormal& turned) const {
  const Vec3d before = in_frame(normal.direction);
  if (!is_direction(before) || normal.count == 0) return before;
  const int* corners = &m_slots.corners[normal.first];
  Vec3d sum(0);
  bool is_still = true;
  if (normal.is_of_triangle) {
    const std::vector<Vec3d>& old = m_mesh.vertices_lps_mm;
    for (int n = 0; n < 3; ++n)
      is_still = is_still && old[corners[n]] == positions_lps_mm[corners[n]];
    const auto area = [&](const std::vector<Vec3d>& p) {
      return (p[corners[1]] - p[corners[0]]).cross(p[corners[2]] - p[corners[0]]);
    };
    sum = area(positions_lps_mm) * (area(old).dot(before) < 0 ? -1 : 1);
  } else {
    for (std::size_t n = 0; n < normal.count; ++n) {
      const Vec3d part = turned(std::size_t(corners[n]), before);
      is_still = is_still && part == before;
      if (is_direction(part)) sum += part / part.length();
    }
  }
  if (is_still || !is_direction(sum)) return before;
  return sum * (before.length() / sum.length());
}

/// The content with these numbers.
std::string MeshFile::edited(std::vector<Edit> edits) const {
  std::sort(edits.begin(), edits.end(),
            [](const Edit& a, const Edit& b) { return a.slot.begin < b.slot.begin; });
  std::string text;
  text.reserve(m_content.size() + m_content.size() / 4);
  std::size_t taken = 0;
  for (const auto& [slot, value] : edits) {
    text.append(m_content, taken, slot.begin - taken);
    taken = slot.begin + slot.size;
    char bytes[8];
    switch (slot.code) {
      case NumberCode::text:
      case NumberCode::text_float:
        text += text_of(value, slot.code);
        continue;
      case NumberCode::float32_little:
      case NumberCode::float32_big:
        put<float>(value, slot.code == NumberCode::float32_big, bytes);
        break;
      case NumberCode::float64_little:
      case NumberCode::float64_big:
        put<double>(value, slot.code == NumberCode::float64_big, bytes);
        break;
    }
    text.append(bytes, slot.size);
  }
  text.append(m_content, taken);
  return text;
}

void MeshFile::write_moved(const std::string& path, const std::vector<Vec3d>& positions_lps_mm,
                           const TurnNormal& turned) const {
  std::vector<Edit> edits;
  for (std::size_t n = 0; n < m_slots.positions.size(); ++n) {
    edit(m_slots.positions[n], m_mesh.vertices_lps_mm[n], positions_lps_mm[n], edits);
  }
  for (const MeshSlots::Normal& normal : m_slots.normals) {
    edit(normal.slot, in_frame(normal.direction), new_normal(normal, positions_lps_mm, turned),
         edits);
  }
  OutputFile out(path);
  out.write(edited(std::move(edits)));
  out.close();
  out.commit();
}

}  // namespace supple
