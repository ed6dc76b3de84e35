// Price of moving every node, told before it is paid, and the model with which a session begins.
#pragma once

#include <optional>
#include <string>

#include "tools/scene/live/live_session.h"

namespace supple::tools {

struct ModelPrice {
  std::string text;  // "springs on 2.3 million elements: some 160 s and 2.5 GB for each drag"
  double seconds = 0;
};

/// Plans at this machine's costs; none where the event chooses ChainMail.
std::optional<ModelPrice> price_of(const LiveEvent& model, const Session& session);

/// An event that chooses finite elements for a picture, of a volume whose material has a stiffness.
std::optional<LiveEvent> first_model(LiveSession& live);

}  // namespace supple::tools
