#include "lib/springs/integrators.h"

#include "lib/springs/implicit_euler.h"
#include "lib/springs/projective.h"
#include "lib/springs/symplectic_euler.h"
#include "lib/springs/xpbd.h"

namespace supple {

namespace {

constexpr SpringMethod kMethods[] = {SpringMethod::symplectic, SpringMethod::implicit,
                                     SpringMethod::xpbd, SpringMethod::projective};

}  // namespace

const char* name_of(SpringMethod method) {
  switch (method) {
    case SpringMethod::symplectic:
      return "symplectic";
    case SpringMethod::implicit:
      return "implicit";
    case SpringMethod::xpbd:
      return "xpbd";
    default:
      return "projective";
  }
}

std::optional<SpringMethod> spring_method(const std::string& name) {
  for (const SpringMethod method : kMethods) {
    if (name == name_of(method)) return method;
  }
  return std::nullopt;
}

std::string spring_method_names() {
  std::string names;
  for (const SpringMethod method : kMethods) {
    names += (names.empty() ? "" : ", ") + std::string(name_of(method));
  }
  return names;
}

std::unique_ptr<SpringIntegrator> make_integrator(SpringMethod method, SpringSystem& system) {
  switch (method) {
    case SpringMethod::symplectic:
      return std::make_unique<SymplecticEuler>(system);
    case SpringMethod::implicit:
      return std::make_unique<ImplicitEuler>(system);
    case SpringMethod::xpbd:
      return std::make_unique<Xpbd>(system);
    default:
      return std::make_unique<ProjectiveDynamics>(system);
  }
}

}  // namespace supple
