// Files that pages upload: what is refused, what is left of them, and what of them is opened.
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "tools/viewer/dropped_files.h"
#include "volumes/base/error.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

namespace fs = std::filesystem;

int files_below(const std::string& folder) {
  int count = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    count += int(entry.is_regular_file());
  }
  return count;
}

void send(DroppedFiles& dropped, const std::string& target, const std::string& bytes) {
  const auto receiver = dropped.receiver_of(target, bytes.size());
  const std::size_t half = bytes.size() / 2;
  receiver->add(bytes.data(), half);
  receiver->add(bytes.data() + half, bytes.size() - half);
  receiver->finish();
}

template <class Do>
std::string why_not(const Do& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

template <class Do>
void expect_refused(const Do& action, const std::string& words) {
  const std::string why = why_not(action);
  EXPECT_NE(why.find(words), std::string::npos) << "'" << why << "' has no '" << words << "'";
}

}  // namespace

TEST(UnitDroppedFiles, TheyLieInAFolderOfTheirOwnUntilTheyAreForgotten) {
  auto dropped = std::make_shared<DroppedFiles>(1000);
  const int group = dropped->announce(1, {{"a.mhd", 4}, {"b.raw", 5}});
  const std::string target = std::to_string(group);
  expect_refused([&] { dropped->folder_of(group); }, "a.mhd");
  send(*dropped, target + "/1", "bytes");
  send(*dropped, target + "/0", "head");
  const std::string folder = dropped->folder_of(group), root = fs::path(folder).parent_path();
  EXPECT_EQ(read_text(folder + "/a.mhd") + read_text(folder + "/b.raw"), "headbytes");
  EXPECT_EQ(fs::status(root).permissions(), fs::perms::owner_all);
  EXPECT_EQ(file_to_open(folder), folder + "/a.mhd");
  const int other = dropped->announce(2, {{"c", 0}});
  send(*dropped, std::to_string(other) + "/0", "");
  EXPECT_EQ(dropped->folder_of(other), root + "/" + std::to_string(other));
  dropped->forget_page(1, group);
  EXPECT_EQ(files_below(root), 3);
  dropped->forget_page(1, other);
  EXPECT_EQ(files_below(root), 1);
  expect_refused([&] { dropped->folder_of(group); }, "that were announced");
  dropped.reset();
  EXPECT_FALSE(fs::exists(root));
}

TEST(UnitDroppedFiles, NothingIsLeftOfAFileThatDidNotComeWhole) {
  auto dropped = std::make_shared<DroppedFiles>(1000);
  const int group = dropped->announce(1, {{"a.vdb", 6}});
  const std::string target = std::to_string(group) + "/0";
  auto receiver = dropped->receiver_of(target, 6);
  receiver->add("half", 4);
  expect_refused([&] { dropped->receiver_of(target, 6); }, "once");
  receiver.reset();
  expect_refused([&] { dropped->folder_of(group); }, "a.vdb");
  send(*dropped, target, "again!");
  EXPECT_EQ(files_below(dropped->folder_of(group)), 1);
  // One that is on its way when everything ends takes its folder with it.
  const int last = dropped->announce(1, {{"b", 2}});
  receiver = dropped->receiver_of(std::to_string(last) + "/0", 2);
  const std::string root = fs::path(dropped->folder_of(group)).parent_path();
  dropped.reset();
  EXPECT_TRUE(fs::exists(root));
  receiver.reset();
  EXPECT_FALSE(fs::exists(root));
}

TEST(UnitDroppedFiles, NamesWithFoldersTooMuchAndWhatWasNotAnnouncedAreRefused) {
  const auto dropped = std::make_shared<DroppedFiles>(1000);
  for (const char* name : {"", ".", "..", ".hidden", "a/b", "../a", "a\\b", "a\nb", "\x7f"}) {
    expect_refused([&] { dropped->announce(1, {{name, 1}}); }, "no plain name");
  }
  expect_refused([&] { dropped->announce(1, {{std::string(201, 'a'), 1}}); }, "no plain name");
  expect_refused([&] { dropped->announce(1, {{"a", 1}, {"a", 1}}); }, "two files of this name");
  expect_refused([&] { dropped->announce(1, {}); }, "1 to 5000 files");
  expect_refused([&] { dropped->announce(1, {{"a", 600}, {"b", 401}}); }, "to be copied");
  expect_refused([&] { dropped->announce(1, {{"a", UINT64_MAX}, {"b", 2}}); }, "to be copied");
  const int group = dropped->announce(1, {{"a", 600}});
  expect_refused([&] { dropped->announce(2, {{"b", 401}}); }, "to be copied");
  dropped->forget(group);
  const std::string target = std::to_string(dropped->announce(2, {{"b", 401}}));
  expect_refused([&] { dropped->receiver_of(target + "/0", 400); }, "the 401 that were announced");
  for (const char* file : {"/1", "/-1", "/", "", "/0/0", "/99999999999999999999"}) {
    EXPECT_NE(why_not([&] { dropped->receiver_of(target + file, 401); }), "") << file;
  }
  expect_refused([&] { dropped->receiver_of("7/0", 401); }, "that were announced");
  expect_refused(
      [&] {
        std::make_shared<DroppedFiles>(0)->announce(1, {{"a", 1}});
      },
      "at most 0 MB");
}

TEST(UnitDroppedFiles, TheSceneIsOpenedElseTheHeaderElseAllAsASeries) {
  const auto opened_of = [](const std::vector<std::string>& names) {
    TemporaryFolder folder;
    for (const std::string& name : names) write_text(folder / name, "");
    const std::string found = file_to_open(fs::path(folder / "a").parent_path());
    return found.size() < (folder / "").size() ? "" : found.substr((folder / "").size());
  };
  EXPECT_EQ(opened_of({"a.raw", "b.mhd", "c.toml"}), "c.toml");
  EXPECT_EQ(opened_of({"a.raw", "b.mhd"}), "b.mhd");
  EXPECT_EQ(opened_of({"a.nii.gz"}), "a.nii.gz");
  EXPECT_EQ(opened_of({"IM1", "IM2", "IM3"}), "");
  expect_refused([&] { opened_of({"a.toml", "b.toml"}); }, "b.toml beside it");
}
