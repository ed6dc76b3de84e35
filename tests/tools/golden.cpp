#include "tests/tools/golden.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <gtest/gtest.h>

namespace supple::test {

std::string golden_path(const std::string& name) {
  return source_dir() + "/tests/golden/" + name;
}

Image golden_reference(const std::string& name) {
  return read_png(golden_path("reference/" + name));
}

GoldenFolder::GoldenFolder() {
  for (const auto& entry : std::filesystem::directory_iterator(golden_path(""))) {
    if (!entry.is_regular_file()) continue;
    std::filesystem::copy_file(entry.path(), m_folder / entry.path().filename().string());
  }
  for (const char* file : {"small-head.nhdr", "t-shape.png"}) make(file);
}

void GoldenFolder::make(const std::string& file) const {
  const std::filesystem::path bin =
      std::filesystem::path(std::getenv("SUPPLE_BINARY")).parent_path();
  const std::string examples = (bin / "supple-examples").string();
  const std::string kind = std::filesystem::path(file).stem().string();
  EXPECT_EQ(run_program({examples, "phantom", kind, m_folder / file}).exit_code, 0);
}

void GoldenFolder::run(const std::string& name, const std::string& after, int threads) const {
  if (!after.empty()) run(after, "", threads);
  const Outcome outcome = run_supple({"run", m_folder / (name + ".toml"), "-o", m_folder.path(),
                                      "--threads", std::to_string(threads), "--quiet", "--force"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

void GoldenFolder::link(const std::string& path) const {
  std::filesystem::create_symlink(path, m_folder / std::filesystem::path(path).filename().string());
}

std::vector<std::string> GoldenFolder::pictures() const {
  std::vector<std::string> names;
  for (const std::string& name : m_folder.entries()) {
    const std::string extension = std::filesystem::path(name).extension().string();
    if (extension == ".png" || extension == ".exr") names.push_back(name);
  }
  return names;
}

void expect_golden(const GoldenFolder& folder, const std::string& name) {
  const std::string image = folder / name;
  const std::string reference = golden_path("reference/" + name);
  const Outcome outcome = run_supple(
      {"compare", image, reference, "--max-rmse", std::to_string(kMaxRmse), "--min-ssim",
       std::to_string(kMinSsim), "--max-diff", std::to_string(kMaxDiff), "--mask", "foreground"});
  if (outcome.exit_code == 0) return;
  const std::string stem = std::filesystem::path(name).stem().string();
  std::filesystem::copy_file(image, output_path("golden/" + stem + "_image.png"),
                             std::filesystem::copy_options::overwrite_existing);
  std::filesystem::copy_file(reference, output_path("golden/" + stem + "_reference.png"),
                             std::filesystem::copy_options::overwrite_existing);
  run_supple({"compare", image, reference, "--diff",
              output_path("golden/" + stem + "_difference.png"), "--force"});
  ADD_FAILURE() << name << ": " << outcome.out << outcome.err << "kept in "
                << output_path("golden/");
}

FloatImage read_exr(const std::string& path) {
  Imf::InputFile file(path.c_str());
  const Imath::Box2i window = file.header().dataWindow();
  FloatImage picture(window.max.x + 1, window.max.y + 1, true);
  const auto add = [&](Imf::FrameBuffer& buffer, const char* name, float* first, int stride) {
    EXPECT_NE(file.header().channels().findChannel(name), nullptr) << name;
    buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(first), 4 * stride,
                                   4 * stride * picture.width));
  };
  Imf::FrameBuffer buffer;
  const char* colours[] = {"R", "G", "B", "A"};
  for (int c = 0; c < 4; ++c) add(buffer, colours[c], &picture.rgba[c], 4);
  const char* axes[] = {"N.X", "N.Y", "N.Z"};
  for (int c = 0; c < 3; ++c) add(buffer, axes[c], &picture.normal_lps[c], 3);
  add(buffer, "Z", picture.depth_mm.data(), 1);
  add(buffer, "offset", picture.offset_mm.data(), 1);
  file.setFrameBuffer(buffer);
  file.readPixels(0, picture.height - 1);

  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
    const float alpha = picture.rgba[4 * n + 3];
    for (int c = 0; c < 3 && alpha > 0; ++c) {
      float& value = picture.rgba[4 * n + c];
      value = srgb_from_linear(value / alpha) * alpha;
    }
    if (std::isfinite(picture.depth_mm[n])) continue;
    picture.depth_mm[n] = picture.offset_mm[n] = kNone;
    for (int c = 0; c < 3; ++c) picture.normal_lps[3 * n + c] = kNone;
  }
  return picture;
}

}  // namespace supple::test
