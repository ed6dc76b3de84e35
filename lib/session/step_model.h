// Models that may move the body in a step, one row each. Scenes, options, help, journals, reports,
// plans, trade-offs and the page of the viewer take all that they know of a model from its row.
#pragma once

#include <any>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lib/model/knob_family.h"
#include "lib/model/model.h"
#include "volumes/base/fields.h"
#include "volumes/base/unit_cost.h"
#include "volumes/grid/labels.h"

namespace supple {

struct ModelTask;    // lib/session/step_task.h
struct PieceMotion;  // lib/session/handles/rigid_drag.h
struct SessionBody;  // lib/session/session_body.h
struct Step;
struct StepRecord;
class Table;

/// Memory and work of a step that moves a whole body.
struct ModelCost {
  struct Amount {
    double count = 0;
    const char* of = "";  // "unknowns"
  };
  Amount size, passes;
  bool is_exact = false;  // whether the number of passes is known
  double bytes = 0;       // until the step is done
  double units = 0;       // of work
  UnitCost unit = {};
};

/// A model with a number that trades time for error, for measurements side by side.
struct ModelMethod : KnobFamily {
  int links = 0;                           // of the material; 0: its own; kKnobLinks: the knob
  void (*solve)(Step& step, double knob);  // sets what moves the body
};
constexpr int kKnobLinks = -1;

/// A row. Functions that are left out do nothing.
struct StepModel {
  std::string name;              // in scenes, options, journals and pages: "fem"
  std::string title;             // for people: "finite elements"
  std::string menu;              // of the page: "Finite elements, after a drag"
  std::string options = {};      // prefix of its options on the command line
  bool waits_for_hands = false;  // live sessions solve it once a hand lets go
  bool knows_pushes = false;     // takes handles that only push

  /// Whether the step asks for it. Only Enhanced ChainMail, the first, has none of these six.
  std::function<bool(const Step&)> moves = {};
  /// Makes the step ask for it, by its defaults.
  std::function<void(Step&)> choose = {};
  /// Keys of its table in a scene, and those of them that are options: of a step that asks for it.
  std::function<Fields(Step&)> fields = {}, option_fields = {};
  /// Reads that table, where it has more than `fields`.
  std::function<void(Table&, const LabelNames&, Step&)> read = {};
  /// Settings and results as a journal records them.
  std::function<Value(const StepRecord&)> settings = {};
  std::function<ModelCost(const Step&, const Body&)> cost = {};

  /// Throws InputError for what it does not know: wounds that open, rigid pieces that are grabbed.
  std::function<void(const Step&, const SessionBody&)> check = {};
  /// Shortens motions of pieces by what it cannot do afterwards; returns the part that is left.
  std::function<double(SessionBody&, std::vector<PieceMotion>&, StepRecord&, Progress*)> shorten =
      {};
  std::function<void(const ModelTask&)> run;
  std::function<Value(const StepRecord&)> report = {};
  std::vector<ModelMethod> methods = {};
};

/// All of them, Enhanced ChainMail first.
const std::deque<StepModel>& step_models();
/// The model that moves the body in the step.
const StepModel& model_of(const Step& step);
/// True if another model than Enhanced ChainMail does.
bool has_own_model(const Step& step);
/// The step takes the model of another one with its settings.
void take_model(const Step& from, Step& step);
/// The names of the models from `first` on, each within quotes, for messages: "ecm, springs or
/// fem".
std::string model_names(const char* quote, std::size_t first = 0);
/// Adds a model of the program's own, before the first scene is read.
void add_model(StepModel model);

/// A row for a model of one's own behind the interface of models (lib/model/model.h). `Settings` is
/// a struct with four functions beside it: fields(Settings&), make_model(const Settings&, const
/// HeldBody&), step_count(const Settings&) and cost_of(const Settings&, const Body&).
template <class Settings>
StepModel own_model(const std::string& name, const std::string& title);

/// The models that the library has (lib/session/models).
std::deque<StepModel> built_in_models();

// How own_model() does that.

using OwnModel = std::unique_ptr<Model<Handle>>;
const std::any& own_settings_of(const Step& step);
std::any& own_settings_of(Step& step);
Value own_report(const StepRecord& record);
const Step& as_step(const StepRecord& record);
void run_own_model(const ModelTask& task,
                   const std::function<OwnModel(const Step&, const HeldBody&)>& make,
                   const std::function<int(const Step&)>& steps);

template <class Settings>
Settings& own_settings(Step& step) {
  return *std::any_cast<Settings>(&own_settings_of(step));
}

template <class Settings>
const Settings& own_settings(const Step& step) {
  return *std::any_cast<Settings>(&own_settings_of(step));
}

template <class Settings>
StepModel own_model(const std::string& name, const std::string& title) {
  StepModel model;
  model.name = name;
  model.title = model.menu = title;
  model.options = name + "-";
  model.moves = [](const Step& step) {
    return std::any_cast<Settings>(&own_settings_of(step)) != nullptr;
  };
  model.choose = [](Step& step) { own_settings_of(step) = Settings(); };
  model.fields = [](Step& step) { return fields(own_settings<Settings>(step)); };
  model.option_fields = model.fields;
  model.settings = [](const StepRecord& record) {
    Settings copy = own_settings<Settings>(as_step(record));
    return fields_value(fields(copy));
  };
  model.cost = [](const Step& step, const Body& body) {
    return cost_of(own_settings<Settings>(step), body);
  };
  model.run = [](const ModelTask& task) {
    run_own_model(
        task,
        [](const Step& step, const HeldBody& held) {
          return make_model(own_settings<Settings>(step), held);
        },
        [](const Step& step) { return step_count(own_settings<Settings>(step)); });
  };
  model.report = own_report;
  return model;
}

}  // namespace supple
