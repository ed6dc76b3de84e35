// Messages of a page to the server: one JSON object with one verb (README.md), from anybody who has
// got through to the socket. Nothing here trusts its input: depth, size and every value is checked
// before anything is done.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/scene/file/live_event.h"
#include "tools/viewer/folders.h"
#include "volumes/base/value.h"

namespace supple::tools {

constexpr std::size_t kMostMessageBytes = std::size_t(1) << 20;
constexpr int kMostMessageDepth = 12;

/// Thrown for what is no message: its connection is closed with this code of RFC 6455.
class BadMessage : public Error {
 public:
  explicit BadMessage(const std::string& why) : Error(why) {}
  static constexpr int kCloseCode = 1007;
};

struct PageMessage {
  std::optional<std::uint32_t> n;  // which its answer names
  std::string verb;
  Value value;
};

/// Verbs of a session of a volume.
const std::vector<std::string>& viewer_verbs();
/// Throws BadMessage.
PageMessage parse_page_message(std::string_view text,
                               const std::vector<std::string>& verbs = viewer_verbs());

/// The value of a verb as a table, so that keys are read strictly. Throws InputError for values
/// that are none and for control characters.
Table table_of(const PageMessage& message);

/// An event, its files within the folders. Throws InputError as read_event.
LiveEvent event_of(const PageMessage& message, const LabelNames& names, const Folders& folders);

}  // namespace supple::tools
