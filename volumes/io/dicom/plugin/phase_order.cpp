#include "volumes/io/dicom/plugin/phase_order.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "volumes/base/error.h"

namespace supple {

namespace {

/// Whole number of the digits; NaN where there are others.
double digits_of(const std::string& text, std::size_t begin, std::size_t count) {
  if (text.size() < begin + count) return NAN;
  double number = 0;
  for (std::size_t n = begin; n < begin + count; ++n) {
    if (text[n] < '0' || text[n] > '9') return NAN;
    number = 10 * number + (text[n] - '0');
  }
  return number;
}

/// Days since 0000-03-01 of the Gregorian calendar.
double days_of(double year, double month, double day) {
  const double y = month < 3 ? year - 1 : year, m = month < 3 ? month + 9 : month - 3;
  return 365 * y + std::floor(y / 4) - std::floor(y / 100) + std::floor(y / 400) +
         std::floor((153 * m + 2) / 5) + day - 1;
}

/// Seconds of a day by "HHMMSS.frac", of which all behind HH may be missing.
double seconds_of_day(const std::string& text) {
  double seconds = 3600 * digits_of(text, 0, 2);
  if (text.size() >= 4) seconds += 60 * digits_of(text, 2, 2);
  if (text.size() >= 6) seconds += digits_of(text, 4, 2);
  double place = 0.1;
  for (std::size_t n = 7; n < text.size() && text[6] == '.'; ++n, place /= 10) {
    seconds += place * digits_of(text, n, 1);
  }
  return seconds;
}

std::string without(const std::string& text, char separator) {
  std::string kept = text;
  kept.erase(std::remove(kept.begin(), kept.end(), separator), kept.end());
  return kept;
}

/// A column of the planes' numbers.
struct PhaseColumn {
  std::size_t at;
  std::string name;
  PhaseRule rule;
  bool is_time;
};

/// Columns in the order in which they are asked.
std::vector<PhaseColumn> columns_of(std::size_t count) {
  const std::vector<PhaseAttribute>& attributes = phase_attributes();
  std::vector<PhaseColumn> columns, last;
  for (std::size_t n = 0; n < attributes.size(); ++n) {
    const PhaseAttribute& attribute = attributes[n];
    const bool is_frame = n + 1 == attributes.size();
    const PhaseColumn column{n, is_frame ? "frame" : name_of(attribute.tag), attribute.rule,
                             attribute.form != PhaseForm::number};
    (n + 2 < attributes.size() ? columns : last).push_back(column);
  }
  for (std::size_t n = attributes.size(); n < count; ++n) {
    columns.push_back({n, "DimensionIndexValues " + std::to_string(n - attributes.size() + 1),
                       PhaseRule::separate, false});
  }
  columns.insert(columns.end(), last.begin(), last.end());
  return columns;
}

class PhaseSorter {
 public:
  PhaseSorter(const std::string& path, std::vector<PlanesAtPosition>& positions)
      : m_path(path), m_positions(positions), m_count(positions.front().size()) {}

  std::vector<std::string> sort() {
    m_begins = std::vector<char>(m_count, 0);
    m_begins[0] = 1;
    std::size_t width = std::numeric_limits<std::size_t>::max();
    for (const PlanesAtPosition& planes : m_positions) {
      for (const ImagePlane* plane : planes) width = std::min(width, plane->phase.size());
    }
    for (const PhaseColumn& column : columns_of(width)) {
      if (is_complete()) break;
      try_column(column);
    }
    if (!is_complete()) fail();
    return names();
  }

 private:
  bool is_complete() const {
    return std::all_of(m_begins.begin(), m_begins.end(), [](char begins) { return begins != 0; });
  }

  /// The first rank of every group that is still together, and one beyond its last.
  template <class Visit>
  void for_each_group(const Visit& visit) const {
    for (std::size_t begin = 0, end; begin < m_count; begin = end) {
      end = begin + 1;
      while (end < m_count && !m_begins[end]) ++end;
      visit(begin, end);
    }
  }

  void try_column(const PhaseColumn& column) {
    const auto value = [&](const ImagePlane* plane) { return plane->phase[column.at]; };
    std::vector<PlanesAtPosition> sorted = m_positions;
    std::vector<char> begins = m_begins;
    bool is_whole = true;
    for_each_group([&](std::size_t begin, std::size_t end) {
      for (PlanesAtPosition& planes : sorted) {
        std::stable_sort(
            planes.begin() + std::ptrdiff_t(begin), planes.begin() + std::ptrdiff_t(end),
            [&](const ImagePlane* a, const ImagePlane* b) { return value(a) < value(b); });
      }
      for (std::size_t rank = begin + 1; rank < end; ++rank) {
        const auto parts = [&](const PlanesAtPosition& planes) {
          return value(planes[rank - 1]) < value(planes[rank]);
        };
        begins[rank] = parts(sorted.front());
        for (const PlanesAtPosition& planes : sorted) {
          is_whole = is_whole && parts(planes) == bool(begins[rank]);
        }
      }
      is_whole = is_whole && follows(column, sorted, begins, begin, end);
    });
    if (!is_whole) m_changing.push_back(column.name);
    if (!is_whole || begins == m_begins) return;
    m_positions = std::move(sorted);
    m_begins = std::move(begins);
    m_taken.push_back(column);
  }

  /// True if the parts of a group follow each other as the rule of the column wants it.
  static bool follows(const PhaseColumn& column, const std::vector<PlanesAtPosition>& sorted,
                      const std::vector<char>& begins, std::size_t begin, std::size_t end) {
    if (column.rule == PhaseRule::relative) return true;
    const auto value = [&](const PlanesAtPosition& planes, std::size_t rank) {
      return planes[rank]->phase[column.at];
    };
    bool by_phase = true;
    for (std::size_t rank = begin + 1; rank < end; ++rank) {
      if (!begins[rank]) continue;
      double before = -HUGE_VAL, behind = HUGE_VAL;
      for (const PlanesAtPosition& planes : sorted) {
        before = std::max(before, value(planes, rank - 1));
        behind = std::min(behind, value(planes, rank));
      }
      by_phase = by_phase && before < behind;
    }
    if (by_phase || column.rule == PhaseRule::separate) return by_phase;
    std::vector<std::pair<double, double>> spans;  // of the positions
    for (const PlanesAtPosition& planes : sorted) {
      spans.emplace_back(value(planes, begin), value(planes, end - 1));
    }
    std::sort(spans.begin(), spans.end());
    for (std::size_t n = 1; n < spans.size(); ++n) {
      if (spans[n].first <= spans[n - 1].second) return false;
    }
    return true;
  }

  std::vector<std::string> names() const {
    std::vector<std::string> all;
    const PlanesAtPosition& first = m_positions.front();
    for (const ImagePlane* plane : first) {
      std::string name;
      for (const PhaseColumn& column : m_taken) {
        const double value = plane->phase[column.at];
        name += (name.empty() ? "" : ", ") + column.name + " ";
        name += column.is_time ? "+" + number_text(value - first.front()->phase[column.at]) + " s"
                               : number_text(value);
      }
      all.push_back(name);
    }
    return all;
  }

  [[noreturn]] void fail() const {
    constexpr std::size_t kNamed = 3;
    std::string changing;
    for (std::size_t n = 0; n < std::min(kNamed, m_changing.size()); ++n) {
      changing += (n == 0 ? "" : ", ") + m_changing[n];
    }
    if (!changing.empty()) changing = " (" + changing + ": without order from slice to slice)";
    throw InputError({m_path, "images at one position",
                      std::to_string(m_count) + " that no attribute tells apart" + changing,
                      "TriggerTime, a time, or numbers of whole phases"});
  }

  const std::string& m_path;
  std::vector<PlanesAtPosition>& m_positions;
  std::size_t m_count;
  std::vector<char> m_begins;  // of every rank: whether a phase is known to begin there
  std::vector<PhaseColumn> m_taken;
  std::vector<std::string> m_changing;
};

}  // namespace

const std::vector<PhaseAttribute>& phase_attributes() {
  constexpr PhaseRule relative = PhaseRule::relative, separate = PhaseRule::separate,
                      numbered = PhaseRule::numbered;
  const DcmTagKey content = DCM_FrameContentSequence;
  const DcmTagKey heart = DCM_CardiacSynchronizationSequence;
  const DcmTagKey breath = DCM_RespiratorySynchronizationSequence;
  static const std::vector<PhaseAttribute> attributes = {
      {content, DCM_TemporalPositionIndex, relative},
      {content, DCM_TemporalPositionIdentifier, relative},
      {DCM_TemporalPositionSequence, DCM_TemporalPositionTimeOffset, relative},
      {heart, DCM_NominalPercentageOfCardiacPhase, relative},
      {breath, DCM_NominalPercentageOfRespiratoryPhase, relative},
      {content, DCM_TriggerTime, relative},
      {heart, DCM_NominalCardiacTriggerDelayTime, relative},
      {heart, DCM_ActualCardiacTriggerDelayTime, relative},
      {breath, DCM_NominalRespiratoryTriggerDelayTime, relative},
      {breath, DCM_ActualRespiratoryTriggerDelayTime, relative},
      {content, DCM_AcquisitionNumber, numbered},
      {content, DCM_FrameAcquisitionNumber, numbered},
      {DCM_MRDiffusionSequence, DCM_DiffusionBValue, separate},
      {DCM_MREchoSequence, DCM_EffectiveEchoTime, separate},
      {content, DCM_EchoTime, separate},
      {content, DCM_InversionTime, separate},
      {content, DCM_FrameReferenceDateTime, separate, PhaseForm::date_time},
      {content, DCM_FrameAcquisitionDateTime, separate, PhaseForm::date_time},
      {content, DCM_AcquisitionDateTime, separate, PhaseForm::date_time},
      {content, DCM_AcquisitionTime, separate, PhaseForm::time, DCM_AcquisitionDate},
      {content, DCM_FrameReferenceTime, separate},
      {content, DCM_ContentTime, separate, PhaseForm::time, DCM_ContentDate},
      {content, DCM_InstanceNumber, numbered},
      {content, DcmTagKey(), numbered},  // the number of a frame in its file
  };
  return attributes;
}

double seconds_of(const std::string& date, const std::string& time) {
  const std::string day = without(date, '.');
  double seconds = time.empty() ? 0 : seconds_of_day(without(time, ':'));
  if (!day.empty()) {
    seconds += 86400 * days_of(digits_of(day, 0, 4), digits_of(day, 4, 2), digits_of(day, 6, 2));
  }
  return std::isfinite(seconds) ? seconds : 0;
}

double seconds_of_date_time(const std::string& text) {
  const std::string plain = text.substr(0, text.find_first_of("+-&"));
  return plain.size() < 8 ? 0 : seconds_of(plain.substr(0, 8), plain.substr(8));
}

std::vector<std::string> order_phases(const std::string& path,
                                      std::vector<PlanesAtPosition>& positions) {
  if (positions.empty() || positions.front().size() < 2) return {};
  return PhaseSorter(path, positions).sort();
}

}  // namespace supple
