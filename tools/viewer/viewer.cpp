#include "tools/viewer/viewer.h"

#include <algorithm>
#include <cmath>

#include "tools/viewer/gatekeeper.h"
#include "tools/viewer/page_queries.h"
#include "tools/viewer/picking.h"
#include "tools/viewer/saving.h"
#include "volumes/base/value.h"
#include "volumes/base/version.h"

namespace supple::tools {

namespace {

constexpr int kLargestSide = 4096;  // of a view, pixels
constexpr double kMostAmount = 3;

/// What is asked of the open scene, its value read and checked.
std::function<Value(OpenScene&)> question_of(const PageMessage& message, const Folders& folders) {
  if (message.verb == "material") return material_json;
  if (message.verb == "begin") {
    PageMessage look = message;
    if (look.value.is_table()) look.value["kind"] = "look";
    return [keys = event_of(look, {}, folders).view](OpenScene& scene) {
      return scene.begin_with_look(keys);
    };
  }
  Table table = table_of(message);
  if (message.verb == "pick") {
    return [request = pick_request(table)](OpenScene& scene) { return pick(scene, request); };
  }
  if (message.verb == "save") {
    return
        [request = save_request(table, folders)](OpenScene& scene) { return save(scene, request); };
  }
  return [bins = histogram_bins(table)](OpenScene& scene) { return histogram_json(scene, bins); };
}

PixelSize size_of(Table& table, const char* view, const PixelSize& before) {
  const auto given = table.get<std::vector<double>>(view);
  if (!given) return before;
  const auto is_side = [](double side) {
    return is_integer(side) && side >= 0 && side <= kLargestSide;
  };
  if (given->size() != 2 || !is_side((*given)[0]) || !is_side((*given)[1])) {
    table.fail(view, "another size", "[width, height], integers from 0 to 4096");
  }
  return {int((*given)[0]), int((*given)[1])};
}

/// Displacement times this is shown.
double amount_of(const Value& value) {
  if (value.is_truth()) return value.truth() ? 1 : 0;
  const double amount = value.is_number() ? value.number() : -1;
  if (amount >= 0 && amount <= kMostAmount) return amount;
  throw InputError({"deformed", "", "another value", "true, false or a number from 0 to 3"});
}

}  // namespace

Viewer::Viewer(const ViewerOptions& options, const Folders& folders, Console& console)
    : m_options(options),
      m_folders(folders),
      m_dropped(std::make_shared<DroppedFiles>(std::uint64_t(options.drop_limit_mb * 1e6))),
      m_console(console),
      m_session_id(make_token().substr(0, 8)),
      m_encoder(m_pages),
      m_progress(m_pages, console) {
  m_settings.sizes[0] = options.size;
  begin();
  m_thread = std::thread([this] { run(); });
}

Viewer::~Viewer() {
  end("");
  if (m_thread.joinable()) m_thread.join();
}

void Viewer::end(const std::string& reason) {
  if (m_ends.exchange(true)) return;
  if (!reason.empty()) m_pages.tell_all(Pages::text_of({{"bye", {{"reason", reason}}}}));
  m_progress.cancel();
  m_mailbox.post([this] {
    if (m_scene) m_scene->leave();
  });
  m_mailbox.close();
  const std::lock_guard lock(m_guard);
  if (m_interruptible != nullptr) m_interruptible->interrupt();
}

void Viewer::join_thread() {
  m_thread.join();
  if (m_failure) std::rethrow_exception(m_failure);
}

void Viewer::run() {
  try {
    while (!m_ends) {
      if (m_next) m_scene = std::move(m_next);
      {
        const std::lock_guard lock(m_guard);
        m_interruptible = m_scene.get();
      }
      if (m_scene) {
        m_scene->run(m_mailbox);
      } else if (auto posted = m_mailbox.take(true)) {
        if (posted->task) posted->task();
      } else {
        break;
      }
      const std::lock_guard lock(m_guard);
      m_interruptible = nullptr;
    }
  } catch (...) {
    m_failure = std::current_exception();
  }
  const std::lock_guard lock(m_guard);
  m_interruptible = nullptr;
  m_has_ended = true;
}

OpenScene& Viewer::opened() {
  if (!m_scene) throw InputError({"", "open", "nothing", "an open volume"});
  return *m_scene;
}

int Viewer::join(std::shared_ptr<PageOutlet> page) {
  Value hello = {{"version", kVersion},
                 {"session", m_session_id},
                 {"pages", m_pages.count() + 1},
                 {"budget_ms", m_options.budget_ms},
                 {"threads", std::thread::hardware_concurrency()}};
  if (!m_options.embedders.empty()) hello["embed"] = m_options.embedders;
  {
    const std::lock_guard lock(m_guard);
    if (m_left) hello["left"] = {{"text", text_of(*m_left)}, {"unsaved", m_left->unsaved}};
  }
  return m_pages.join(std::move(page), Pages::text_of({{"hello", hello}}));
}

/// The scene lets go of what a page holds when all is done that the page has asked for.
void Viewer::leave(int page) {
  m_pages.leave(page);
  m_dropped->forget_page(page, m_open_drop);
  m_mailbox.post([this, page] {
    if (m_scene) m_scene->page_left(page, now_ms());
  });
  interrupt();
}

double Viewer::now_ms() const {
  return std::floor(ms_since(m_start));
}

void Viewer::answer(int page, const PageMessage& message, const Value& ok) {
  if (message.n) m_pages.tell(page, Pages::text_of({{"re", *message.n}, {"ok", ok}}));
}

void Viewer::answer_error(int page, const PageMessage& message, const std::string& why) {
  if (message.n) m_pages.tell(page, Pages::text_of({{"re", *message.n}, {"error", why}}));
}

void Viewer::receive(int page, std::string_view text) {
  const PageMessage message = parse_page_message(text);
  try {
    dispatch(page, message);
  } catch (const BadMessage&) {
    throw;
  } catch (const std::exception& error) {
    answer_error(page, message, error.what());
  }
}

void Viewer::dispatch(int page, const PageMessage& message) {
  const std::string& verb = message.verb;
  if (verb == "event") return take_event(page, message);
  if (verb == "ack") return take_ack(page, message);
  if (verb == "open") return take_open(page, message);
  if (verb == "go_on") return take_go_on(page, message);
  if (verb == "drop") {
    Table table = table_of(message);
    return answer(page, message, answer_drop(*m_dropped, page, table, m_open_drop));
  }
  if (verb == "cancel") return take_cancel(page, message);
  if (verb == "size" || verb == "slices" || verb == "deformed" || verb == "curtain") {
    take_wish(message);
    return see_soon(page, message);
  }
  if (verb == "pick" || verb == "save" || verb == "histogram" || verb == "material" ||
      verb == "begin") {
    return answer_later(page, message, question_of(message, m_folders));
  }
  answer(page, message, query(message, m_folders));
}

void Viewer::take_ack(int page, const PageMessage& message) {
  const bool is_number = message.value.is_whole() && message.value.whole() >= 0;
  if (!is_number) throw BadMessage("an ack without a number");
  m_pages.acknowledge(page, std::uint32_t(message.value.whole()));
}

void Viewer::take_wish(const PageMessage& message) {
  if (message.verb == "size") return take_size(message);
  if (message.verb == "slices") return take_slices(message);
  if (message.verb == "curtain") return take_curtain(message);
  const double amount = amount_of(message.value);
  const std::lock_guard lock(m_guard);
  m_settings.amount = amount;
}

/// Cancels the operation under way, and the moves that wait.
void Viewer::take_cancel(int page, const PageMessage& message) {
  const std::vector<LiveEvent> dropped = m_mailbox.drop_moves();
  m_progress.cancel();
  const std::uint64_t number = take_number(page, message);
  m_mailbox.post([this, dropped, number] {
    for (const LiveEvent& event : dropped) {
      m_pages.tell_refused(std::uint64_t(event.number), "cancelled before it had begun");
    }
    if (!m_scene) return;
    m_scene->stop(dropped);
    m_scene->seen(number);
    m_scene->tell_scene();
  });
  interrupt();
  answer(page, message, true);
}

void Viewer::interrupt() {
  const std::lock_guard lock(m_guard);
  if (m_interruptible != nullptr) m_interruptible->interrupt();
}

void Viewer::answer_later(int page, const PageMessage& message, const Question& work) {
  const bool reads_body = message.verb == "save";  // and may take long
  m_mailbox.post(
      [this, page, message, work, reads_body] {
        if (reads_body) m_progress.begin();
        try {
          answer(page, message, work(opened()));
        } catch (const std::exception& error) {
          answer_error(page, message, error.what());
        }
        if (reads_body) m_progress.end();
      },
      reads_body ? TaskKind::reads : TaskKind::looks);
  // Values under a pointer that passes wait for a picture rather than to begin it anew.
  if (!message.value["values"].is_truth()) interrupt();
}

/// Numbers a message; numbers are noted before anything can be shown that has them.
std::uint64_t Viewer::take_number(int page, const PageMessage& message) {
  std::uint64_t number = 0;
  {
    const std::lock_guard lock(m_guard);
    number = m_next_number++;
  }
  if (message.n) m_pages.note(page, number, *message.n);
  return number;
}

void Viewer::take_event(int page, const PageMessage& message) {
  LabelNames names;
  {
    const std::lock_guard lock(m_guard);
    if (!m_has_scene) throw InputError({"", "open", "nothing", "an open volume"});
    names = m_label_names;
  }
  LiveEvent event = event_of(message, names, m_folders);
  event.at_ms = now_ms();
  event.page = page;
  event.number = std::int64_t(take_number(page, message));
  m_mailbox.post(std::move(event));
  interrupt();
  answer(page, message, true);
}

/// Pictures of the body at rest, too, or no longer.
void Viewer::take_curtain(const PageMessage& message) {
  if (!message.value.is_truth()) {
    throw InputError({"curtain", "", "another value", "true or false"});
  }
  const std::lock_guard lock(m_guard);
  m_settings.curtain = message.value.truth();
}

void Viewer::take_size(const PageMessage& message) {
  Table table = table_of(message);
  const std::lock_guard lock(m_guard);
  ViewSettings settings = m_settings;
  for (std::size_t view = 0; view < kViewCount; ++view) {
    settings.sizes[view] = size_of(table, kViewNames[view], settings.sizes[view]);
  }
  table.finish();
  m_settings = settings;
}

void Viewer::take_slices(const PageMessage& message) {
  Table table = table_of(message);
  const std::lock_guard lock(m_guard);
  SliceSettings slices = m_settings.slices;
  table.read(fields(slices));
  if (auto centre = table.table("centre")) {
    for (std::size_t plane = 0; plane < 3; ++plane) {
      Vec3d at(0);
      if (!centre->has(kViewNames[plane + 1])) continue;
      centre->read({Field(kViewNames[plane + 1], at, "Index in the middle").range(-1e5, 1e5)});
      slices.centre[plane] = at;
    }
    centre->finish();
  }
  if (auto turned = table.table("turned")) read_turned(*turned, slices);
  table.finish();
  m_settings.slices = slices;
}

void Viewer::see() {
  ViewSettings settings;
  std::uint64_t last = 0;
  {
    const std::lock_guard lock(m_guard);
    m_is_view_posted = false;
    settings = m_settings;
    last = m_view_number;
  }
  if (m_scene) m_scene->see(settings, last);
}

/// Asks for a look at the new settings; of several requests before it only the last counts.
void Viewer::see_soon(int page, const PageMessage& message) {
  const std::uint64_t number = take_number(page, message);
  bool is_posted = false;
  {
    const std::lock_guard lock(m_guard);
    m_view_number = number;
    is_posted = std::exchange(m_is_view_posted, true);
  }
  if (!is_posted) {
    m_mailbox.post([this] { see(); }, TaskKind::looks);
    interrupt();
  }
  ViewSettings now;
  {
    const std::lock_guard lock(m_guard);
    now = m_settings;
  }
  answer(page, message, message.verb == "slices" ? slices_json(now.slices) : Value(true));
}

}  // namespace supple::tools
