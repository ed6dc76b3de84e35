#include "lib/springs/integrators.h"

#include <algorithm>

#include "lib/springs/implicit_euler.h"
#include "lib/springs/projective.h"
#include "lib/springs/symplectic_euler.h"
#include "lib/springs/xpbd.h"

namespace supple {

const std::vector<std::string>& spring_method_names() {
  static const std::vector<std::string> names = {"symplectic", "implicit", "xpbd", "projective"};
  return names;
}

const char* name_of(SpringMethod method) {
  return spring_method_names()[std::size_t(method)].c_str();
}

std::optional<SpringMethod> spring_method(const std::string& name) {
  const std::vector<std::string>& names = spring_method_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return SpringMethod(found - names.begin());
}

std::unique_ptr<SpringIntegrator> make_integrator(SpringMethod method, SpringSystem& system,
                                                  const Progress* progress) {
  switch (method) {
    case SpringMethod::symplectic:
      return std::make_unique<SymplecticEuler>(system, progress);
    case SpringMethod::implicit:
      return std::make_unique<ImplicitEuler>(system, progress);
    case SpringMethod::xpbd:
      return std::make_unique<Xpbd>(system, progress);
    default:
      return std::make_unique<ProjectiveDynamics>(system);
  }
}

}  // namespace supple
