#include "lib/session/step_model.h"

#include <algorithm>

#include "lib/session/step.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

std::deque<StepModel>& models() {
  static std::deque<StepModel> all = built_in_models();
  return all;
}

}  // namespace

const std::deque<StepModel>& step_models() {
  return models();
}

const StepModel& model_of(const Step& step) {
  const auto found = std::find_if(models().begin() + 1, models().end(),
                                  [&](const StepModel& model) { return model.moves(step); });
  return found == models().end() ? models().front() : *found;
}

bool has_own_model(const Step& step) {
  return &model_of(step) != &models().front();
}

void take_model(const Step& from, Step& step) {
  step.springs = from.springs;
  step.fem = from.fem;
  step.own = from.own;
}

std::string model_names(const char* quote, std::size_t first) {
  std::string names;
  for (std::size_t n = first; n < models().size(); ++n) {
    const char* const between = n == first ? "" : n + 1 < models().size() ? ", " : " or ";
    names += between + (quote + models()[n].name + quote);
  }
  return names;
}

void add_model(StepModel model) {
  for (const StepModel& other : models()) {
    if (other.name != model.name) continue;
    throw InputError({"", "model", "a second " + model.name, "a name of its own"});
  }
  models().push_back(std::move(model));
}

const std::any& own_settings_of(const Step& step) {
  return step.own;
}

std::any& own_settings_of(Step& step) {
  return step.own;
}

const Step& as_step(const StepRecord& record) {
  return record;
}

Value own_report(const StepRecord& record) {
  const StepModel& model = model_of(record);
  return {{"model", model.name},
          {"cut_links", record.cut_links},
          {"settings", model.settings(record)},
          {model.name.c_str(), record.own_report}};
}

}  // namespace supple
