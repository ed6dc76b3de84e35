#include "volumes/field/certificate.h"

#include <nlohmann/json.hpp>

namespace supple {

std::string certificate_json(const InversionCertificate& certificate) {
  nlohmann::ordered_json json = {{"residual_max_voxels", certificate.residual_max},
                                 {"residual_p999_voxels", certificate.residual_p999},
                                 {"cells", certificate.cells},
                                 {"folded_cells", certificate.folded_cells},
                                 {"folded_air_cells", certificate.folded_air_cells},
                                 {"torn_cells", certificate.torn_cells},
                                 {"overlapped_voxels", certificate.overlapped_voxels},
                                 {"unresolved_voxels", certificate.unresolved_voxels},
                                 {"min_det", certificate.min_det}};
  if (certificate.hidden_elements >= 0) json["hidden_elements"] = certificate.hidden_elements;
  if (certificate.of_part) json["of_part"] = true;
  return json.dump();
}

}  // namespace supple
