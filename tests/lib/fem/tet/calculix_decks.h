// Decks for CalculiX, and what it makes of them.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace supple::test {

/// Adds to a deck, as std::snprintf writes it.
template <class... Values>
void append(std::string& text, const char* format, Values... values) {
  char line[200];
  std::snprintf(line, sizeof line, format, values...);
  text += line;
}

/// The `.dat` that CalculiX writes.
std::string judged_text(const std::string& deck);
/// Displacements after the last increment.
std::vector<double> calculix_displacements(const std::string& deck);
/// Largest difference relative to the largest value of theirs.
double difference(const std::vector<double>& ours, const std::vector<double>& theirs);

}  // namespace supple::test
