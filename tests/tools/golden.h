// Shared parts of the golden-image tests: the scenes of tests/golden, run as a user runs them, and
// the comparison of their pictures with the committed references.
#pragma once

#include <string>
#include <vector>

#include "raycast/pictures/image.h"
#include "tests/support/program.h"

namespace supple::test {

/// Limits of a comparison on the foreground. The pictures are the same to the bit on one machine;
/// another set of vector instructions may round differently.
constexpr double kMaxRmse = 1e-3;
constexpr double kMinSsim = 0.999;
constexpr double kMaxDiff = 0.1;

/// tests/golden/NAME.
std::string golden_path(const std::string& name);
/// The committed reference of that name.
Image golden_reference(const std::string& name);

/// Runs scenes in a folder of its own that also holds what they read.
class GoldenFolder {
 public:
  GoldenFolder();
  /// Writes a generated volume beside the scenes, NAME.nhdr or .png (`supple-examples`).
  void make(const std::string& file) const;
  /// Runs NAME.toml, after the scene whose state it continues where `after` names one. `threads`:
  /// 0 for all.
  void run(const std::string& name, const std::string& after = "", int threads = 0) const;
  /// Lays a file beside the scenes.
  void link(const std::string& path) const;
  std::string operator/(const std::string& name) const { return m_folder / name; }
  std::vector<std::string> pictures() const;

 private:
  TemporaryFolder m_folder;
};

/// Compares a picture. On failure the image, the reference and their difference are kept under the
/// build folder's test-output/golden.
void expect_golden(const GoldenFolder& folder, const std::string& name);

/// All channels that write_exr() writes.
FloatImage read_exr(const std::string& path);

}  // namespace supple::test
