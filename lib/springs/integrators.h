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
/// The method of that name; none for an unknown one.
std::optional<SpringMethod> spring_method(const std::string& name);
/// The names of all methods, in the order of the enumerators.
const std::vector<std::string>& spring_method_names();

/// Makes one with its default parameters. Throws InputError as validate(system), and Cancelled.
std::unique_ptr<SpringIntegrator> make_integrator(SpringMethod method, SpringSystem& system,
                                                  const Progress* progress = nullptr);

}  // namespace supple
