#include "lib/fem/response/response_key.h"

namespace supple {

std::string ResponseKey::change_to(const ResponseKey& now) const {
  for (std::size_t n = 0; n < now.m_parts.size(); ++n) {
    if (n >= m_parts.size() || m_parts[n] != now.m_parts[n]) return "other " + now.m_parts[n].first;
  }
  return {};
}

}  // namespace supple
