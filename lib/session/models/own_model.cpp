// The rows of the library, and the run of a model that a program has added.
#include "lib/session/handles/drag_handles.h"
#include "lib/session/models/drags.h"

namespace supple {

std::deque<StepModel> built_in_models() {
  return {chainmail_model(), spring_model(), fem_model(), tet_model()};
}

void run_own_model(const ModelTask& task,
                   const std::function<OwnModel(const Step&, const HeldBody&)>& make,
                   const std::function<int(const Step&)>& steps) {
  Body& body = task.in.body;
  stage(task.progress, model_of(task.record).title);
  std::vector<Region> anchors;
  const OwnModel model = make(task.record, task.in.held_with_pieces(anchors));
  const double before_j = model->energy().total_j();
  model->move(task.handles, steps(task.record), task.progress);
  const int done = run_model(*model, steps(task.record), task.progress);
  const LinkCheck links = check_links(body);
  body.links_known_valid = links.violated == 0;
  body.beyond.reset();
  task.record.own_report = {{"steps", done},
                            {"energy_before_j", before_j},
                            {"energy_after_j", model->energy().total_j()},
                            {"links_violated", links.violated}};
  if (task.record.tells_reactions) {
    std::vector<Handle> told;
    for (const SlotSet& held : task.ledger.elements()) {
      told.emplace_back(region_of(held, body.elements, ""), std::array<std::int32_t, 3>{});
    }
    task.record.reactions = task.ledger.name(model->reactions(told));
  }
  task.start_anew();
}

}  // namespace supple
