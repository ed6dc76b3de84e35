#include <algorithm>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple::test;

namespace {

/// One line on stderr that holds every one of `words`, the exit code, and nothing new in the
/// folder.
void expect_refused(const TemporaryFolder& folder, const std::vector<std::string>& arguments,
                    int exit_code, const std::vector<std::string>& words) {
  const auto before = folder.entries();
  const Outcome outcome = run_supple(arguments);
  EXPECT_EQ(outcome.exit_code, exit_code) << ::testing::PrintToString(arguments) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  for (const std::string& word : words) {
    EXPECT_NE(outcome.err.find(word), std::string::npos)
        << "expected '" << word << "' in: " << outcome.err;
  }
  EXPECT_EQ(folder.entries(), before) << ::testing::PrintToString(arguments);
}

std::string header(const std::string& sizes, const std::string& type = "uint8",
                   const std::string& directions = "(1,0,0) (0,1,0) (0,0,1)") {
  return "NRRD0004\ntype: " + type +
         "\ndimension: 3\nspace: left-posterior-superior\nsizes: " + sizes +
         "\nspace directions: " + directions +
         "\nspace origin: (0,0,0)\nendian: little\nencoding: raw\ndata file: data.raw\n";
}

class FaultBadInput : public ::testing::Test {
 protected:
  void SetUp() override {
    write_ball(m_folder, "ball", 16);
    write_soft_material(m_folder / "soft.toml");
    write_text(m_folder / "data.raw", std::string(64, 'x'));
  }

  void expect_header_refused(const std::string& text, const std::vector<std::string>& words) {
    write_text(m_folder / "bad.nhdr", text);
    expect_refused(m_folder, {"info", m_folder / "bad.nhdr"}, 3, words);
  }

  std::vector<std::string> deform(const std::string& volume, const std::string& grab,
                                  const std::string& by = "2,0,0") const {
    return {"deform",     m_folder / volume,
            "--material", m_folder / "soft.toml",
            "--grab",     grab,
            "--by",       by,
            "-o",         m_folder / "out.vdb"};
  }

  TemporaryFolder m_folder;
};

}  // namespace

TEST_F(FaultBadInput, FilesThatAreNotVolumesAreRefused) {
  RUN_WHEN_SANITIZED();
  expect_refused(m_folder, {"info", m_folder / "nothing.nhdr"}, 3,
                 {"nothing.nhdr", "no such file"});
  expect_refused(m_folder, {"info", m_folder.path()}, 3, {"directory"});
  write_text(m_folder / "empty.nhdr", "");
  expect_refused(m_folder, {"info", m_folder / "empty.nhdr"}, 3, {"empty.nhdr"});
  write_text(m_folder / "noise.dat", "what is this");
  expect_refused(m_folder, {"info", m_folder / "noise.dat"}, 3, {"noise.dat"});
}

TEST_F(FaultBadInput, HeadersThatContradictTheirDataAreRefusedWithBothNumbers) {
  RUN_WHEN_SANITIZED();
  expect_header_refused(header("4 4 5"), {"data.raw", "64", "80"});
  expect_header_refused(header("4 4 3"), {"data.raw", "64", "48"});
  expect_header_refused(header("0 4 4"), {"bad.nhdr", "sizes", "0 4 4"});
  expect_header_refused(header("-4 4 4"), {"-4"});
  expect_header_refused(header("4000000000 4000000000 4000000000"), {"4000000000"});
  expect_header_refused(header("9000 9000 9000"), {"64", "729000000000"});
  expect_header_refused(header("4 4"), {"sizes"});
}

TEST_F(FaultBadInput, HeadersWithUnusableGeometryOrTypeAreRefused) {
  RUN_WHEN_SANITIZED();
  expect_header_refused(header("4 4 4", "uint8", "(nan,0,0) (0,1,0) (0,0,1)"), {"bad.nhdr"});
  expect_header_refused(header("4 4 4", "uint8", "(1,0,0) (1,0,0) (0,0,1)"), {"direction"});
  expect_header_refused(header("4 4 4", "complex"), {"type", "complex"});
}

TEST_F(FaultBadInput, RawSpecificationsAreChecked) {
  RUN_WHEN_SANITIZED();
  const std::string raw = m_folder / "data.raw";
  const std::string good = "dims=4,4,4,type=uint8,spacing=1,1,1";
  EXPECT_EQ(run_supple({"info", raw, "--raw", good}).exit_code, 0);
  expect_refused(m_folder, {"info", raw, "--raw", "dims=4,4,5,type=uint8,spacing=1,1,1"}, 3,
                 {"64", "80"});
  expect_refused(m_folder, {"info", raw, "--raw", "dims=4,4,4,type=short8,spacing=1,1,1"}, 3,
                 {"short8"});
  expect_refused(m_folder, {"info", raw, "--raw", "dims=4,4,4,type=uint8,spacing=1,nan,1"}, 3, {});
  expect_refused(m_folder, {"info", raw, "--raw", good + ",colour=red"}, 3, {"colour"});
}

TEST_F(FaultBadInput, NotANumberIsVoidAndSaid) {
  RUN_WHEN_SANITIZED();
  std::string voxels;
  for (int n = 0; n < 64; ++n) {
    const float value = n == 7 ? std::numeric_limits<float>::quiet_NaN() : float(n);
    voxels.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  write_text(m_folder / "data.raw", voxels);
  write_text(m_folder / "nan.nhdr", header("4 4 4", "float"));
  const Outcome info = run_supple({"info", m_folder / "nan.nhdr"});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  EXPECT_NE(info.err.find("1 NaN voxel"), std::string::npos) << info.err;
  // Voxel 7 is (3, 1, 0).
  expect_refused(m_folder,
                 {"deform", m_folder / "nan.nhdr", "--quiet", "--material", m_folder / "soft.toml",
                  "--grab", "3,1,0", "--by", "1,0,0", "-o", m_folder / "out.vdb"},
                 3, {"3", "nearest"});
}

TEST_F(FaultBadInput, GrabsThatHoldNothingNameTheNearestElement) {
  RUN_WHEN_SANITIZED();
  expect_refused(m_folder, deform("ball.nhdr", "0,8,8"), 3, {"0", "nearest"});
  expect_refused(m_folder, deform("ball.nhdr", "99,8,8"), 3, {"99"});
  expect_refused(m_folder, deform("ball.nhdr", "-1,8,8"), 3, {"-1"});
  expect_refused(m_folder, deform("ball.nhdr", "8,8,8", "nan,0,0"), 3, {"nan"});
  expect_refused(m_folder, deform("ball.nhdr", "8,8,8", "1e9,0,0"), 3, {"16383"});
}

TEST_F(FaultBadInput, FixesThatHoldNothingOrTheGrabAreRefused) {
  RUN_WHEN_SANITIZED();
  auto arguments = deform("ball.nhdr", "8,8,8");
  arguments.insert(arguments.end(), {"--fix", "0,0,0:1,1,1"});
  expect_refused(m_folder, arguments, 3, {"fix"});
  arguments.back() = "7,7,7:9,9,9";
  expect_refused(m_folder, arguments, 3, {"8"});
}

TEST_F(FaultBadInput, ContradictingHandlesAreNamedWithTheMissingDistance) {
  RUN_WHEN_SANITIZED();
  auto arguments = deform("ball.nhdr", "7,8,8", "-20,0,0");
  arguments.insert(arguments.end(), {"--grab", "9,8,8", "--by", "20,0,0"});
  expect_refused(m_folder, arguments, 3, {"7,8,8", "9,8,8", "mm"});
}

TEST_F(FaultBadInput, TablesOutOfOrderNameTheKeyPoint) {
  RUN_WHEN_SANITIZED();
  write_text(m_folder / "soft.toml",
             "domain = [0, 255]\nmax_length = [[100, 1.3], [50, 1.2]]\nmin_length = [[0, 0.7]]\n"
             "shear = [[0, 0.3]]\n");
  expect_refused(m_folder, deform("ball.nhdr", "8,8,8"), 3, {"soft.toml", "max_length", "50"});
  write_text(m_folder / "soft.toml",
             "domain = [0, 255]\nmax_length = [[0, 0.9]]\nmin_length = [[0, 0.7]]\n"
             "shear = [[0, 0.3]]\n");
  expect_refused(m_folder, deform("ball.nhdr", "8,8,8"), 3, {"max_length", "0.9"});
  write_text(m_folder / "soft.toml",
             "domain = [0, 255]\nmax_length = [[0, 1.3]]\nmin_length = [[0, 0.7]]\n"
             "sheer = [[0, 0.3]]\n");
  expect_refused(m_folder, deform("ball.nhdr", "8,8,8"), 3, {"shear"});
}

TEST_F(FaultBadInput, DamagedStatesAreRefused) {
  RUN_WHEN_SANITIZED();
  ASSERT_EQ(run_supple(deform("ball.nhdr", "8,8,8")).exit_code, 0);
  const std::string state = read_text(m_folder / "out.vdb");
  write_text(m_folder / "cut.vdb", state.substr(0, state.size() / 2));
  expect_refused(m_folder, {"render", m_folder / "cut.vdb", "-o", m_folder / "x.png"}, 3,
                 {"cut.vdb"});
  std::string flipped = state;
  flipped[flipped.size() / 2] = char(flipped[flipped.size() / 2] ^ 0x10);
  write_text(m_folder / "flipped.vdb", flipped);
  expect_refused(m_folder, {"export", m_folder / "flipped.vdb", "-o", m_folder / "x.nrrd"}, 3,
                 {"flipped.vdb"});
}

TEST_F(FaultBadInput, UnusableOutputsAreRefusedBeforeTheWork) {
  RUN_WHEN_SANITIZED();
  auto arguments = deform("ball.nhdr", "8,8,8");
  arguments.back() = m_folder / "no_such_folder/out.vdb";
  expect_refused(m_folder, arguments, 3, {"no such folder"});
  ASSERT_EQ(run_supple(deform("ball.nhdr", "8,8,8")).exit_code, 0);
  expect_refused(m_folder, {"export", m_folder / "out.vdb", "-o", m_folder / "warp.xyz"}, 3,
                 {"warp.xyz", ".nrrd"});
}

TEST_F(FaultBadInput, OutputsThatAreNoPlainFilesOrInputsAreRefusedEvenWithForce) {
  RUN_WHEN_SANITIZED();
  ASSERT_EQ(run_supple(deform("ball.nhdr", "8,8,8")).exit_code, 0);
  ASSERT_EQ(::mkfifo((m_folder / "pipe.png").c_str(), 0600), 0);
  expect_refused(m_folder, {"render", m_folder / "out.vdb", "-o", m_folder / "pipe.png", "--force"},
                 3, {"pipe.png", "plain file"});
  auto arguments = deform("ball.nhdr", "8,8,8");
  arguments.back() = m_folder / "ball.nhdr";
  arguments.push_back("--force");
  const std::string header = read_text(m_folder / "ball.nhdr");
  expect_refused(m_folder, arguments, 3, {"ball.nhdr", "name of an input"});
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"ball.nhdr\"\n[output]\nvolumes = [\"ball.mhd\"]\n");
  expect_refused(m_folder, {"run", m_folder / "scene.toml", "-o", m_folder.path(), "--force"}, 3,
                 {"ball.raw", "input"});
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"ball.nhdr\"\n[output]\nvolumes = [\"a.nhdr\", \"./a.mhd\"]\n");
  expect_refused(m_folder, {"run", m_folder / "scene.toml", "-o", m_folder.path()}, 3,
                 {"a.raw", "another output"});
  EXPECT_EQ(read_text(m_folder / "ball.nhdr"), header);
}

TEST_F(FaultBadInput, NumbersOutOfRangeAreRefused) {
  RUN_WHEN_SANITIZED();
  ASSERT_EQ(run_supple(deform("ball.nhdr", "8,8,8")).exit_code, 0);
  const std::string state = m_folder / "out.vdb", image = m_folder / "x.png";
  for (const char* step : {"0", "-1", "1e-9", "nan", "inf"}) {
    expect_refused(m_folder, {"render", state, "--step", step, "-o", image}, 3, {"step", "0.01"});
  }
  expect_refused(m_folder, {"render", state, "--size", "0,5", "-o", image}, 3, {"--size"});
  for (const char* margin : {"nan", "-3", "1e300"}) {
    expect_refused(m_folder, {"export", state, "--margin", margin, "-o", m_folder / "x.nrrd"}, 3,
                   {"--margin"});
  }
  expect_refused(m_folder, {"compare", image, image, "--max-rmse", "nan"}, 3, {"--max-rmse"});
}

TEST_F(FaultBadInput, ASceneThatFailsInALaterStepLeavesNothingBehind) {
  RUN_WHEN_SANITIZED();
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"ball.nhdr\"\n[material]\ntable = \"soft.toml\"\n"
             "[[step]]\ngrab = [8, 8, 8]\nby = [1.0, 0.0, 0.0]\n"
             "[[step]]\ngrab = [0, 8, 8]\nby = [1.0, 0.0, 0.0]\n"
             "[[view]]\nimage = \"first.png\"\nafter_step = 1\nsize = [32, 32]\n");
  expect_refused(m_folder, {"run", m_folder / "scene.toml", "-o", m_folder / "out"}, 3,
                 {"scene.toml:8", "nearest"});
}

TEST_F(FaultBadInput, AFullDiskLeavesNothingBehind) {
  RUN_WHEN_SANITIZED();
  const auto before = m_folder.entries();
  RunOptions small_disk;
  small_disk.max_file_bytes = 2000;
  const Outcome outcome = run_supple(deform("ball.nhdr", "8,8,8"), small_disk);
  EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
  EXPECT_EQ(m_folder.entries(), before);

  ASSERT_EQ(run_supple(deform("ball.nhdr", "8,8,8")).exit_code, 0);
  write_text(m_folder / "scene.toml",
             "[volume]\npath = \"out.vdb\"\n[output]\noffsets = [\"s.nrrd\"]\n");
  const auto with_state = m_folder.entries();
  const std::string state = m_folder / "out.vdb";
  const std::vector<std::vector<std::string>> commands = {
      {"export", state, "-o", m_folder / "x.nrrd"},
      {"export", state, "-o", m_folder / "x.mhd"},
      {"resample", state, "-o", m_folder / "x.mha"},
      {"render", state, "-o", m_folder / "x.png"},
      {"run", m_folder / "scene.toml", "-o", m_folder.path()}};
  for (const auto& command : commands) {
    EXPECT_EQ(run_supple(command, small_disk).exit_code, 4) << command[0];
    EXPECT_EQ(m_folder.entries(), with_state) << command[0];
  }
}

TEST_F(FaultBadInput, ReadOnlyFoldersAreASystemError) {
  RUN_WHEN_SANITIZED();
  // A copy of the program, since root's home may be closed to others.
  namespace fs = std::filesystem;
  const std::string program = m_folder / "supple";
  fs::copy_file(std::getenv("SUPPLE_BINARY"), program);
  const std::string closed = m_folder / "closed";
  fs::create_directory(closed);
  fs::permissions(m_folder.path(), fs::perms(0755));
  fs::permissions(closed, fs::perms(0555));
  std::vector<std::string> arguments = {program};
  const auto rest = deform("ball.nhdr", "8,8,8");
  arguments.insert(arguments.end(), rest.begin(), rest.end());
  arguments.back() = closed + "/out.vdb";
  RunOptions options;
  options.as_nobody = true;
  const Outcome outcome = run_program(arguments, options);
  if (outcome.exit_code >= 126) GTEST_SKIP() << "the program cannot run as another user here";
  EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
  EXPECT_TRUE(fs::is_empty(closed));
}
