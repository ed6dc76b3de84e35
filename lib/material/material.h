// Look-up tables from density to link limits (thesis section 4.2.3, figure 4.11; design.md section
// 2) and to the elastic and plastic values of relaxation and springs. Densities become 256 classes;
// a link looks its limits up at the mean of both ends, half classes kept. Labels of a segmentation
// may have tables of their own; links then take the mean of both ends' limits.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volumes/base/text.h"
#include "volumes/base/vec.h"

namespace supple {

class Table;

/// Curve that is piecewise linear through (density, value) key points, constant beyond them.
struct Curve {
  std::vector<std::pair<double, double>> keys;
  double operator()(double density) const;
};

enum class Combine { density, limits };

/// Largest Poisson's ratio: beyond it pressure is lost among the digits of displacements.
constexpr double kLargestPoisson = 0.4999;

/// Classes are 0…kLastClass.
constexpr int kLastClass = 255;

/// Values of a table without the curve.
constexpr double kDefaultStiffnessKpa = 1;
constexpr double kDefaultPoisson = 0.45;
constexpr double kDefaultMassDensity = 1000;  // kg/m³

/// Curves over the densities (voxel values) of a domain. Lengths are factors of the rest length.
struct LimitTable {
  double domain_lo = 0, domain_hi = 255;  // densities spanned by the table's classes
  Curve max_length, min_length, shear1, shear2;
  /// Overrides for one grid axis, e.g. max_length_i (figure 4.7).
  std::array<std::optional<Curve>, 3> max_length_axis, min_length_axis;

  std::optional<Curve> stiffness;     // Young's modulus, kPa, > 0
  std::optional<Curve> poisson;       // Poisson's ratio, 0 to kLargestPoisson
  std::optional<Curve> mass_density;  // kg/m³, > 0; "density" in files
  /// Stiffness-proportional Rayleigh time β, ms, >= 0: damping force = β · elastic stiffness ·
  /// velocity.
  std::optional<Curve> rayleigh_beta_ms;
  /// Yield strain, > 0: how far a link deforms elastically from its rest point, as a fraction of
  /// the rest length, before the rest point follows.
  std::optional<Curve> yield_strain;

  /// True when no curve depends on the density.
  bool is_constant() const;
};

/// A column of physical values, which a table need not have.
struct PhysicalColumn {
  const char* name;  // in files
  std::optional<Curve> LimitTable::*curve;
  bool is_above_zero;
  double largest;
  const char* expected;
};
extern const std::array<PhysicalColumn, 5> kPhysicalColumns;

/// A curve under its name in files.
struct NamedCurve {
  std::string name;
  const Curve* curve;
  double lo, hi;  // admissible values; lo is exclusive when `open`
  bool open;
  const char* expected;
};
/// All curves that the table has.
std::vector<NamedCurve> curves_of(const LimitTable& table);

/// The table as the user wrote it.
struct MaterialTable : LimitTable {
  double active_lo = 1, active_hi = 255;  // densities that are elements
  Combine combine = Combine::density;
  int components = 0;  // 0: all pieces; n: the n largest ("largest" is 1)
  /// Links of a voxel: 6 along the axes, 18 with diagonals of faces, 26 with those of cells.
  int links = 6;
  /// Densities whose face-connected pieces move as rigid bodies.
  std::optional<std::pair<double, double>> rigid;
  /// Drags of this tissue are relaxed unless a step says otherwise (tissue_relaxation()).
  bool relaxes = false;
  /// Such relaxations keep the volume that Poisson's ratio says (RelaxParams::poisson). 6 links.
  bool relaxes_by_poisson = false;
  /// Sides of a cut do not pass through each other (lib/chainmail/cut_contact.h).
  bool has_contact = true;
  /// The table is a preset without a domain: fitted_to() (lib/material/tissue.h) chooses the domain
  /// by the volume, and the active densities with it unless they were given.
  bool fits_domain = false, fits_active = false;
  /// `active = "foreground"`: where densities are not HU, those brighter than the background of the
  /// volume, which fitted_to() finds; their largest piece unless `components` is given.
  bool finds_foreground = false;
  /// Tables of labels (volumes/grid/labels.h), which replace the common one there.
  std::map<std::int32_t, LimitTable> labels;

  /// Links take the mean of both ends' limits; tables of labels always do.
  bool combines_limits() const { return combine == Combine::limits || !labels.empty(); }

  /// True where the common table or one of a label gives the curve.
  bool has_stiffness() const { return has(&LimitTable::stiffness); }
  bool has_poisson() const { return has(&LimitTable::poisson); }
  bool has_mass_density() const { return has(&LimitTable::mass_density); }
  bool has_rayleigh_beta() const { return has(&LimitTable::rayleigh_beta_ms); }
  bool has_yield_strain() const { return has(&LimitTable::yield_strain); }

  /// Throws InputError naming table, key point, value and expectation: 0 < min_length <= 1 <=
  /// max_length, shear >= 0, stiffness, density and plastic > 0, damping >= 0, poisson from 0 to
  /// kLargestPoisson, densities strictly ascending and inside the domain, lo < hi; labels within 1
  /// to kMaxLabel and not more tables than classes.
  void validate(const std::string& file) const;
  /// One line per pair of key points that fall into the same class, and per table that lacks the
  /// stiffness or density that another one gives; empty when there are none.
  std::vector<std::string> warnings() const;

  /// round(255 * (clamp(v) - domain_lo) / (domain_hi - domain_lo)), as MaterialClasses has it
  /// without labels; NaN counts as domain_lo.
  std::uint8_t class_of(double density) const;

 private:
  bool has(std::optional<Curve> LimitTable::*column) const;
};

/// Limits of one link, mm per mm of rest length.
struct LinkLimits {
  double min_length, max_length, shear1, shear2;
};
inline LinkLimits mean_of(const LinkLimits& a, const LinkLimits& b) {
  return {(a.min_length + b.min_length) / 2, (a.max_length + b.max_length) / 2,
          (a.shear1 + b.shear1) / 2, (a.shear2 + b.shear2) / 2};
}

/// Resistance of one link; see the curves of LimitTable.
struct LinkPhysics {
  double stiffness_kpa;
  double rayleigh_beta_ms;
  double yield_strain;  // infinity: elastic however far
};

/// The shares of tables in the 256 classes. Without labels the common table has them all. With
/// labels, a table whose limits are constant takes one class and the others share the rest equally,
/// the common table first, then by ascending label.
class MaterialClasses {
 public:
  /// The material must outlive this. Throws InputError when there are too many tables: every one
  /// needs a class, two if its limits vary.
  explicit MaterialClasses(const MaterialTable& material);

  /// first + round((count - 1) * (clamp(v) - domain_lo) / (domain_hi - domain_lo)) with the classes
  /// and the domain of the label's table, or of the common one; NaN counts as domain_lo.
  std::uint8_t class_of(double density, std::int32_t label = 0) const;

  /// Limits of a link along grid axis `axis`: the curves at domain_lo + (a + b)/510 of the domain,
  /// or the mean of both ends' curves (combines_limits). shear1 bounds the lower-numbered
  /// transverse grid axis, shear2 the other. Classes of no table count as the last one.
  LinkLimits limits(int axis, int class_a, int class_b) const;
  /// Calls visit(a, b, limits(axis, a, b)) for all pairs of classes. Where only the sum of the
  /// classes counts (not combines_limits), a is 0 or kLastClass, which reach all 511 sums.
  template <class Visit>
  void for_each_pair(int axis, Visit&& visit) const;

  /// The same of a link's physical curves. A table without the curve counts as
  /// kDefaultStiffnessKpa, undamped, and elastic without end: under combines_limits a link yields
  /// only if both ends do.
  LinkPhysics physics(int class_a, int class_b) const;

  /// Density, kg/m³, of an element of this class; kDefaultMassDensity where its table has none.
  double mass_density_of_class(int of) const;
  /// Poisson's ratio of an element of this class; kDefaultPoisson where its table has no curve.
  double poisson_of_class(int of) const;

  struct Share {
    std::int32_t label;  // 0: the common table
    const LimitTable* table;
    int first, count;  // classes
  };
  const std::vector<Share>& shares() const { return m_shares; }

 private:
  struct TablePosition {
    const LimitTable* table;
    double position;  // in its domain, 0…1
  };
  TablePosition position_of(int end) const;
  double value_of_class(int of, std::optional<Curve> LimitTable::*column, double without) const;

  bool m_combines_limits;
  std::vector<Share> m_shares;  // ascending classes
  std::vector<std::int16_t>
      m_of_label;  // index into m_shares, up to the largest label with a table
};

template <class Visit>
void MaterialClasses::for_each_pair(int axis, Visit&& visit) const {
  std::vector<LinkLimits> alike;  // of links between two elements of one class
  for (int n = 0; m_combines_limits && n <= kLastClass; ++n) alike.push_back(limits(axis, n, n));
  for (int a = 0; a <= kLastClass; a += m_combines_limits ? 1 : kLastClass) {
    for (int b = 0; b <= kLastClass; ++b) {
      visit(a, b, m_combines_limits ? mean_of(alike[a], alike[b]) : limits(axis, a, b));
    }
  }
}

/// The limits of MaterialClasses::limits, for a few links.
LinkLimits limits_of(const MaterialTable& table, int axis, int class_a, int class_b);

// Directions of the links of a voxel: steps d in {-1, 0, 1}^3 along the grid axes, numbered 9 (d_i
// + 1) + 3 (d_j + 1) + d_k + 1. Opposite directions add up to 26; 13 is no step, and directions
// above 13 lead to the later voxel in the order of slots.
constexpr int kDirections = 27, kNoStep = 13;
using LinkStep = std::array<int, 3>;

constexpr LinkStep step_of_direction(int direction) {
  return {direction / 9 - 1, direction / 3 % 3 - 1, direction % 3 - 1};
}
constexpr int direction_of_step(int i, int j, int k) {
  return 9 * (i + 1) + 3 * (j + 1) + k + 1;
}
constexpr int opposite_direction(int direction) {
  return kDirections - 1 - direction;
}
constexpr int direction_along(int axis, bool positive) {
  return kNoStep + (positive ? 1 : -1) * (axis == 0 ? 9 : axis == 1 ? 3 : 1);
}

/// Axes along which a direction steps: 1 for axes, 2 for diagonals of faces, 3 for those of cells.
constexpr int axes_of_direction(int direction) {
  return (direction / 9 != 1) + (direction / 3 % 3 != 1) + (direction % 3 != 1);
}
/// The first axis along which a direction steps.
constexpr int axis_of_direction(int direction) {
  return direction / 9 != 1 ? 0 : direction / 3 % 3 != 1 ? 1 : 2;
}
constexpr bool is_diagonal(int direction) {
  return axes_of_direction(direction) > 1;
}
/// True where a body of 6, 18 or 26 links per voxel has links of that direction.
constexpr bool has_direction(int links, int direction) {
  const int axes = axes_of_direction(direction);
  return axes >= 1 && axes <= (links == 6 ? 1 : links == 18 ? 2 : 3);
}

/// Integer slack of a link a -> b in the positive direction of `axis`, per coordinate c:
///   q_b[c] - q_a[c] <= upper[c]   and   q_a[c] - q_b[c] <= lower[c],
/// in 2^-16 voxel of the coordinate's own axis, rounded down, clamped to [0, kUnlimitedSlack].
struct LinkSlack {
  std::array<std::int32_t, 3> upper, lower;
};

/// A slack this large is no limit at all.
constexpr std::int32_t kUnlimitedSlack = 1 << 30;

/// A slack in units of 2^-16 of its length's unit, rounded down, within [0, kUnlimitedSlack]. A
/// value within 1e-6 of the next unit counts as that unit, so that 1.25 interpolated as
/// 1.2499999999999998 gives the slack of 1.25 on every machine.
std::int32_t fixed_slack(double length);

/// All slacks by look-up from the classes of both ends. 36 kB; 4.7 MB where limits are combined.
/// Diagonals take as much again for every 6 of their 12 (18 links) or 20 directions (26).
///
/// The slack of a diagonal is the quadrature of those of its axes, in integers, rounded down:
///   fall_d(c)^2 = sum over axes a with d_a != 0 of fall_{d_a}(c)^2,
/// so that the limits of all links touch one ellipsoid (docs/models/ecm.md, "Diagonal links").
class SlackTable {
 public:
  SlackTable() = default;
  /// Slacks along the own axis: upper = max_length - 1, lower = 1 - min_length. Transverse: shear *
  /// h_axis mm is that many voxels of the coordinate's own axis, both ways.
  SlackTable(const MaterialTable& table, const Vec3d& spacing_mm);

  LinkSlack slack(int axis, std::uint8_t class_a, std::uint8_t class_b) const;
  /// slack(...).upper[coordinate] / .lower[coordinate] without building the struct.
  std::int32_t upper(int axis, int coordinate, std::uint8_t class_a, std::uint8_t class_b) const {
    return upper_row(axis, coordinate)[class_a * m_stride + class_b];
  }
  std::int32_t lower(int axis, int coordinate, std::uint8_t class_a, std::uint8_t class_b) const {
    return lower_row(axis, coordinate)[class_a * m_stride + class_b];
  }

  /// Entry class_a * stride() + class_b of a row is one link's slack; symmetric in the classes.
  const std::int32_t* upper_row(int axis, int coordinate) const {
    return m_upper.data() + std::size_t(3 * axis + coordinate) * m_row_size;
  }
  const std::int32_t* lower_row(int axis, int coordinate) const {
    return m_lower.data() + std::size_t(3 * axis + coordinate) * m_row_size;
  }
  /// The same for a link of any direction from voxel i to j: q_i[c] - q_j[c] <= fall. A fall
  /// against the direction is one along the opposite direction. Diagonals exist as far as links()
  /// says.
  const std::int32_t* fall_row(int direction, int coordinate) const;
  std::int32_t fall(int direction, int coordinate, std::uint8_t class_a,
                    std::uint8_t class_b) const {
    return fall_row(direction, coordinate)[class_a * m_stride + class_b];
  }
  /// Links per voxel: 6, 18 or 26.
  int links() const { return m_links; }
  int stride() const { return m_stride; }
  std::size_t bytes() const;

 private:
  void add_diagonals();

  // density: rows of 511, one per sum of classes; limits: rows of 256 * 256.
  int m_stride = 1;
  std::size_t m_row_size = 0;
  std::vector<std::int32_t> m_upper, m_lower;
  int m_links = 6;
  std::array<std::int8_t, kDirections> m_diagonal_of{};  // place of its rows in m_diagonals
  std::vector<std::int32_t> m_diagonals;                 // 3 rows per direction
};

// Material tables as TOML (design.md section 2).

/// Reads a material file; throws InputError naming the key point. `names` are those of a
/// segmentation's labels (label_names of volumes/io/load/label_file.h); tables of labels may use
/// them.
MaterialTable read_material(const std::string& path, const LabelNames& names = {});
/// Parses a table from text, e.g. the one that a state carries; `source` names it in errors.
MaterialTable parse_material(const std::string& text, const std::string& source);
/// The material of a tissue preset as if a table named it.
MaterialTable preset_material(const std::string& preset);
/// Reads the keys of a material out of a table (a file's root or a scene's [material]); a preset
/// stands for the keys that are not given.
MaterialTable read_material_table(Table& table, const LabelNames& names = {});

/// Canonical text: parse_material(material_to_toml(m)) equals m.
std::string material_to_toml(const MaterialTable& material);

/// For a volume without a table: every voxel above `min` is tissue of one kind.
MaterialTable homogeneous_material(double min, double max);

}  // namespace supple
