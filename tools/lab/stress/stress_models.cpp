#include "tools/lab/stress/stress_models.h"

#include "tools/lab/stress/stress_rows.h"

namespace supple::tools {

namespace {

// Measured quantities with their bounds; in the same order as the functions that measure them.
constexpr const char* kOfEcm =
    "the handle is where the part of the drag ends that was told, no element goes further than the "
    "handle, what is fixed stays, no link is beyond its limits";
constexpr const char* kOfBall =
    "the handle is at its target, no element goes 1 % further, what is fixed stays, links that are "
    "too long are told";
constexpr const char* kOfRelaxed =
    "the handle is where the part of the drag ends that was told, no element goes 1.5 times as "
    "far, "
    "what is fixed stays, no link is beyond its limits, and the energy does not rise";
constexpr const char* kOfVolume =
    "the handle is where the part of the drag ends that was told, no element goes 1.5 times as "
    "far, "
    "what is fixed stays, no link is beyond its limits, the energy does not rise, and no cell "
    "shrinks to less than 1 % of its volume";
constexpr const char* kOfRest =
    "the handle is at its target, no element goes 1.5 times as far, what is fixed stays, and the "
    "force that is left is below the tolerance, or told";
constexpr const char* kOfMotion =
    "the handle is at its target, no element goes three times as far, what is fixed stays, and "
    "while the handle rests the energy does not grow";
constexpr const char* kOfSymplectic =
    "the handle is at its target, no element goes three times as far, what is fixed stays, and "
    "while the handle rests the energy at most doubles";
constexpr const char* kOfFem =
    "the handle is at its target, no element goes twice as far, what is fixed stays, residual at "
    "most 1e-5, forces balanced to 1e-4, energy identity to 1e-3";
constexpr const char* kOfFinite =
    "the handle is at its target, no element goes twice as far, what is fixed stays, residual at "
    "most 1e-5, forces balanced to 1e-4, energy identity to 1e-3, and det F > 0 everywhere";
constexpr const char* kOfOriginal =
    "the handle is at its target, no element goes further, no link is beyond its limits; anchors "
    "are "
    "not known";
constexpr const char* kOfInverse =
    "the certificate holds: residual at most 1e-3 voxel, no voxel without solution, and under "
    "limits "
    "that exclude folds none and det F > 0";
constexpr const char* kOfPicture =
    "the size is as asked for, opacities are numbers from 0 to 1, colours from 0 to the sum of the "
    "light's shares (1.3), and something is seen in 2 % of the pixels or as stated";
constexpr const char* kOfSlices =
    "values are numbers from 0 to 1, and something is seen in 2 % of the pixels or as stated";
constexpr const char* kOfLive =
    "links hold after every operation, elements stay within the range, a refused operation changes "
    "nothing, undo leads back to the start, and the journal to the same state, bit for bit";

constexpr const char* kOfHead =
    "no bone lies deeper in another than at rest by 0.1 voxel after shifts, by 0.5 after turns; a "
    "way does not shrink with the way asked; 90 % of the drags that open the joint are done whole";

void as_ecm(StressInput& input, int links) {
  input.material["links"] = std::to_string(links);
  input.step["no_relax"] = "true";
}
template <int links>
void by_ecm(StressInput& input) {
  as_ecm(input, links);
}
void by_ball(StressInput& input) {
  as_ecm(input, 6);
  input.step["limits"] = "\"ball\"";
}
template <int links>
void by_passes(StressInput& input) {
  input.material["links"] = std::to_string(links);
  input.step["relax"] = "{ passes = 40 }";
}
void by_volume_passes(StressInput& input) {
  input.step["relax"] = "{ passes = 40, bulk_modulus = 50 }";
}
void set_springs(StressInput& input, const std::string& keys) {
  input.step["model"] = "\"springs\"";
  input.step["springs"] = "{ " + keys + " }";
}
void by_minimum(StressInput& input) {
  set_springs(input, "minimise = true");
}
void by_implicit(StressInput& input) {
  set_springs(input, "integrator = \"implicit\"");
}
void by_projective(StressInput& input) {
  set_springs(input, "integrator = \"projective\"");
}
void by_xpbd(StressInput& input) {
  set_springs(input, "integrator = \"xpbd\"");
}
void by_symplectic(StressInput& input) {
  set_springs(input, "integrator = \"symplectic\"");
}
void by_fem(StressInput& input, const std::string& keys) {
  input.step["model"] = "\"fem\"";
  input.step["fem"] = "{ " + keys + " }";
}
void by_linear_fem(StressInput& input) {
  by_fem(input, "max_iterations = 5000");
}
void by_finite_fem(StressInput& input) {
  by_fem(input, "strain = \"finite\", max_iterations = 5000");
}
void by_nothing(StressInput&) {}
void by_own_samples(StressInput& input) {
  by_ecm<6>(input);
  input.view["inverse"] = "false";
}
void by_slices(StressInput& input) {
  by_ecm<6>(input);
  input.has_slices = true;
  input.slice = {{"plane", "\"all\""}, {"outline", "false"}};
}

constexpr unsigned kEcm = kOfBody | kOfLimits;
constexpr unsigned kRelaxed = kEcm | kOfStiffness;
constexpr unsigned kSprings = kOfBody | kOfStiffness;
constexpr unsigned kFem = kOfBody | kOfStiffness | kOfPoisson;
constexpr unsigned kPicture = kOfBody | kOfLimits | kOfView | kOfTransfer;

}  // namespace

const std::vector<StressModel>& stress_models() {
  static const std::vector<StressModel> models = {
#ifdef SUPPLE_HAS_REFERENCE
      {"original", "Gibson's original ChainMail", kEcm, kOfOriginal, by_nothing, run_original},
#endif
      {"ecm-6", "ECM, 6 links", kEcm, kOfEcm, by_ecm<6>, run_ecm},
      {"ecm-18", "ECM, 18 links", kEcm, kOfEcm, by_ecm<18>, run_ecm},
      {"ecm-26", "ECM, 26 links", kEcm, kOfEcm, by_ecm<26>, run_ecm},
      {"ball", "ECM, ball limits", kEcm, kOfBall, by_ball, run_ball},
      {"relax-6", "relaxation, 6 links", kRelaxed, kOfRelaxed, by_passes<6>, run_relaxed},
      {"relax-26", "relaxation, 26 links", kRelaxed, kOfRelaxed, by_passes<26>, run_relaxed},
      {"volume", "relaxation that keeps volume", kRelaxed, kOfVolume, by_volume_passes,
       run_relaxed},
      {"rest", "springs, to rest", kSprings, kOfRest, by_minimum, run_springs_at_rest},
      {"implicit", "implicit Euler", kSprings | kOfSteps, kOfMotion, by_implicit, run_springs},
      {"projective", "projective dynamics", kSprings | kOfSteps, kOfMotion, by_projective,
       run_springs},
      {"xpbd", "XPBD", kSprings | kOfSteps, kOfMotion, by_xpbd, run_springs},
      {"symplectic", "symplectic Euler", kSprings | kOfSteps, kOfSymplectic, by_symplectic,
       run_springs},
      {"fem", "finite elements, linear", kFem, kOfFem, by_linear_fem, run_fem},
      {"fem-finite", "finite elements, finite strain", kFem, kOfFinite, by_finite_fem, run_fem},
      {"inverse", "inversion after ECM", kEcm, kOfInverse, by_ecm<6>, run_inverse},
      {"picture", "picture after ECM", kPicture, kOfPicture, by_ecm<6>, run_picture},
      {"picture-solving", "picture without inverse", kPicture, kOfPicture, by_own_samples,
       run_picture},
      {"slices", "slices after ECM", kEcm, kOfSlices, by_slices, run_picture},
      {"live", "live session", kOfSession, kOfLive, by_nothing, run_live},
      {"bones", "contact of bones", kOfBones, kOfHead, by_nothing, run_bones},
  };
  return models;
}

}  // namespace supple::tools
