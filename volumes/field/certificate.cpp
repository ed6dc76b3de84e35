#include "volumes/base/value.h"
#include "volumes/field/offset_field.h"

namespace supple {

Value to_value(const InversionCertificate& certificate) {
  Value value = {{"residual_max_voxels", certificate.residual_max},
                 {"residual_p999_voxels", certificate.residual_p999},
                 {"cells", certificate.cells},
                 {"folded_cells", certificate.folded_cells},
                 {"folded_air_cells", certificate.folded_air_cells},
                 {"torn_cells", certificate.torn_cells},
                 {"overlapped_voxels", certificate.overlapped_voxels},
                 {"unresolved_voxels", certificate.unresolved_voxels},
                 {"min_det", certificate.min_det}};
  if (certificate.hidden_elements >= 0) value["hidden_elements"] = certificate.hidden_elements;
  if (certificate.of_part) value["of_part"] = true;
  return value;
}

}  // namespace supple
