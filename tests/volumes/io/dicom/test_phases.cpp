// Several images at every position: each frame is one whole phase, whichever attribute tells them
// apart, or the series is refused. Phase t adds 1000 t to every voxel.
#include <gtest/gtest.h>

#include "tests/support/dicom_fixtures.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

constexpr int kPhases = 3;

/// Marks slice k of phase t.
using Mark = std::function<void(DcmDataset& data, int t, int k)>;

SeriesFixture phase_of(int t) {
  SeriesFixture series;
  series.value = [t](int i, int j, int k) {
    return SeriesFixture::default_value(i, j, k) + 1000 * t;
  };
  return series;
}

/// 1 to 18 without order, the same in every run.
std::vector<int> shuffled_numbers() {
  return {7, 16, 3, 11, 1, 18, 9, 14, 5, 2, 17, 12, 8, 4, 15, 10, 6, 13};
}

void write_phases(const TemporaryFolder& folder, const Mark& mark) {
  const std::vector<int> numbers = shuffled_numbers();
  for (int t = 0; t < kPhases; ++t) {
    SeriesFixture series = phase_of(t);
    series.edit = [&](DcmDataset& data, int k) {
      const int number = numbers[std::size_t(6 * t + k)];
      put(data, DCM_SOPInstanceUID, "1.2.3." + std::to_string(number));
      put(data, DCM_InstanceNumber, std::to_string(number));
      mark(data, t, k);
    };
    for (int k = 0; k < series.dims.z; ++k) {
      series.write(folder, k, "im" + std::to_string(numbers[std::size_t(6 * t + k)]));
    }
  }
}

void expect_whole_phases(const std::string& path, const std::string& what) {
  for (int t = 0; t < kPhases; ++t) {
    SCOPED_TRACE(what + ", phase " + std::to_string(t));
    EXPECT_EQ(values_of(*open_volume(path, choice(t))), expected_values(phase_of(t)));
  }
}

Mark with(const DcmTagKey& tag, const std::function<std::string(int t, int k)>& text) {
  return [=](DcmDataset& data, int t, int k) { put(data, tag, text(t, k)); };
}

std::string two_digits(int number) {
  return (number < 10 ? "0" : "") + std::to_string(number);
}

TEST(UnitDicomPhases, EveryAttributeThatTellsPhasesApartGivesWholeOnes) {
  const auto times = [](int t, int k) {
    return "10" + two_digits(t) + "10." + two_digits(k);  // slices within a second, a minute apart
  };
  const std::vector<std::pair<std::string, Mark>> marks = {
      {"trigger time", with(DCM_TriggerTime, [](int t, int) { return std::to_string(300 * t); })},
      // Heart beats differ, so that times of later phases overlap: their order counts.
      {"uneven trigger times",
       with(DCM_TriggerTime, [](int t, int k) { return std::to_string((300 + 40 * k) * t); })},
      {"acquisition number",
       with(DCM_AcquisitionNumber, [](int t, int) { return std::to_string(t + 4); })},
      {"acquisition time", with(DCM_AcquisitionTime, times)},
      {"content time", with(DCM_ContentTime, times)},
      {"date and time", with(DCM_AcquisitionDateTime,
                             [&](int t, int k) { return "20200131" + times(t, k) + "+0100"; })},
      {"reference time",
       with(DCM_FrameReferenceTime, [](int t, int) { return std::to_string(2500 * t); })},
      {"percentage", with(DCM_NominalPercentageOfCardiacPhase,
                          [](int t, int) { return std::to_string(30 * t); })},
      {"instance numbers of whole phases",
       with(DCM_InstanceNumber, [](int t, int k) { return std::to_string(6 * t + (7 * k) % 6); })},
      {"instance numbers of whole positions",
       with(DCM_InstanceNumber, [](int t, int k) { return std::to_string(3 * (5 - k) + t); })},
  };
  for (const auto& [what, mark] : marks) {
    const TemporaryFolder folder;
    write_phases(folder, mark);
    expect_whole_phases(folder / ".", what);
    const auto file = open_volume(folder / ".", choice(1));
    ASSERT_EQ(file->header().frame_names.size(), 3u) << what;
    EXPECT_NE(file->header().frame_names[1], file->header().frame_names[2]) << what;
  }
}

TEST(UnitDicomPhases, MidnightIsPassedWhereDatesAreSaid) {
  const TemporaryFolder folder;
  write_phases(folder, [](DcmDataset& data, int t, int k) {
    put(data, DCM_AcquisitionDate, t == 0 ? "20191231" : "20200101");
    put(data, DCM_AcquisitionTime, t == 0 ? "235950" : "0000" + two_digits(10 * t + k));
  });
  expect_whole_phases(folder / ".", "midnight");
}

TEST(UnitDicomPhases, EveryEchoOfEveryTimeIsAFrame) {
  const TemporaryFolder folder;
  const std::vector<int> numbers = shuffled_numbers();
  for (int t = 0; t < 2; ++t) {
    for (int echo = 0; echo < 2; ++echo) {
      SeriesFixture series = phase_of(2 * t + echo);
      series.dims.z = 4;
      series.edit = [&](DcmDataset& data, int k) {
        const std::string number = std::to_string(numbers[std::size_t(8 * t + 4 * echo + k)]);
        put(data, DCM_SOPInstanceUID, "1.2.3." + number);
        put(data, DCM_InstanceNumber, number);
        put(data, DCM_TemporalPositionIdentifier, std::to_string(t + 1));
        put(data, DCM_EchoTime, std::to_string(5 + 20 * echo));
      };
      for (int k = 0; k < 4; ++k) {
        series.write(folder, k, std::to_string(t) + std::to_string(echo) + std::to_string(k));
      }
    }
  }
  for (int frame = 0; frame < 4; ++frame) {
    SeriesFixture series = phase_of(frame);
    series.dims.z = 4;
    EXPECT_EQ(values_of(*open_volume(folder / ".", choice(frame))), expected_values(series));
  }
}

TEST(UnitDicomPhases, PhasesThatNothingTellsApartAreRefused) {
  const std::vector<Mark> marks = {
      [](DcmDataset&, int, int) {},
      [](DcmDataset& data, int, int) { data.findAndDeleteElement(DCM_InstanceNumber); },
      // The time of a slice says nothing where it jumps back and forth.
      with(DCM_ContentTime,
           [](int t, int k) {
             return "1000" + two_digits(shuffled_numbers()[std::size_t(6 * t + k)]);
           }),
  };
  for (const Mark& mark : marks) {
    const TemporaryFolder folder;
    write_phases(folder, mark);
    const std::string line = failure_of(folder / ".", choice(0));
    for (const char* part : {"images at one position", "3", "TriggerTime", "whole phases"}) {
      EXPECT_NE(line.find(part), std::string::npos) << line;
    }
    EXPECT_LT(line.size(), 400u) << line;
  }
}

/// One file of 3 phases of 6 slices in an order without order.
void write_enhanced_phases(const std::string& path,
                           const std::function<void(DcmItem& frame, int t, int k)>& mark,
                           const std::function<void(DcmDataset& data)>& more = {}) {
  std::vector<int> order;
  for (const int number : shuffled_numbers()) order.push_back(number - 1);
  SeriesFixture series;
  series.value = [](int i, int j, int n) {
    return SeriesFixture::default_value(i, j, n % 6) + 1000 * (n / 6);
  };
  series.edit = [&](DcmDataset& data, int) {
    for (std::size_t f = 0; f < order.size(); ++f) {
      const int t = order[f] / 6, k = order[f] % 6;
      DcmItem *frame = nullptr, *place = nullptr;
      data.findAndGetSequenceItem(DCM_PerFrameFunctionalGroupsSequence, frame, long(f));
      frame->findAndGetSequenceItem(DCM_PlanePositionSequence, place);
      const Vec3d at = series.origin + series.step * k;
      put(*place, DCM_ImagePositionPatient, ds({at.x, at.y, at.z}));
      mark(*frame, t, k);
    }
    if (more) more(data);
  };
  write_enhanced(path, series, order);
}

TEST(UnitDicomPhases, FramesOfEnhancedImagesAreSortedByTheirSequences) {
  struct Way {
    DcmTagKey group, tag;
    std::function<std::string(int t, int k)> text;
  };
  const std::vector<Way> ways = {
      {DCM_CardiacSynchronizationSequence, DCM_NominalCardiacTriggerDelayTime,
       [](int t, int) { return std::to_string(100 * t); }},
      {DCM_CardiacSynchronizationSequence, DCM_NominalPercentageOfCardiacPhase,
       [](int t, int) { return std::to_string(30 * t); }},
      {DCM_RespiratorySynchronizationSequence, DCM_NominalPercentageOfRespiratoryPhase,
       [](int t, int) { return std::to_string(20 * t); }},
      {DCM_FrameContentSequence, DCM_TemporalPositionIndex,
       [](int t, int) { return std::to_string(t + 1); }},
      {DCM_FrameContentSequence, DCM_FrameReferenceDateTime,
       [](int t, int k) { return "202001011000" + two_digits(10 * t + k); }},
      {DCM_FrameContentSequence, DCM_FrameAcquisitionDateTime,
       [](int t, int k) { return "202001011000" + two_digits(10 * t + k); }},
      {DCM_FrameContentSequence, DCM_FrameAcquisitionNumber,
       [](int t, int) { return std::to_string(t + 1); }},
      {DCM_TemporalPositionSequence, DCM_TemporalPositionTimeOffset,
       [](int t, int) { return std::to_string(0.5 * t); }},
  };
  for (const Way& way : ways) {
    const TemporaryFolder folder;
    write_enhanced_phases(folder / "a.dcm", [&](DcmItem& frame, int t, int k) {
      DcmItem* item = nullptr;
      frame.findOrCreateSequenceItem(way.group, item, -2);
      const std::string text = way.text(t, k);
      if (DcmTag(way.tag).getEVR() == EVR_UL) {
        item->putAndInsertUint32(way.tag, Uint32(std::stoi(text)));
      } else if (DcmTag(way.tag).getEVR() == EVR_US) {
        item->putAndInsertUint16(way.tag, Uint16(std::stoi(text)));
      } else if (DcmTag(way.tag).getEVR() == EVR_FD) {
        item->putAndInsertFloat64(way.tag, std::stod(text));
      } else {
        put(*item, way.tag, text);
      }
    });
    expect_whole_phases(folder / "a.dcm", DcmTag(way.tag).getTagName());
  }
}

TEST(UnitDicomPhases, FramesOfEnhancedImagesAreSortedByTheirDimensions) {
  const TemporaryFolder folder;
  write_enhanced_phases(
      folder / "a.dcm",
      [](DcmItem& frame, int t, int k) {
        DcmItem* item = nullptr;
        frame.findOrCreateSequenceItem(DCM_FrameContentSequence, item, -2);
        const Uint32 index[] = {1, Uint32(k + 1), Uint32(t + 1)};
        item->putAndInsertUint32Array(DCM_DimensionIndexValues, index, 3);
      },
      [](DcmDataset& data) {
        for (const DcmTagKey& tag :
             {DCM_StackID, DCM_InStackPositionNumber, DCM_ContrastBolusAgentNumber}) {
          DcmItem* item = nullptr;
          data.findOrCreateSequenceItem(DCM_DimensionIndexSequence, item, -2);
          item->putAndInsertTagKey(DCM_DimensionIndexPointer, tag);
        }
      });
  expect_whole_phases(folder / "a.dcm", "dimensions");
}

}  // namespace
}  // namespace supple::test
