// Extensions of NIfTI headers, two affines that disagree, pairs whose magic and name differ.

#include <limits>
#include <random>

#include "tests/volumes/io/nifti_fixtures.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/warp_file.h"

namespace supple::test {
namespace {

TEST(UnitNiftiExtension, OurCommentSaysDirectionAndCertificateAndOthersArePassedOver) {
  const TemporaryFolder folder;
  const std::string comment =
      "supple direction: material\nsupple certificate: {\"folded\":0}\nand more\n";
  const std::string bytes =
      with_extensions(warp_header(1007), nifti_extension_of(2, "supple direction: resample\n") +
                                             nifti_extension_of(6, comment) +
                                             nifti_extension_of(4, "<xml/>")) +
      bytes_of_values(counted<float>(36));
  for (const std::string& path :
       {folder.write("a.nii", bytes), folder.write("a.nii.gz", gzip(bytes))}) {
    const auto file = open_scalars_or_vectors(path);
    EXPECT_EQ(file->header().warp_direction, "material");
    EXPECT_EQ(file->header().certificate, "{\"folded\":0}");
    EXPECT_TRUE(file->header().warnings.empty());
    EXPECT_EQ(read_warp(path).vectors[1], Vec3f(1, 13, 25));
  }
}

TEST(FaultNifti, ADamagedExtensionIsAWarningAndTheValuesStay) {
  const TemporaryFolder folder;
  const std::string sound = nifti_extension_of(6, "supple direction: material\n");
  for (const std::int32_t size : {0, -16, 7, 64, std::numeric_limits<std::int32_t>::max()}) {
    std::string damaged = nifti_extension_of(6, "supple direction: resample\n");
    patch(damaged, 0, size);
    const auto path = folder.write("a.nii", with_extensions(warp_header(1007), sound + damaged) +
                                                bytes_of_values(counted<float>(36)));
    const auto file = open_scalars_or_vectors(path);
    EXPECT_EQ(file->header().warp_direction, "material") << size;
    ASSERT_EQ(file->header().warnings.size(), 1u) << size;
    EXPECT_EQ(file->header().warnings[0],
              "damaged header extension at byte 400; it and those behind it are left out");
    EXPECT_EQ(read_warp(path).vectors[1], Vec3f(1, 13, 25));
  }
}

TEST(UnitNiftiExtension, OneOfSeveralMegabytesIsPassedOver) {
  const TemporaryFolder folder;
  const std::string large = nifti_extension_of(2, std::string(3 << 20, 'x'));
  const auto path = folder.write(
      "a.nii", with_extensions(warp_header(1007), large) + bytes_of_values(counted<float>(36)));
  const auto file = open_scalars_or_vectors(path);
  EXPECT_TRUE(file->header().warnings.empty());
  EXPECT_EQ(read_warp(path).vectors[1], Vec3f(1, 13, 25));
}

/// sform of 1 mm, and a qform shifted by `shift` mm along x.
std::string with_both_forms(double shift) {
  std::string header = nifti_header({3, 2, 2});
  patch(header, 76, 1.0f);
  patch(header, 252, std::int16_t(1));
  patch(header, 254, std::int16_t(1));
  patch(header, 268, float(shift));
  for (int a = 0; a < 3; ++a) patch(header, std::size_t(280 + 20 * a), 1.0f);
  return header;
}

TEST(UnitNiftiForms, SformAndQformThatDisagreeAreAWarning) {
  const TemporaryFolder folder;
  const std::string data = bytes_of_values(counted<std::int16_t>(12));
  const auto warnings = [&](const std::string& header) {
    return open_volume(folder.write("a.nii", header + data))->header().warnings;
  };
  EXPECT_TRUE(warnings(with_both_forms(0.04)).empty());
  const std::vector<std::string> expected = {
      "sform and qform disagree by 0.06 voxels; sform is used"};
  EXPECT_EQ(warnings(with_both_forms(0.06)), expected);
  std::string unset = with_both_forms(5);
  patch(unset, 252, std::int16_t(0));
  EXPECT_TRUE(warnings(unset).empty());

  std::string scaled = with_both_forms(0);
  patch(scaled, 84, 2.0f);  // of the qform alone; the far corner is one voxel off
  EXPECT_EQ(warnings(scaled),
            std::vector<std::string>{"sform and qform disagree by 1 voxels; sform is used"});
  std::string broken = with_both_forms(0);
  patch(broken, 84, 0.0f);
  EXPECT_EQ(warnings(broken), std::vector<std::string>{"the qform is no grid; sform is used"});
}

TEST(UnitNiftiPair, TheContentDecidesWhereMagicAndNameDiffer) {
  const TemporaryFolder folder;
  const std::string data = bytes_of_values(counted<std::int16_t>(12));
  const std::string single = nifti_header({3, 2, 2});
  std::string pair = single;
  std::memcpy(pair.data() + 344, "ni1", 4);

  folder.write("a.img", data);
  for (const std::string& header : {single, single.substr(0, 348), pair.substr(0, 348)}) {
    std::string start = header;
    if (header[345] == 'i') patch(start, kOffset, 0.0f);
    EXPECT_EQ(values_of<std::int16_t>(folder.write("a.hdr", start)), counted<std::int16_t>(12));
  }
  EXPECT_EQ(values_of<std::int16_t>(folder.write("b.hdr", single + data)),
            counted<std::int16_t>(12));
  EXPECT_EQ(values_of<std::int16_t>(folder.write("c.nii", pair + data)), counted<std::int16_t>(12));
  patch(pair, kOffset, 0.0f);
  expect_refused(folder.write("d.nii", pair + data), {"d.nii", "magic", ".img"});
}

TEST(FaultNifti, MutatedSeriesAndVectorsReadOrThrowInputError) {
  const TemporaryFolder folder;
  const std::string note = nifti_extension_of(6, "supple direction: resample\n");
  const std::string data = bytes_of_values(counted<float>(36));
  const std::string seeds[] = {
      with_extensions(warp_header(1007), note + note) + data,
      with_extensions(nifti_header_of({3, 2, 2, 3}, 16, 32), note) + data,
      with_extensions(nifti_header_of({3, 2, 2, 4}, 128, 24), note) + data,
  };
  std::mt19937 random(20260);
  int read = 0, refused = 0;
  for (int round = 0; round < 900; ++round) {
    std::string bytes = seeds[round % 3];
    for (int change = 0; change < 3; ++change) bytes[random() % 420] = char(random());
    const std::string path = folder.write("a.nii", round % 2 == 0 ? bytes : gzip(bytes));
    const std::string line = nifti_failure(path, round % 3 == 0 ? ReadOptions{} : frame(1));
    (line.empty() ? read : refused) += 1;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace supple::test
