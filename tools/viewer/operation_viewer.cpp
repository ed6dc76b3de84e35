#include "tools/viewer/operation_viewer.h"

#include <filesystem>

#include "tools/scene/pictures/jpeg.h"
#include "tools/viewer/gatekeeper.h"
#include "tools/viewer/operation_json.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/version.h"

namespace supple::tools {

namespace {

constexpr auto kStatusEvery = std::chrono::milliseconds(100);

const std::vector<std::string>& operation_verbs() {
  static const std::vector<std::string> verbs = {"instrument", "membrane", "view", "operation",
                                                 "ack"};
  return verbs;
}

}  // namespace

OperationViewer::OperationViewer(const Table& root, const Folders& folders)
    : m_folders(folders),
      m_session_id(make_token().substr(0, 8)),
      m_live(root),
      m_loop(m_live, *this) {
  m_loop.watch(false);
  m_pages.tell_scene(operation_json(m_live), 0);
  m_thread = std::thread([this] { run(); });
}

OperationViewer::~OperationViewer() {
  end("");
  if (m_thread.joinable()) m_thread.join();
}

void OperationViewer::run() {
  try {
    m_loop.run();
  } catch (...) {
    m_failure = std::current_exception();
  }
  m_has_ended = true;
}

void OperationViewer::end(const std::string& reason) {
  if (m_ends.exchange(true)) return;
  if (!reason.empty()) m_pages.tell_all(Pages::text_of({{"bye", {{"reason", reason}}}}));
  m_loop.end();
}

void OperationViewer::join_thread() {
  m_thread.join();
  if (m_failure) std::rethrow_exception(m_failure);
}

int OperationViewer::join(std::shared_ptr<PageOutlet> page) {
  const Value hello = {
      {"version", kVersion}, {"session", m_session_id}, {"pages", m_pages.count() + 1}};
  const int number = m_pages.join(std::move(page), Pages::text_of({{"hello", hello}}));
  watch();
  return number;
}

void OperationViewer::leave(int page) {
  m_pages.leave(page);
  watch();
}

void OperationViewer::watch() {
  m_loop.post([this] {
    m_loop.watch(m_pages.count() > 0);
    tell_status(true);
  });
}

void OperationViewer::receive(int page, std::string_view text) {
  const PageMessage message = parse_page_message(text, operation_verbs());
  if (message.verb == "ack") {
    const bool is_number = message.value.is_whole() && message.value.whole() >= 0;
    if (!is_number) throw BadMessage("an ack without a number");
    return m_pages.acknowledge(page, std::uint32_t(message.value.whole()));
  }
  try {
    do_later(page, message, work_of(message));
  } catch (const std::exception& error) {
    refuse(page, message, error.what());
  }
}

void OperationViewer::refuse(int page, const PageMessage& message, const std::string& why) {
  if (message.n) return m_pages.tell(page, Pages::text_of({{"re", *message.n}, {"error", why}}));
  m_pages.tell(page, Pages::text_of({{"log", {{"level", "error"}, {"text", why}}}}));
}

void OperationViewer::do_later(int page, const PageMessage& message, const Work& work) {
  const std::uint64_t number = m_next_number++;
  if (message.n) m_pages.note(page, number, *message.n);
  m_loop.post([this, page, message, work, number, came = Clock::now()] {
    try {
      const Value ok = work();
      if (message.n) m_pages.tell(page, Pages::text_of({{"re", *message.n}, {"ok", ok}}));
    } catch (const std::exception& error) {
      refuse(page, message, error.what());
    }
    m_done = number;
    m_unpictured.push_back(came);
  });
}

OperationViewer::Work OperationViewer::work_of(const PageMessage& message) {
  if (message.verb == "instrument") return instrument_work(table_of(message));
  if (message.verb == "membrane") return membrane_work(table_of(message));
  if (message.verb == "view") return view_work(table_of(message));
  return operation_work(table_of(message));
}

OperationViewer::Work OperationViewer::instrument_work(Table table) {
  std::string name;
  bool follows = false;
  PoseWish wish;
  table.read({Field("name", name, "Of the instrument").required(),
              Field("follow", follows, "Its track leads it again")});
  table.read(fields(wish));
  table.finish();
  const int instrument = m_live.find(name);
  return [this, instrument, wish, follows] {
    if (follows) {
      m_live.let_go(instrument);
    } else {
      m_live.ask(instrument, wish);
    }
    m_loop.tell_hand();
    return Value(true);
  };
}

OperationViewer::Work OperationViewer::membrane_work(Table table) {
  std::string name;
  MembraneModel model = MembraneModel::springs;
  table.read({Field("name", name, "Of the membrane").required(),
              Field("model", model, {"springs", "ecm"}, "Model that moves it").required()});
  table.finish();
  const int membrane = m_live.find_membrane(name);
  return [this, membrane, model] {
    m_live.take_model(membrane, model);
    tell_status(true);
    return Value(true);
  };
}

OperationViewer::Work OperationViewer::view_work(Table table) {
  LookWish wish;
  table.read(fields(wish));
  table.finish();
  return [this, wish] {
    m_live.look(wish);
    tell_status(true);
    return Value(true);
  };
}

OperationViewer::Work OperationViewer::operation_work(Table table) {
  std::string what, path;
  bool force = false;
  table.read(
      {Field("do", what, "What happens").one_of({"pause", "go", "restart", "save"}).required(),
       Field("path", path, "Of the scene that is saved"),
       Field("force", force, "Overwrite existing files")});
  table.finish();
  if (what == "save") {
    if (path.empty()) table.fail_missing("path", "the path of a scene");
    if (std::filesystem::path(path).extension() != ".toml") table.fail("path", path, "a .toml");
    return [this, path, force] { return save(m_folders.output(path), force); };
  }
  return [this, what] {
    if (what == "restart") m_live.restart();
    m_loop.pause(what == "restart" ? m_loop.is_paused() : what == "pause");
    tell_status(true);
    return Value(true);
  };
}

Value OperationViewer::save(const std::string& path, bool may_overwrite) {
  Value files = Value::List();
  for (const std::string& file : m_live.files(path)) {
    m_folders.output(file);
    if (!may_overwrite && std::filesystem::exists(file)) {
      throw InputError({file, "path", "a file that exists", "another name, or force"});
    }
    files.push_back(file);
  }
  m_live.save(path);
  return {{"path", path}, {"files", files}, {"steps", m_live.steps()}};
}

void OperationViewer::stepped(const OperationSample& sample) {
  const std::vector<OperationEvent> news = m_news.of(sample);
  if (!news.empty()) m_pages.tell_all(Pages::text_of({{"events", events_json(news)}}));
  tell_status(false);
}

void OperationViewer::tell_status(bool at_once) {
  const Clock::time_point now = Clock::now();
  if (!at_once && now - m_told < kStatusEvery) return;
  m_told = now;
  Value status = operation_status(m_live);
  const auto times = [](const RecentTimes& ms) -> Value {
    return {{"median", ms.quantile_ms(0.5)}, {"p95", ms.quantile_ms(0.95)}};
  };
  status["is_paused"] = m_loop.is_paused();
  if (m_loop.is_paused()) status["digest"] = m_live.operation().digest();
  status["ms"] = {{"step", times(m_loop.step_times())},
                  {"picture", times(m_loop.picture_times())},
                  {"encoding", times(m_encodings)},
                  {"latency", times(m_latencies)}};
  status["dropped_s"] = m_loop.dropped_s();
  m_pages.tell_all(Pages::text_of({{"status", status}}));
}

void OperationViewer::pictured(const Image& image, const PixelSize& size) {
  FrameMessage frame;
  frame.stamp = m_pages.next_stamp();
  frame.number = m_done;
  frame.width = size[0];
  frame.height = size[1];
  const Stopwatch encoding;
  frame.picture = jpeg_of(image);
  m_encodings.add(encoding.ms());
  for (const Clock::time_point& came : m_unpictured) {
    frame.ms = std::max(frame.ms, ms_since(came));
    m_latencies.add(ms_since(came));
  }
  m_unpictured.clear();
  m_pages.publish(std::move(frame));
}

}  // namespace supple::tools
