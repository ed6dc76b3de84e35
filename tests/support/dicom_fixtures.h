// DICOM files for the reader's tests, written by DCMTK.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <dcmtk/config/osconfig.h>
// DCMTK wants osconfig.h first.
#include <dcmtk/dcmdata/dctk.h>

#include "tests/support/io_fixtures.h"

namespace supple::test {

/// A synthetic series whose geometry is an affine, like a volume's. File names are shuffled and
/// instance numbers run against the positions.
struct SeriesFixture {
  Vec3i dims = {5, 4, 6};
  Vec3d origin = {-12.5, 30, -70};
  Vec3d row = {1, 0, 0}, column = {0, 1, 0};                 // unit vectors of i and j
  double column_mm = 0.5, row_mm = 0.75;                     // steps of i and j
  Vec3d step = {0, 0, 2};                                    // of k
  int bits_allocated = 16, bits_stored = 16, high_bit = -1;  // -1: bits_stored - 1
  bool is_signed = true;
  bool bytes_in_words = false;  // 8-bit pixels as OW, two in a 16-bit word
  E_TransferSyntax syntax = EXS_LittleEndianExplicit;
  std::string series = "1.2.826.0.1.3680043.8.498.1";
  /// The stored value; its low bits are written.
  std::function<int(int i, int j, int k)> value = default_value;
  /// Changes the attributes of slice k before it is written.
  std::function<void(DcmDataset& data, int k)> edit;

  static int default_value(int i, int j, int k) { return 100 * k + 10 * j + i - 250; }
  Geometry geometry() const;
  std::string file_name(int k) const;  // no extension, against the order of slices
  /// The attributes of slice k, its pixels too.
  void fill(DcmDataset& data, int k) const;
  /// Writes slice k and returns its path.
  std::string write(const TemporaryFolder& folder, int k, const std::string& name = "") const;
  void write_all(const TemporaryFolder& folder) const;
};

/// An enhanced image of dims.z frames in one file, in the order `frames` gives (of k).
void write_enhanced(const std::string& path, const SeriesFixture& series,
                    const std::vector<int>& frames, bool shared_orientation = true);

/// Writes with the fixture's own transfer syntax.
void save(DcmFileFormat& file, const std::string& path, E_TransferSyntax syntax);

void put(DcmItem& item, const DcmTagKey& tag, const std::string& value);
std::string ds(const std::vector<double>& numbers);  // separated by backslashes

/// All values, i fastest, as numbers after slope and intercept.
std::vector<double> values_of(VolumeFile& file);
/// The values that values_of() must find in `series` with this rescale.
std::vector<double> expected_values(const SeriesFixture& series, double slope = 1,
                                    double intercept = 0);
void expect_geometry(const Geometry& found, const Geometry& expected, double tolerance = 1e-6);

}  // namespace supple::test
