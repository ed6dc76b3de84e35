// JSON whose keys keep their order: how events, steps and views are kept beside what they say.
#pragma once

#include <nlohmann/json.hpp>

namespace supple::tools {

using Json = nlohmann::ordered_json;

}  // namespace supple::tools
