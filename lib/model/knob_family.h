// Settings that differ in one number, the knob, which trades time for error, by names such as
// "relax-26:64".
#pragma once

#include <string>
#include <vector>

namespace supple {

struct KnobFamily {
  const char* name;        // "relax-26"
  const char* title;       // for charts and tables
  const char* knob;        // what the number is: "passes"
  double lowest, highest;  // that it may have
  bool is_whole;
  std::vector<double> ladder;  // its values from the fastest to the most exact
  bool is_ladder_all = false;  // no others are allowed
};

template <class Family>
struct KnobSetting {
  const Family* family = nullptr;
  double knob = 0;

  std::string name() const;
};

/// Writes "relax-26:64".
std::string knob_name(const KnobFamily& family, double knob);

/// The name before the colon, and after it the number, or the last of the family's ladder. `list`:
/// all families. Throws InputError with the field.
std::pair<std::size_t, double> parse_knob(const std::string& text,
                                          const std::vector<const KnobFamily*>& list,
                                          const std::string& field);

template <class Family>
std::string KnobSetting<Family>::name() const {
  return knob_name(*family, knob);
}

template <class Family>
KnobSetting<Family> parse_setting(const std::string& text, const std::vector<Family>& families,
                                  const std::string& field) {
  std::vector<const KnobFamily*> list;
  for (const Family& family : families) list.push_back(&family);
  const auto [place, knob] = parse_knob(text, list, field);
  return {&families[place], knob};
}

/// Returns every value of the ladders of the named families; for "NAME:KNOB" that one alone; for no
/// names all. Throws as parse_knob.
template <class Family>
std::vector<KnobSetting<Family>> settings_named(const std::vector<std::string>& names,
                                                const std::vector<Family>& families,
                                                const std::string& field) {
  std::vector<KnobSetting<Family>> settings;
  const auto add_ladder = [&](const Family& family) {
    for (const double knob : family.ladder) settings.push_back({&family, knob});
  };
  if (names.empty()) {
    for (const Family& family : families) add_ladder(family);
  }
  for (const std::string& name : names) {
    const KnobSetting<Family> setting = parse_setting(name, families, field);
    if (name.find(':') == std::string::npos) {
      add_ladder(*setting.family);
    } else {
      settings.push_back(setting);
    }
  }
  return settings;
}

}  // namespace supple
