// The events of a journal, or a scene, one after the other, and one of one's own: live_session
// JOURNAL
#include <cstdio>

#include <supple/scene/live/live_session.h>
#include <supple/volumes/base/json.h>
#include <supple/volumes/base/table.h>

int main(int argc, char** argv) try {
  if (argc != 2) return std::fprintf(stderr, "usage: live_session JOURNAL\n"), 2;
  // [session]
  supple::tools::LiveSession live(supple::Table::read(argv[1]), nullptr);
  live.record_with([](const supple::Value& keys, bool) {
    std::printf("%s\n", supple::json_text(keys).c_str());
  });
  for (const supple::tools::LiveEvent& event : live.events()) {
    live.carry_out(event);
    while (live.has_more()) live.go_on();  // settles, in slices between which new events may come
  }
  const auto before = live.session().body().q;
  supple::Table undo = supple::Table::parse("kind = \"undo\"\n", "an event of its own");
  live.carry_out(supple::tools::read_event(undo, {}));
  // [session]
  const bool is_undone = !(live.session().body().q == before);
  std::printf("%s\n", is_undone ? "undone" : "nothing to undo");
  return is_undone ? 0 : 1;
} catch (const supple::Error& error) {
  return std::fprintf(stderr, "live_session: %s\n", error.what()), 1;
}
