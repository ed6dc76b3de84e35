// Messages of a page to the viewer, up to where they would be carried out; heads of requests.
#include <filesystem>

#include "tools/viewer/gatekeeper.h"
#include "tools/viewer/page_message.h"

namespace {

using namespace supple;
using namespace supple::tools;

void take_message(std::string_view text) {
  static const Folders folders({std::filesystem::temp_directory_path().string()});
  const PageMessage message = parse_page_message(text);
  if (message.verb == "event") {
    event_of(message, {}, folders);
  } else if (message.value.is_table()) {
    table_of(message);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  static const Gatekeeper gatekeeper(8080, std::string(32, 'a'));
  if (gatekeeper.has_token(text) && text.find(gatekeeper.protocol()) == std::string_view::npos) {
    __builtin_trap();
  }
  if (gatekeeper.is_own_origin(text) && !text.empty() && text.find(":8080") + 5 != text.size()) {
    __builtin_trap();
  }
  try {
    take_message(text);
  } catch (const Error&) {
  }
  return 0;
}
