#include "lib/model/knob_family.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

std::string knob_name(const KnobFamily& family, double knob) {
  return std::string(family.name) + ':' + exact_text(knob);
}

std::pair<std::size_t, double> parse_knob(const std::string& text,
                                          const std::vector<const KnobFamily*>& list,
                                          const std::string& field) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  const auto found = std::find_if(list.begin(), list.end(),
                                  [&](const KnobFamily* one) { return one->name == name; });
  if (found == list.end()) {
    std::string all;
    for (const KnobFamily* one : list) all += (all.empty() ? "" : ", ") + std::string(one->name);
    throw InputError({"", field, text, "NAME:KNOB with one of " + all});
  }
  const KnobFamily& family = **found;
  const std::size_t place = std::size_t(found - list.begin());
  if (colon == std::string::npos) return {place, family.ladder.back()};
  const std::string number = text.substr(colon + 1);
  double knob = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), knob);
  const bool is_number = error == std::errc() && end == number.data() + number.size();
  const bool fits = is_number && knob >= family.lowest && knob <= family.highest &&
                    (!family.is_whole || knob == std::floor(knob));
  const auto& ladder = family.ladder;
  if (fits && (!family.is_ladder_all || std::count(ladder.begin(), ladder.end(), knob) > 0)) {
    return {place, knob};
  }
  std::string expected = std::string(family.knob) + " from " + exact_text(family.lowest) + " to " +
                         exact_text(family.highest);
  if (family.is_ladder_all) {
    expected = std::string(family.knob) + " that it has:";
    for (const double one : ladder) expected += ' ' + exact_text(one);
  }
  throw InputError({"", field, text, expected});
}

}  // namespace supple
