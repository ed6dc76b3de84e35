#include "tools/scene/augment/augmentation.h"

#include "lib/session/file/step_keys.h"
#include "tools/scene/live/replay.h"
#include "tools/scene/run/reports.h"
#include "volumes/base/relayed_progress.h"
#include "volumes/base/table.h"

namespace supple::tools {

namespace {

/// Relaxation leaves out what moves no further in a pass: a sample is some 0.005 voxel from one
/// that leaves nothing out, for half of the time.
constexpr double kStillVoxels = 1e-3;

const RandomMotion& motion_named(const std::string& name) {
  for (const RandomMotion& motion : random_motions()) {
    if (motion.name == name) return motion;
  }
  throw InputError({"", "motion", "\"" + name + "\"", "one of random_motions()"});
}

std::vector<std::string> motion_names() {
  std::vector<std::string> names;
  for (const RandomMotion& motion : random_motions()) names.push_back(motion.name);
  return names;
}

std::string motion_help() {
  std::string help;
  for (const RandomMotion& motion : random_motions()) {
    help += (help.empty() ? "" : "; ") + motion.name + ": " + motion.help;
  }
  return help;
}

}  // namespace

Fields fields(AugmentParams& params) {
  static const std::string help = motion_help();
  Fields all{
      Field("motion", params.motion, help.c_str()).one_of(motion_names()),
      Field("least_det", params.least_det, "Samples go less far until det F is above this")
          .range(0, 1),
      Field("passes", params.passes, "Passes of relaxation, which smooth a motion; 0: none")
          .range(0, 1000000),
      Field("seed", params.seed, "Chooses the samples").at_least(0),
  };
  for (Field& field : fields(params.limits)) all.push_back(std::move(field));
  return all;
}

Augmentation::Augmentation(Session& session, const AugmentParams& params)
    : m_session(session),
      m_params(params),
      m_motion(motion_named(params.motion)),
      m_body(session),
      m_rest(session.undo_steps()) {}

void Augmentation::take_back() {
  while (m_session.undo_steps() > m_rest) m_session.undo();
}

bool Augmentation::is_whole(const InversionCertificate& certificate) const {
  return certificate.folded_cells == certificate.folded_air_cells &&
         certificate.min_det > m_params.least_det;
}

double Augmentation::go(const Value& keys, Progress& progress) {
  try {
    Table table(keys);
    const double way = m_session.step(read_step(table, {}), &progress).report.fraction();
    if (is_whole(m_session.pose(&progress).offsets.certificate)) return way;
  } catch (const InputError&) {  // handles that do not agree in the tissue between them
  } catch (const Cancelled&) {
    take_back();
    throw;
  }
  take_back();
  return 0;
}

Value Augmentation::draw(int number, Progress* progress) {
  take_back();
  RandomNumbers of_seed{std::uint64_t(m_params.seed)};
  RandomNumbers random(of_seed.next_bits() + std::uint64_t(number));
  const DrawnMotion motion = m_motion.draw(m_body, m_params.limits, random);
  // Warnings are of ways that are drawn again, and what stays is in the truth.
  UntoldProgress attempt(progress);
  Value keys;
  double gone = 0;
  constexpr double kLeastPart = 1.0 / 64;
  for (double part = 1; part >= kLeastPart && gone == 0; part /= 2) {
    keys = motion(part);
    if (m_params.passes > 0) {
      keys["relax"] = {{"passes", m_params.passes}, {"still", kStillVoxels}};
    } else {
      keys["no_relax"] = true;
    }
    gone = part * go(keys, attempt);
  }
  if (gone == 0) keys = Value();
  return {{"sample", number},
          {"seed", m_params.seed},
          {"motion", m_motion.name},
          {"step", keys},
          {"part", gone},
          {"certificate", to_value(m_session.pose(&attempt).offsets.certificate)},
          {"pieces", to_value(m_session.body().rigid)},
          {"hash", hash_of(m_session.state())}};
}

}  // namespace supple::tools
