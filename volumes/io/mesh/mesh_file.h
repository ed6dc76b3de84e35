// A mesh file whose vertices move: the same file again with other coordinates and normals, and
// everything else byte for byte, be it faces, lines, colours, scalars, names or comments.
// Cost: twice the file's bytes, 100 bytes per vertex, and that of mesh_slots.h.
#pragma once

#include <functional>
#include <string>

#include "volumes/io/mesh/mesh_slots.h"
#include "volumes/io/mesh/triangle_mesh.h"

namespace supple {

class MeshFile {
 public:
  /// The formats of read_mesh, also without any triangle; VTK files of grids, too. Throws
  /// InputError as read_mesh and for coordinates of an integer type.
  explicit MeshFile(const std::string& path);

  const std::vector<Vec3d>& positions_lps_mm() const { return m_mesh.vertices_lps_mm; }
  std::size_t normal_count() const { return m_slots.normals.size(); }

  /// A normal at a vertex, LPS, as it is after the move; its length does not matter.
  using TurnNormal = std::function<Vec3d(std::size_t vertex, const Vec3d& normal)>;

  /// Writes the file with these positions. Normals keep their length; one that several vertices
  /// share becomes the mean of its images at each of them, one of an STL triangle follows from its
  /// new corners; those of length 0 stay. Numbers that do not change keep their digits. Throws as
  /// OutputFile.
  void write_moved(const std::string& path, const std::vector<Vec3d>& positions_lps_mm,
                   const TurnNormal& turned) const;

 private:
  struct Edit {
    NumberSlot slot;
    double value;
  };
  void edit(const VectorSlot& slot, const Vec3d& before, const Vec3d& after,
            std::vector<Edit>& edits) const;
  std::string edited(std::vector<Edit> edits) const;
  Vec3d new_normal(const MeshSlots::Normal& normal, const std::vector<Vec3d>& positions_lps_mm,
                   const TurnNormal& turned) const;
  Vec3d in_frame(const Vec3d& v) const { return m_is_ras ? Vec3d(-v.x, -v.y, v.z) : v; }

  std::string m_content;
  TriangleMesh m_mesh;
  MeshSlots m_slots;
  bool m_is_ras = false;
};

}  // namespace supple
