// The integrators of a spring system by name.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/springs/integrator.h"

namespace supple {

enum class SpringMethod { symplectic, implicit, xpbd, projective };

const char* name_of(SpringMethod method);
/// None for an unknown name.
std::optional<SpringMethod> spring_method(const std::string& name);
/// In the order of the enumerators.
const std::vector<std::string>& spring_method_names();

/// With the default parameters of its class. Throws InputError as validate(system), and Cancelled.
std::unique_ptr<SpringIntegrator> make_integrator(SpringMethod method, SpringSystem& system,
                                                  const Progress* progress = nullptr);

}  // namespace supple
