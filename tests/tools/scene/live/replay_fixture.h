// Journals of live sessions in a folder of their own, and replays of them.
#pragma once

#include <array>
#include <iterator>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace supple::test {

/// The words of a command line.
inline Outcome run_line(const std::string& line) {
  std::istringstream words(line);
  return run_supple({std::istream_iterator<std::string>(words), {}});
}

class UnitReplay : public ::testing::Test {
 protected:
  UnitReplay() { write_ball(m_folder, "ball", 24); }

  /// A journal of the ball with these events.
  std::string journal(const std::string& events, const std::string& name = "journal.toml") {
    write_text(m_folder / name,
               "[volume]\npath = \"ball.nhdr\"\n[[view]]\nimage = \"view.png\"\nsize = [96, 96]\n" +
                   events);
    return m_folder / name;
  }
  Outcome replay(const std::string& file, const std::string& more = "") {
    return run_line("replay " + file + " --quiet --force --size 96,96 " + more);
  }
  std::string hash(const std::string& file, const std::string& more = "") {
    const Outcome run = replay(file, "--json " + more);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const std::size_t at = run.out.find("\"state\": \"");
    return at == std::string::npos ? "" : run.out.substr(at + 10, 64);
  }

  TemporaryFolder m_folder;
};

inline std::string event(const std::string& kind, const std::string& keys = "") {
  return "[[event]]\nkind = \"" + kind + "\"\n" + keys + "\n";
}

inline std::string vector_text(const std::array<double, 3>& v) {
  return "[" + std::to_string(v[0]) + ", " + std::to_string(v[1]) + ", " + std::to_string(v[2]) +
         "]";
}

}  // namespace supple::test
