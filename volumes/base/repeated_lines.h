// Lines of work that is done many times, such as warnings of the frames of a film: the first of a
// kind is told with the place where it came, later ones are counted. Lines that differ in numbers
// alone are of one kind.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace supple {

class RepeatedLines {
 public:
  /// `what`: the kind of thing that is numbered, "frame" or "pose".
  explicit RepeatedLines(std::string what) : m_what(std::move(what)) {}

  /// Lines from now on are of this number.
  void enter(int number) { m_number = number; }
  /// Returns "frame 3: LINE"; nothing where a line of its kind was told before.
  std::optional<std::string> take(const std::string& line);
  /// A line for each kind that came again, in the order of the first ones.
  std::vector<std::string> repeats() const;

 private:
  struct Kind {
    std::string first;
    int number;                // of the first
    std::vector<int> repeats;  // numbers, each once
  };
  std::string m_what;
  int m_number = 0;
  std::vector<Kind> m_kinds;
  std::map<std::string, std::size_t> m_kind_of;  // by the line without its numbers
};

}  // namespace supple
