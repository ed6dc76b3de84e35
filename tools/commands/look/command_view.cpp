// supple view: a live session in the browser.
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <fcntl.h>
#include <unistd.h>

#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/viewer/gatekeeper.h"
#include "tools/viewer/operation_viewer.h"
#include "tools/viewer/server.h"
#include "tools/viewer/viewer.h"
#include "volumes/base/json.h"
#include "volumes/base/process.h"
#include "volumes/base/signals.h"

namespace supple::tools {

namespace {

struct ViewCommand {
  ViewerOptions viewer;
  ServerOptions server;
  std::vector<std::string> folders;
  std::string token_file;
  bool no_browser = false, no_journal = false;
};

Fields fields(ViewCommand& command) {
  return {
      Field("port", command.server.port,
            "Of 127.0.0.1; 0: the first free one of 21177 to 21184, or any")
          .range(0, 65535),
      Field("budget", command.viewer.budget_ms,
            "From event to first pixels; 0: as long as it takes")
          .unit("ms")
          .at_least(0),
      Field("size", command.viewer.size, "Pixels until a page tells its own").range(1, 4096),
      Field("grace", command.server.grace_s, "That the session outlives its last page; 0: for ever")
          .unit("s")
          .at_least(0),
      Field("drop_limit", command.viewer.drop_limit_mb,
            "Of files that are dropped on the page, together; 0: none are taken")
          .unit("MB")
          .range(0, 1e6),
  };
}

/// A file that leads the browser to the page. On a command line others could read the token.
class Doorway {
 public:
  explicit Doorway(const std::string& address) {
    std::string name = (std::filesystem::temp_directory_path() / "supple-XXXXXX.html").string();
    const int file = ::mkostemps(name.data(), 5, O_CLOEXEC);
    if (file < 0) return;
    m_path = name;
    const std::string text =
        "<!doctype html><meta http-equiv=\"refresh\" content=\"0;url=" + address +
        "\"><title>supple</title>\n";
    if (::write(file, text.data(), text.size()) < 0) m_path.clear();
    ::close(file);
  }
  ~Doorway() {
    if (!m_path.empty()) ::unlink(m_path.c_str());
  }
  Doorway(const Doorway&) = delete;
  Doorway& operator=(const Doorway&) = delete;

  /// Opens the page by xdg-open. Without a display that might be in a terminal, so nothing opens.
  void open() const {
    const bool has_display = std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY");
    if (m_path.empty() || !has_display) return;
    constexpr int kNowhere = ProgramStart::kNowhere;
    start_program({{"xdg-open", m_path}, "", {}, kNowhere, kNowhere, kNowhere});
  }

 private:
  std::string m_path;
};

std::vector<std::string> folders_of(const ViewCommand& command) {
  std::vector<std::string> folders = command.folders;
  if (!folders.empty()) return folders;
  folders.emplace_back(".");
  if (!command.viewer.input.empty()) {
    folders.push_back(std::filesystem::absolute(command.viewer.input).parent_path().string());
  }
  return folders;
}

/// A scene of an operation has a session of its own.
std::unique_ptr<PageSession> session_of(const ViewerOptions& options, const Folders& folders,
                                        Console& console) {
  if (std::filesystem::path(options.input).extension() == ".toml") {
    Table root = Table::read(options.input);
    if (is_operation(root)) return std::make_unique<OperationViewer>(root, folders);
  }
  return std::make_unique<Viewer>(options, folders, console);
}

void tell_address(const std::string& address, int port, const GlobalOptions& global) {
  if (global.json) {
    const Value json = {{"address", address}, {"port", port}};
    std::printf("%s\n", json_text(json).c_str());
  } else {
    std::printf("%s\n", address.c_str());
  }
  std::fflush(stdout);
}

int run_view(ViewCommand command, const GlobalOptions& global, Console& console) {
  const Folders folders(folders_of(command));
  command.server.token =
      command.token_file.empty() ? make_token() : token_of_file(command.token_file);
  if (!command.no_journal) command.viewer.sessions = folder_of_kept_sessions();
  for (std::string& origin : command.server.origins) origin = plain_origin(origin);
  for (std::string& origin : command.server.embedders) origin = plain_origin(origin, "--embed");
  command.viewer.embedders = command.server.embedders;
  command.server.base_path = plain_base_path(command.server.base_path);
  Server server(command.server);
  if (!command.server.listen.empty()) {
    note(&console, "listening on " + command.server.listen +
                       ": whoever reaches it and has the token of the address has the session; "
                       "nothing is encrypted");
  }
  const std::unique_ptr<PageSession> session = session_of(command.viewer, folders, console);
  const std::string address = server.address();
  console.clear_line();
  tell_address(address, server.port(), global);
  std::optional<Doorway> doorway;
  if (!command.no_browser) {
    doorway.emplace(address);
    doorway->open();
  }
  server.run(*session, [&] { return console.cancelled(); });
  session->join_thread();
  poll(&console);
  return kOk;
}

}  // namespace

Command add_view(CLI::App& program) {
  CLI::App* app = add_subcommand(
      program, "view", "Deform a volume live, in the browser: grab, drag, cut, relax, undo",
      "  supple view head.nii.gz --material ct-head\n"
      "  supple view session.toml --folder ~/volumes\n"
      "  supple view drag.vdb --port 8080 --no-browser");
  auto command = std::make_shared<ViewCommand>();
  app->add_option("input", command->viewer.input,
                  "A volume, a state, a scene or a journal; without one the page opens it")
      ->option_text("VOLUME|STATE|SCENE");
  app->add_option("--material", command->viewer.material,
                  "Of a volume: a table, or one that `supple presets --materials` lists; uniform: "
                  "all above the least density is one tissue (the preset that fits the densities)")
      ->option_text("M.toml|NAME");
  app->add_option("--preset", command->viewer.preset, "Look to begin with")->option_text("NAME");
  app->add_option("--folder", command->folders,
                  "Folder whose files the page may open and write; may be repeated (the current "
                  "one and that of the input)")
      ->option_text("DIR")
      ->allow_extra_args(false);
  add_field_options(*app, fields(*command));
  app->add_flag("--go-on", command->viewer.go_on,
                "Go on where the last session of the input ended that left something unsaved; "
                "without an input, the last one of all in the folders");
  app->add_flag("--no-journal", command->no_journal,
                "Keep no journal of the session on disk (docs/viewer.md)");
  app->add_flag("--no-browser", command->no_browser, "Print the address, open no browser");
  app->add_option("--token", command->token_file,
                  "Keep the address's token in this file, so that pages outlive a restart")
      ->option_text("FILE");
  app->add_option(
         "--listen", command->server.listen,
         "Address to listen on instead of this machine's own, such as 0.0.0.0 in a container")
      ->option_text("ADDRESS");
  app->add_option("--origin", command->server.origins,
                  "What the address in the browser begins with behind a proxy or another forwarded "
                  "port, such as http://localhost:9000; may be repeated")
      ->option_text("ORIGIN")
      ->allow_extra_args(false);
  app->add_option(
         "--embed", command->server.embedders,
         "Let pages of this origin show the viewer in theirs, by <supple-view> or a frame, "
         "such as https://ward.example; may be repeated")
      ->option_text("ORIGIN")
      ->allow_extra_args(false);
  app->add_option("--base-path", command->server.base_path,
                  "Path below which a proxy shows the page, such as /user/me/proxy/8080/")
      ->option_text("PATH");
  app->add_option("--page", command->server.page_folder,
                  "Serve the page from this folder, while one works on it")
      ->option_text("DIR");
  return {app, [command](const GlobalOptions& global, Console& console) {
            return run_view(*command, global, console);
          }};
}

}  // namespace supple::tools
