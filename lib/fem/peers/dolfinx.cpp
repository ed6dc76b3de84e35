#include "lib/fem/peers/dolfinx.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "lib/fem/peers/dolfinx_solve.h"
#include "volumes/base/files.h"
#include "volumes/base/json.h"
#include "volumes/base/parallel.h"
#include "volumes/base/process.h"
#include "volumes/base/stopwatch.h"

namespace supple {

namespace {

/// The Python that Debian's packages belong to, and how the program says that one is missing.
constexpr const char* kPython = "/usr/bin/python3";
constexpr int kNoDolfinx = 3;

template <class T>
void write_values(const std::string& path, const std::vector<T>& values) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(values.data()),
            std::streamsize(values.size() * sizeof(T)));
  if (!out.flush()) throw SystemError(path + ": cannot write");
}

/// The last line with what Python or PETSc says of an error.
std::string complaint_in(const std::string& text) {
  std::string last = "no message";
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::size_t mark = text.find("Error: ", begin);
    if (mark < end) last = text.substr(begin, end - begin);
    begin = end + 1;
  }
  return last;
}

/// Open MPI refuses to start as root, and more processes than it counts cores, unless told
/// otherwise.
std::vector<std::string> command_of(const std::vector<std::string>& python, std::size_t processes) {
  std::vector<std::string> command = {"OMP_NUM_THREADS=1"};
  if (processes > 1) {
    for (const char* setting : {"OMPI_ALLOW_RUN_AS_ROOT=1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
                                "OMPI_MCA_rmaps_base_oversubscribe=1", "mpirun", "-n"}) {
      command.emplace_back(setting);
    }
    command.push_back(std::to_string(processes));
  }
  command.insert(command.end(), python.begin(), python.end());
  return command;
}

}  // namespace

bool DolfinxSolver::run(Progress* progress) {
  stage(progress, "starting DOLFINx");
  const ScratchFolder folder;
  write_problem(folder.path());
  const auto processes = std::size_t(thread_limit());
  const std::vector<std::string> python = {kPython, folder / "solve.py", folder.path(),
                                           number_text(m_tolerance),
                                           std::to_string(m_max_iterations)};
  const Stopwatch clock;
  const ProgramEnd end = run_program("env", command_of(python, processes), "", {}, [&, progress] {
    if (m_start_ms == 0 && std::filesystem::exists(folder / "started")) {
      m_start_ms = clock.ms();
      stage(progress, "solving");
    }
    return progress != nullptr && progress->cancelled();
  });
  const bool lacks_program = end.exit_code == kNoSuchProgram || end.exit_code == kNoDolfinx;
  if (lacks_program) {
    throw InputError({"", "solver", "dolfinx without Python's module dolfinx",
                      "Debian's python3-dolfinx, and mpirun for several threads"});
  }
  if (end.signal != 0) throw Error("DOLFINx ended by signal " + std::to_string(end.signal));
  const Value said = json_or_null(end.out);
  if (end.exit_code != 0 || !said.is_table()) {
    throw Error("DOLFINx: " + complaint_in(end.err));
  }
  m_iterations = int(said.at("iterations").whole());
  m_bytes = std::size_t(said.at("peak_bytes").number());
  read_result(folder / "u.f64");
  return said.at("converged").truth();
}

void DolfinxSolver::write_problem(const std::string& folder) const {
  const auto file = [&](const char* name) { return folder + "/" + name; };
  std::ofstream(file("solve.py")) << kDolfinxSolve;
  std::vector<double> shear, bulk;
  for (const std::uint8_t of : m_problem.classes) {
    shear.push_back(m_problem.moduli.shear[of]);
    bulk.push_back(m_problem.moduli.bulk[of]);
  }
  write_values(file("nodes.f64"), m_problem.nodes);
  write_values(file("corners.i32"), m_problem.corners);
  write_values(file("shear.f64"), shear);
  write_values(file("bulk.f64"), bulk);
  write_values(file("held.u8"), m_loads.held);
  write_values(file("held.f64"), m_loads.u_mm);
  write_values(file("forces.f64"), m_loads.force_mn);
  if (m_problem.is_pointwise) {
    std::ofstream(file("pointwise")) << "";
  }
}

/// Displacements of all nodes, and what the own operator says of them.
void DolfinxSolver::read_result(const std::string& path) {
  m_u.resize(m_loads.u_mm.size());
  std::ifstream in(path, std::ios::binary);
  in.read(reinterpret_cast<char*>(m_u.data()), std::streamsize(m_u.size() * sizeof(double)));
  const bool is_finite =
      std::all_of(m_u.begin(), m_u.end(), [](double value) { return std::isfinite(value); });
  if (!in || !is_finite) {
    throw Error("DOLFINx gave no finite displacements of " +
                std::to_string(m_problem.nodes.size()) + " nodes");
  }
  m_residual.resize(m_u.size());
  set_to_forces(m_loads, m_residual);
  m_problem.stiffness->subtract(m_u.data(), m_residual.data());
  m_size = ResidualMeter(m_loads)(m_residual);
  m_size.reaction_change = 0;  // of a single solution
}

}  // namespace supple
