// Live sessions: events, journals, batch scenes of them, undo, and pictures in a budget.
#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/material/material.h"
#include "lib/state/state.h"
#include "raycast/pictures/image.h"
#include "tests/support/sanitized.h"
#include "tests/tools/scene/live/replay_fixture.h"

using namespace supple;
using namespace supple::test;

namespace {

const std::string kDrags =
    event("anchor", "grab_box = [4, 4, 8, 20, 20, 9]") + event("grab", "grab = [12, 12, 16]") +
    event("drag", "to = [0.7, 1.3, 0.1]") + event("drag", "to = [1.1, 2.9, 0.3]") +
    event("drag", "to = [0.3, 9.9, 0.2]") + event("drag", "to = [0.2, 2.2, 0.9]") +
    event("release") + event("relax", "passes = 12");

/// A bone in the ball, and a drag of tissue above one end that takes it along.
const std::string kBoneDragged =
    event("step", "rigid = [{ name = \"bone\", grab_box = [8, 11, 12, 15, 12, 13] }]") +
    event("grab", "grab = [15, 11, 16]") + event("drag", "to = [0.5, 0.8, 1.5]") +
    event("drag", "to = [0.9, 2.0, 3.5]") + event("drag", "to = [1.2, 2.6, 5.5]");

/// Random events that change the body or not.
std::string random_events(int count) {
  std::mt19937 random(7);
  std::string text;
  for (int n = 0; n < count; ++n) {
    const auto number = [&](int most) { return int(random() % unsigned(most)); };
    const std::string voxel = "[" + std::to_string(9 + number(6)) + ", " +
                              std::to_string(9 + number(6)) + ", " + std::to_string(9 + number(6)) +
                              "]";
    const int what = number(12);
    if (n == 0 || what == 0) {
      text += event("grab", "grab = " + voxel);
    } else if (what == 1) {
      text += event("redo");
    } else if (what == 2) {
      text += event("relax", "passes = 2");
    } else if (what == 3) {
      text += event("undo");
    } else if (what == 4 && n > 3) {
      text += event("release", "all = true") + event("grab", "grab = " + voxel);
    } else {
      text += event("drag", "to = " + vector_text({number(30) / 10. - 1.5, number(30) / 10. - 1.5,
                                                   number(20) / 10. - 1}));
    }
  }
  return text;
}

}  // namespace

TEST_F(UnitReplay, AJournalTheSceneMadeFromItAndAnyNumberOfThreadsLeadToTheSameState) {
  const std::string file = journal(kDrags);
  const std::string one = hash(file, "--threads 1 --scene " + (m_folder / "batch.toml") +
                                         " --journal " + (m_folder / "carried.toml"));
  EXPECT_EQ(one.size(), 64u);
  EXPECT_EQ(hash(file, "--threads 2"), one);
  EXPECT_EQ(hash(file, "--threads 8 --budget 1"), one);
  EXPECT_EQ(hash(m_folder / "carried.toml"), one);
  EXPECT_EQ(hash(m_folder / "batch.toml"), one);
  ASSERT_EQ(
      run_line("run " + (m_folder / "batch.toml") + " --quiet -o " + (m_folder / "out")).exit_code,
      0);
  EXPECT_EQ(replay(file, "--check " + (m_folder / "out/live.vdb")).exit_code, 0);
  const std::string other = journal(
      event("grab", "grab = [12, 12, 16]") + event("drag", "to = [0.7, 1.3, 0.1]"), "other.toml");
  EXPECT_EQ(replay(other, "--check " + (m_folder / "out/live.vdb")).exit_code, 1);
}

TEST_F(UnitReplay, AStepOutsideOfTheVolumeIsRefusedBeforeAnythingReadsTheVolume) {
  const Outcome run = replay(journal(event("step", "grab = [12, 12, 300]\nby = [1, 0, 0]")));
  EXPECT_EQ(run.exit_code, 3);
  EXPECT_NE(run.err.find("grab: found 12,12,300, expected a voxel of the volume"),
            std::string::npos)
      << run.err;
}

TEST_F(UnitReplay, PiecesShiftWhileTheyAreDraggedAndTurnAfterTheRelease) {
  const std::string dragged = hash(journal(kBoneDragged));
  const std::string file = journal(kBoneDragged + event("release") + event("relax", "passes = 7"));
  const std::string end = hash(file, "--threads 2 --scene " + (m_folder / "batch.toml") +
                                         " --journal " + (m_folder / "carried.toml"));
  EXPECT_EQ(hash(file, "--threads 1"), end);
  EXPECT_EQ(hash(m_folder / "carried.toml"), end);
  EXPECT_EQ(hash(m_folder / "batch.toml"), end);
  // The turn belongs to the stroke of the drags.
  const std::string rest =
      hash(journal(kBoneDragged.substr(0, kBoneDragged.find("[[event]]\nkind = \"grab\""))));
  EXPECT_EQ(hash(journal(kBoneDragged + event("release") + event("undo", "all = true"))), rest);
  EXPECT_EQ(hash(journal(kBoneDragged + event("release") + event("undo"))), dragged);
  // All is let go of once they have turned.
  const std::string turned = hash(journal(kBoneDragged + event("release")));
  EXPECT_EQ(hash(journal(kBoneDragged + event("release", "all = true"))), turned);
  EXPECT_NE(turned, dragged);
}

TEST_F(UnitReplay, AGrabThatSparesWhatIsFixedTakesWhatLiesBesideIt) {
  const std::string bone =
      event("step", "rigid = [{ name = \"bone\", grab_box = [8, 11, 12, 15, 12, 13] }]") +
      event("anchor", "rigid_at = [9, 11, 12]");
  const std::string drag = event("drag", "to = [0.3, 0.2, 0.5]");
  const auto ball = [](const std::string& more) {
    return event("grab", "grab_ball = [12, 11, 14]\nradius = 2\nsoft = 2\n" + more);
  };
  const Outcome refused = replay(journal(bone + ball("") + drag));
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("in both"), std::string::npos) << refused.err;
  const std::string end =
      hash(journal(bone + ball("spare_fixed = true") + drag),
           "--scene " + (m_folder / "batch.toml") + " --journal " + (m_folder / "carried.toml") +
               " --state " + (m_folder / "live.vdb"));
  EXPECT_EQ(hash(m_folder / "carried.toml"), end);
  EXPECT_EQ(hash(m_folder / "batch.toml"), end);
  EXPECT_NE(hash(journal(bone)), end);
  const State live = read_state(m_folder / "live.vdb");
  Slot slot;
  for (const Vec3i& voxel : {Vec3i(8, 11, 12), Vec3i(12, 11, 13), Vec3i(15, 12, 13)}) {
    ASSERT_TRUE(slot_of(live.elements, voxel, slot));
    for (const BrickValues& q : live.q) EXPECT_EQ(q.at(slot), 0);
  }
  ASSERT_TRUE(slot_of(live.elements, Vec3i(12, 11, 14), slot));
  EXPECT_NE(live.q[2].at(slot), 0);
  // A grab of fixed elements alone says so.
  const Outcome none =
      replay(journal(bone + event("grab", "grab = [9, 11, 12]\nspare_fixed = true")));
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_NE(none.err.find("fixed elements alone"), std::string::npos) << none.err;
}

TEST_F(UnitReplay, AGrabThatSlidesFollowsTheHandWhereAnAnchorDoesNotStopIt) {
  const auto grab = [](const std::string& more) {
    return event("anchor", "grab_box = [4, 4, 8, 20, 20, 9]") +
           event("grab", "grab = [12, 12, 16]\n" + more);
  };
  const std::string far = event("drag", "to = [0.2, 9.9, 9.9]");
  const std::string file = journal(grab("slide = true") + far + event("drag", "to = [1, 0, 9.9]"));
  const std::string end =
      hash(file, "--threads 2 --scene " + (m_folder / "batch.toml") + " --journal " +
                     (m_folder / "carried.toml") + " --state " + (m_folder / "live.vdb"));
  EXPECT_EQ(hash(file, "--threads 1"), end);
  EXPECT_EQ(hash(m_folder / "carried.toml"), end);
  EXPECT_EQ(hash(m_folder / "batch.toml"), end);
  const State live = read_state(m_folder / "live.vdb");
  Slot slot;
  ASSERT_TRUE(slot_of(live.elements, Vec3i(12, 12, 16), slot));
  EXPECT_NEAR(live.q[0].at(slot) / kFixedOne, 1, 1e-3);
  EXPECT_NEAR(live.q[1].at(slot) / kFixedOne, 0, 1e-3);
  EXPECT_GT(live.q[2].at(slot) / kFixedOne, 1);
  // The anchor above holds it sideways, too, unless it slides; stopped drags are as they were.
  EXPECT_NE(hash(journal(grab("") + far + event("drag", "to = [1, 0, 9.9]"))), end);
  const std::string near = event("drag", "to = [0.2, 0.3, 0.4]");
  EXPECT_EQ(hash(journal(grab("slide = true") + near)), hash(journal(grab("") + near)));
}

TEST_F(UnitReplay, ACutThatIsTakenOutHasNeverBeenMade) {
  const auto cut = [](int i) {
    return event("cut",
                 "plane = { corner = [" + std::to_string(i) +
                     ", -1, 10], edge1 = [0, 26, 0], edge2 = [0, 0, 16], frame = \"voxel\" }");
  };
  const auto taken_out = [](int number) {
    return event("release", "cut = " + std::to_string(number));
  };
  const std::string without = hash(journal(kDrags));
  EXPECT_NE(hash(journal(cut(13) + kDrags)), without);
  EXPECT_EQ(
      hash(journal(cut(13) + kDrags + taken_out(1)),
           "--journal " + (m_folder / "carried.toml") + " --scene " + (m_folder / "batch.toml")),
      without);
  EXPECT_EQ(hash(m_folder / "carried.toml"), without);
  EXPECT_EQ(hash(m_folder / "batch.toml"), without);
  const std::string first = hash(journal(cut(13) + kDrags));
  EXPECT_EQ(hash(journal(cut(13) + cut(9) + kDrags + taken_out(2))), first);
  EXPECT_NE(hash(journal(cut(13) + cut(9) + kDrags + taken_out(1))), first);
  // A step that does more keeps what else it does.
  const std::string both =
      "plane = { corner = [13, -1, 10], edge1 = [0, 26, 0], edge2 = [0, 0, 16], frame = \"voxel\" "
      "}";
  EXPECT_EQ(hash(journal(event("step", "fix = [[4, 4, 2, 20, 20, 5]]\ncut = [{ " + both + " }]") +
                         kDrags + taken_out(1))),
            hash(journal(event("step", "fix = [[4, 4, 2, 20, 20, 5]]") + kDrags)));
  const Outcome missing = replay(journal(cut(13) + taken_out(2)));
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_NE(missing.err.find("found 2, expected one of 1 that there are"), std::string::npos)
      << missing.err;
  for (const char* more : {"all = true", "handle = 1", "restore = true"}) {
    const Outcome refused =
        replay(journal(cut(13) + event("release", std::string("cut = 1\n") + more)));
    EXPECT_EQ(refused.exit_code, 3) << more;
    EXPECT_NE(refused.err.find("more than one thing"), std::string::npos) << refused.err;
  }
}

TEST_F(UnitReplay, AnchorsThatStayAreInTheBatchSceneHoweverTheyWereWritten) {
  const std::string events = event("step", "fix_density = [1, 40]\nfix = [[12, 12, 6]]") +
                             event("anchor", "grab_box = [11, 11, 8, 13, 13, 9]") +
                             event("grab", "grab = [12, 12, 16]\nsoft = 2") +
                             event("drag", "to = [0, 1, 0]") + event("release") +
                             event("release", "anchor = 3") + event("grab", "grab = [12, 16, 12]") +
                             event("drag", "to = [0, 0, 1]");
  const std::string live = hash(journal(events), "--scene " + (m_folder / "batch.toml"));
  EXPECT_EQ(hash(m_folder / "batch.toml"), live);
  const std::string batch = read_text(m_folder / "batch.toml");
  for (const char* key : {"grab_density = [1.0, 40.0]", "grab_box = [12, 12, 6, 12, 12, 6]"}) {
    EXPECT_NE(batch.find(key), std::string::npos) << key << " in\n" << batch;
  }
}

TEST_F(UnitReplay, SlicesOfARelaxationShareItsBudget) {
  // Each pass looks at elements about 35,000 times.
  const std::string file =
      journal(kDrags + event("relax", "passes = 500\nbudget = 0.25\nmethod = \"jacobi\""));
  ASSERT_EQ(replay(file, "--journal " + (m_folder / "carried.toml")).exit_code, 0);
  const std::string carried = read_text(m_folder / "carried.toml");
  int slices = 0;
  for (std::size_t at = carried.find("jacobi"); at != std::string::npos;
       at = carried.find("jacobi", at + 1)) {
    ++slices;
  }
  EXPECT_EQ(slices, 2) << carried;
}

TEST_F(UnitReplay, TheSettledPictureOfABodyWithPiecesIsThatOfRender) {
  for (const std::string& cut :
       {std::string(), event("cut",
                             "plane = { corner = [12, -1, 14], edge1 = [0, 26, 0], edge2 = [0, 0, "
                             "12], frame = \"voxel\" }")}) {
    const std::string file = journal(kBoneDragged + cut + event("drag", "to = [2.4, 2.4, 6]"));
    ASSERT_EQ(
        replay(file, "--image " + (m_folder / "live.png") + " --state " + (m_folder / "live.vdb"))
            .exit_code,
        0);
    ASSERT_EQ(run_line("render " + (m_folder / "live.vdb") + " --quiet --force --size 96,96 -o " +
                       (m_folder / "batch.png"))
                  .exit_code,
              0);
    EXPECT_EQ(read_png(m_folder / "live.png").rgba, read_png(m_folder / "batch.png").rgba) << cut;
  }
}

TEST_F(UnitReplay, TheSettledPictureIsThatOfRender) {
  const std::string file = journal(kDrags + event("camera", "camera = { view = \"left\" }") +
                                   event("look", "preset = \"MR-Default\"") +
                                   event("clip", "clip = [{ box = [0, 0, 0, 15, 30, 30] }]"));
  ASSERT_EQ(
      replay(file, "--image " + (m_folder / "live.png") + " --state " + (m_folder / "live.vdb"))
          .exit_code,
      0);
  ASSERT_EQ(
      run_line("render " + (m_folder / "live.vdb") + " --quiet --view left --preset " +
               "MR-Default --size 96,96 --clip-box 0,0,0:15,30,30 -o " + (m_folder / "batch.png"))
          .exit_code,
      0);
  EXPECT_EQ(read_png(m_folder / "live.png").rgba, read_png(m_folder / "batch.png").rgba);
}

TEST_F(UnitReplay, AThousandRandomEventsAndAsManyUndosLeadBackToTheStart) {
  const std::string rest = hash(journal(event("grab", "grab = [12, 12, 16]")));
  const std::string there = random_events(1000);
  std::string back;
  for (int n = 0; n < 1000; ++n) back += event("undo");
  const std::string moved = hash(journal(there, "there.toml"), "--budget 1");
  EXPECT_NE(moved, rest);
  EXPECT_EQ(hash(journal(there + back, "back.toml"), "--budget 1"), rest);
}

TEST_F(UnitReplay, ARedoLeadsToWhereTheUndoCameFrom) {
  RUN_WHEN_SANITIZED();
  const std::string end = hash(journal(kDrags));
  const std::string undos = event("undo") + event("undo") + event("undo");
  const std::string redos = event("redo") + event("redo") + event("redo");
  EXPECT_NE(hash(journal(kDrags + undos)), end);
  EXPECT_EQ(hash(journal(kDrags + undos + redos)), end);
}

TEST_F(UnitReplay, EventsThatComeFasterThanTheyAreDoneAreMergedAndTheirJournalReplays) {
  RUN_WHEN_SANITIZED();
  std::string many = event("grab", "grab = [12, 12, 16]");
  for (int n = 1; n <= 400; ++n) {
    many += event("drag", "to = " + vector_text({0, 0.01 * n, 0}));
  }
  const std::string file = journal(many);
  const std::string journal_file = m_folder / "merged.toml";
  const Outcome run = replay(file, "--json --speed 1000 --journal " + journal_file);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out.find("\"merged\": 0,"), std::string::npos);
  const std::string hash_now = run.out.substr(run.out.find("\"state\": \"") + 10, 64);
  EXPECT_EQ(hash(journal_file), hash_now);
}

TEST_F(UnitReplay, ASoftHandleInStiffTissueMayTurnRound) {
  write_text(m_folder / "stiff.toml",
             "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.02]]\n"
             "min_length = [[0, 0.98]]\nshear = [[0, 0.02]]\n");
  std::string drags = event("grab", "grab_ball = [12, 12, 12]\nradius = 2\nsoft = 5");
  for (const double to : {1., 2., -1., -2., 0.5})
    drags += event("drag", "to = " + vector_text({to, 0, to}));
  const std::string file = journal("[material]\ntable = \"stiff.toml\"\n" + drags);
  const Outcome run = replay(file, "--state " + (m_folder / "end.vdb"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const State end = read_state(m_folder / "end.vdb");
  Slot middle;
  ASSERT_TRUE(slot_of(end.elements, {12, 12, 12}, middle));
  EXPECT_EQ(end.q[0].at(middle), 32768);
  EXPECT_EQ(check_links(make_body(end, read_material(m_folder / "stiff.toml"))).violated, 0);
}

TEST_F(UnitReplay, AHandLedByFiniteElementsReplaysAtAnySpeed) {
  const std::string file = journal(
      event("anchor", "grab_box = [4, 4, 2, 20, 20, 9]") +
      event("model", "model = \"fem\"\nunder_hand = true") +
      event("grab", "at = 50\ngrab_ball = [12, 12, 15]\nradius = 2\ndirections = [[10, 0, 0]]") +
      event("drag", "at = 100\nto = [1, 0, 0]") + event("drag", "at = 400\nto = [3, 0, 0]") +
      event("release", "at = 450"));
  const std::string scene = m_folder / "batch.toml";
  const std::string led = hash(file, "--speed 1 --scene " + scene);
  EXPECT_EQ(hash(file, "--speed 0 --threads 2"), led);
  EXPECT_EQ(hash(scene), led);
}

TEST_F(UnitReplay, AFilmShowsEventsAtTheirTimesAndPausesShortened) {
  const std::string file = journal(
      event("grab", "at = 200\ngrab = [12, 12, 16]") + event("drag", "at = 400\nto = [0, 1, 0]") +
      event("drag", "at = 430\nto = [0, 2, 0]") + event("drag", "at = 430\nto = [0, 4, 0]") +
      event("drag", "at = 460\nto = [0, 5, 0]") + event("drag", "at = 490\nto = [0, 7, 0]") +
      event("release", "at = 5000"));
  const Outcome run = replay(file, "--fps 10 --film " + (m_folder / "f_%02d.png"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  std::vector<int> changes;
  std::string last;
  int count = 0;
  for (;; ++count) {
    const std::string name =
        m_folder / ("f_" + std::string(count < 10 ? "0" : "") + std::to_string(count) + ".png");
    if (!std::filesystem::exists(name)) break;
    const std::string bytes = read_text(name);
    if (bytes != last) changes.push_back(count);
    last = bytes;
  }
  // The first of the drags at 460 and 490 ms, 100 later in the film, falls between two pictures.
  EXPECT_EQ(changes, (std::vector<int>{0, 4, 5, 6}));
  EXPECT_EQ(count, 6 + 10 + 10);
  ASSERT_EQ(replay(file, "--image " + (m_folder / "end.png")).exit_code, 0);
  EXPECT_EQ(read_png(m_folder / "end.png").rgba, read_png(m_folder / "f_25.png").rgba);
  const Outcome twice = replay(file, "--fps 10 --speed 2 --film " + (m_folder / "g_%02d.png"));
  ASSERT_EQ(twice.exit_code, 0) << twice.err;
  EXPECT_TRUE(std::filesystem::exists(m_folder / "g_00.png"));
  EXPECT_FALSE(std::filesystem::exists(m_folder / "g_25.png"));
}

TEST_F(UnitReplay, AFilmThatCannotBeIsRefusedBeforeItBegins) {
  const std::string file = journal(kDrags);
  write_text(m_folder / "h_003.png", "here");
  for (const auto& [more, text] :
       std::vector<std::pair<std::string, std::string>>{{"f.png", "a_%03d.png"},
                                                        {"f_%d.exr", ".mp4"},
                                                        {"f_%d.tiff", ".mp4"},
                                                        {"f_%d.png --fps 0", "0.1 to 240"}}) {
    const Outcome run = replay(file, "--film " + m_folder / more);
    EXPECT_EQ(run.exit_code, 3) << more << run.err;
    EXPECT_NE(run.err.find(text), std::string::npos) << run.err;
  }
  const Outcome there = run_line("replay " + file + " --quiet --film " + m_folder / "h_%03d.png");
  EXPECT_EQ(there.exit_code, 2);
  EXPECT_NE(there.err.find("h_003.png"), std::string::npos) << there.err;
  std::string pauses;
  for (int n = 1; n <= 50; ++n) pauses += event("limits", "at = " + std::to_string(5000 * n));
  const Outcome endless =
      replay(journal(pauses, "slow.toml"), "--fps 240 --film " + m_folder / "k_%d.png");
  EXPECT_EQ(endless.exit_code, 3);
  EXPECT_NE(endless.err.find("at most 10000"), std::string::npos) << endless.err;
}

TEST_F(UnitReplay, BadEventsNameTheirLineAndWhatIsExpected) {
  const Outcome unknown = replay(journal(event("grab", "grabb = [1, 2, 3]")));
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_NE(unknown.err.find("grabb"), std::string::npos) << unknown.err;
  const Outcome nothing = replay(journal(event("drag", "to = [1, 2, 3]")));
  EXPECT_EQ(nothing.exit_code, 3);
  EXPECT_NE(nothing.err.find("grab or push before it"), std::string::npos) << nothing.err;
  EXPECT_EQ(replay(journal(event("grab", "grab = [0, 0, 0]"))).exit_code, 3);
  const std::string grab = event("grab", "grab = [12, 12, 16]");
  for (const auto& [bad, text] : std::vector<std::pair<std::string, std::string>>{
           {event("camera", "camera = { view = \"lft\" }"), ": view.camera.view: found \"lft\""},
           {event("look", "preset = 0.1"), ": view.preset: found 0.1, expected a string"},
           {event("look", "preset = \"Skn\""), ": preset: found Skn"},
           {event("drag", "to = [0, 1e9, 0]"), ": displacement along axis j: found 1e+09 mm"}}) {
    const std::string file = journal(grab + bad, "bad.toml");
    const std::string whole = read_text(file);
    const auto line = std::count(whole.begin(), whole.begin() + whole.rfind("[[event]]"), '\n') + 1;
    const Outcome refused = replay(file);
    EXPECT_EQ(refused.exit_code, 3) << bad;
    EXPECT_NE(refused.err.find(file + ":" + std::to_string(line) + text), std::string::npos)
        << refused.err;
  }
  // It is refused before it is carried out, or every event after it would be refused, too.
  write_text(m_folder / "edges.toml",
             "opacity = [[0, 0], [255, 1]]\ncolour = [[0, 1, 1, 1]]\n"
             "gradient_opacity = [[0, 0], [60, 1]]\n");
  const Outcome along = replay(journal("classification = \"pre-integrated\"\n" +
                                       event("look", "transfer = \"edges.toml\"")));
  EXPECT_EQ(along.exit_code, 3);
  EXPECT_NE(along.err.find("journal.toml:7: classification: found pre-integrated with gradient"),
            std::string::npos)
      << along.err;
  const Outcome both = replay(journal("[[step]]\ngrab = [12, 12, 16]\nby = [0, 1, 0]\n" + grab));
  EXPECT_EQ(both.exit_code, 3);
  EXPECT_NE(both.err.find("a step beside events"), std::string::npos) << both.err;
  EXPECT_EQ(run_line("run " + journal(kDrags) + " -o " + (m_folder / "out")).exit_code, 3);
}

TEST_F(UnitReplay, ViewsWithMarksOnTissueAreLeftToRun) {
  for (const char* mark : {"grid = 5", "arrows = 5", "overlay = \"displacement\""}) {
    const Outcome outcome =
        run_line("replay " + journal(std::string(mark) + "\n" + kDrags) + " --size 96,96");
    EXPECT_EQ(outcome.exit_code, 0) << mark;
    EXPECT_NE(outcome.err.find("a look of its own is shown"), std::string::npos) << outcome.err;
  }
}
