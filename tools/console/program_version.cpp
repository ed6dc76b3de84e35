#include "tools/console/program_version.h"

#include "tools/console/build_facts.h"
#include "volumes/base/version.h"

namespace supple::tools {

std::string program_version() {
  return std::string(kVersion) + ", commit " + kCommit;
}

}  // namespace supple::tools
