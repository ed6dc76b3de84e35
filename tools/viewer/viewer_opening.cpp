// How a viewer opens: what its options name, files that pages name, and sessions that were left.
#include <filesystem>

#include "lib/material/presets.h"
#include "tools/scene/file/scene.h"
#include "tools/viewer/viewer.h"

namespace supple::tools {

namespace {

std::string real_path(const std::string& path) {
  std::error_code error;
  const std::filesystem::path real = std::filesystem::canonical(path, error);
  return error ? std::filesystem::absolute(path).string() : real.string();
}

}  // namespace

/// Opens the input before there is a session's thread.
void Viewer::begin() {
  const std::string input = m_options.input.empty() ? "" : real_path(m_options.input);
  m_left = left_session(m_options.sessions, input, m_folders);
  if (m_options.go_on && !m_left) {
    throw InputError({m_options.input, "--go-on", "no session that was left with something unsaved",
                      "one in " + (m_options.sessions.empty() ? "a folder" : m_options.sessions)});
  }
  if (m_options.go_on) {
    go_on_with(*std::exchange(m_left, std::nullopt), true);
  } else if (!m_options.input.empty()) {
    open(opened_file(m_options.input, m_options.material, m_options.preset, &m_progress), input);
  }
  m_scene = std::move(m_next);
  if (m_left) note(&m_console, text_of(*m_left) + "; --go-on goes on with it");
}

/// Makes m_next, on the session's thread or before there is one. On failure the old scene stays.
void Viewer::open(const OpenedFile& file, const std::string& input, const std::string& replaces,
                  int dropped) {
  m_progress.begin();
  ViewSettings settings;
  {
    const std::lock_guard lock(m_guard);
    settings = m_settings;
  }
  settings.amount = 1;
  settings.curtain = false;
  m_next = std::make_unique<OpenScene>(file.root, m_options.budget_ms, settings,
                                       SceneOutlets{m_pages, m_encoder, m_progress, m_console});
  if (file.is_scan) m_next->begin_outside();
  m_next->note_opening(file, ++m_openings);
  m_next->keep(
      std::make_unique<KeptJournal>(dropped > 0 ? "" : m_options.sessions, input, replaces,
                                    [this](const std::string& line) { m_progress.warn(line); }));
  m_progress.end();
  const int before = m_open_drop.exchange(dropped);
  if (before != dropped) m_dropped->forget(before);
  m_pages.forget_frames();
  const std::lock_guard lock(m_guard);
  m_settings = m_next->settings();
  m_next->seen(m_next_number - 1);  // pictures of it are newer than all that was asked before
  m_label_names = m_next->live().scene().label_names;
  m_has_scene = true;
}

void Viewer::take_open(int page, const PageMessage& message) {
  Table table = table_of(message);
  const int dropped = int(table.get<long long>("drop").value_or(0));
  std::string path;
  if (dropped == 0) {
    path = m_folders.input(table.require(table.get<std::string>("path"), "path", "a file"));
  }
  std::string material = table.get<std::string>("material").value_or("");
  const bool is_file =
      !material.empty() && material != kUniform && find_tissue_preset(material) == nullptr;
  if (is_file) material = m_folders.input(material);
  const std::string preset = table.get<std::string>("preset").value_or("");
  table.finish();
  if (dropped != 0) {
    // The copies go with the program: no journal is kept that would name them.
    return open_later(page, message, [this, dropped, material] {
      m_progress.begin();
      try {
        const std::string folder = m_dropped->folder_of(dropped), file = file_to_open(folder);
        OpenedFile opened = opened_file(file, material, "", &m_progress);
        require_within(opened.root, m_folders.with(folder));
        open(opened, file, "", dropped);
      } catch (const std::exception&) {
        m_dropped->forget(dropped);
        throw;
      }
    });
  }
  open_later(page, message, [this, path, material, preset] {
    m_progress.begin();
    OpenedFile file = opened_file(path, material, preset, &m_progress);
    require_within(file.root, m_folders);
    open(file, path);
  });
}

/// Opens on the session's thread; what is open stays where it fails.
void Viewer::open_later(int page, const PageMessage& message, const std::function<void()>& opens) {
  m_mailbox.post([this, page, message, opens] {
    try {
      opens();
      if (m_scene) m_scene->leave();
      answer(page, message, true);
    } catch (const std::exception& error) {
      m_progress.end();
      answer_error(page, message, error.what());
    }
  });
  interrupt();
}

void Viewer::go_on_with(const LeftSession& left, bool is_own_input) {
  OpenedFile file{Table::parse(journal_of(left), left.path), "", false, ""};
  if (!is_own_input) require_within(file.root, m_folders);
  open(file, left.input, left.path);
}

/// Takes the answer true: the left session is opened; false: nobody is asked about it any more.
void Viewer::take_go_on(int page, const PageMessage& message) {
  if (!message.value.is_truth()) throw InputError({"go_on", "", "no truth value", "true, false"});
  std::optional<LeftSession> left;
  {
    const std::lock_guard lock(m_guard);
    left = std::exchange(m_left, std::nullopt);
  }
  if (!message.value.truth()) return answer(page, message, true);
  if (!left) throw InputError({"go_on", "", "no session that was left", "one that hello tells of"});
  open_later(page, message, [this, left] { go_on_with(*left, !m_options.input.empty()); });
}

}  // namespace supple::tools
