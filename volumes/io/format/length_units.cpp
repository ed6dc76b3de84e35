#include "volumes/io/format/length_units.h"

#include <initializer_list>
#include <map>

#include "volumes/io/bytes/text_header.h"

namespace supple {

std::optional<double> mm_per_unit(const std::string& unit) {
  static const std::map<std::string, double> factors = [] {
    std::map<std::string, double> named;
    const auto add = [&](double mm, std::initializer_list<const char*> names) {
      for (const char* name : names) {
        named[name] = mm;
        // Names of more than a symbol also stand in the plural.
        if (std::string(name).size() > 3) named[std::string(name) + "s"] = mm;
      }
    };
    add(1, {"mm", "millimeter", "millimetre"});
    add(10, {"cm", "centimeter", "centimetre"});
    add(100, {"dm", "decimeter", "decimetre"});
    add(1000, {"m", "meter", "metre"});
    // The micro sign, the Greek letter, Latin-1 and the escape of ImageJ.
    add(1e-3, {"um", "\xc2\xb5m", "\xce\xbcm", "\xb5m", "\\u00b5m", "micron", "micrometer",
               "micrometre"});
    add(1e-6, {"nm", "nanometer", "nanometre"});
    add(1e-7, {"\xc3\x85", "\xe2\x84\xab", "angstrom"});
    add(25.4, {"in", "inch", "inches"});
    return named;
  }();
  const auto found = factors.find(lower_case(trimmed(unit)));
  if (found == factors.end()) return {};
  return found->second;
}

}  // namespace supple
