// Images at the same positions as whole phases: which attribute tells them apart. Sources: PS3.3,
// C.7.6.16.2 (frame content, temporal position, cardiac and respiratory synchronization, dimension
// index), C.7.6.18 and C.8 (times and numbers of single images).
//
// Attributes are asked in the order of their table. One of them is taken where it parts the images
// in the same way at every position, so that a frame never holds parts of several phases:
//  - `relative` ones (place in a heart beat, in breathing, in a list) by their order alone;
//  - `separate` ones (echo times, dates) where each phase ends before the next one begins;
//  - `numbered` ones there, and where each position is complete before the next one begins.
// Those taken part further what the ones before them left together (echoes of each time).
// Cost: images times attributes, and sorting.
#pragma once

#include <string>
#include <vector>

#include "volumes/io/dicom/plugin/dicom_image.h"

namespace supple {

enum class PhaseRule { relative, separate, numbered };
enum class PhaseForm { number, time, date_time };

/// One attribute of the table; `group` is its functional group in enhanced images.
struct PhaseAttribute {
  DcmTagKey group, tag;
  PhaseRule rule;
  PhaseForm form = PhaseForm::number;
  DcmTagKey date = {};  // of a time
};

/// Attributes in the order in which they are asked; the last two number images and frames.
const std::vector<PhaseAttribute>& phase_attributes();

/// Seconds since the year 0 of a DT ("20200131100030.5+0100", the zone apart); 0 for no such text.
double seconds_of_date_time(const std::string& text);
/// The same of a DA and a TM, either of which may be empty.
double seconds_of(const std::string& date, const std::string& time);

using PlanesAtPosition = std::vector<const ImagePlane*>;

/// Sorts the planes of every position, which are equally many, by phase; returns the names of the
/// phases, such as "TriggerTime 300", without any where there is but one. Throws InputError, with
/// the attributes that change from position to position, where none tells phases apart.
std::vector<std::string> order_phases(const std::string& path,
                                      std::vector<PlanesAtPosition>& positions);

}  // namespace supple
