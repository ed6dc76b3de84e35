#include "lib/fem/peers/calculix.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <numeric>
#include <sstream>

#include "volumes/base/files.h"
#include "volumes/base/process.h"

namespace supple {

namespace {

/// Corners 4 di + 2 dj + dk of a right-handed hexahedron in the order of C3D8.
constexpr int kCornerOrder[8] = {0, 4, 6, 2, 1, 5, 7, 3};

struct Closer {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using TextFile = std::unique_ptr<std::FILE, Closer>;

/// The last line that says something.
std::string last_line(const std::string& text) {
  std::istringstream stream(text);
  std::string last;
  for (std::string line; std::getline(stream, line);) {
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  }
  return last.substr(std::min(last.find_first_not_of(' '), last.size()));
}

}  // namespace

bool CalculixSolver::run(Progress* progress) {
  stage(progress, "solving");
  const ScratchFolder folder;
  write_deck(folder / "body.inp");
  const ProgramEnd end = run_program("ccx", {"-i", "body"}, folder.path(), {}, [progress] {
    return progress != nullptr && progress->cancelled();
  });
  if (end.exit_code == kNoSuchProgram) {
    throw InputError({"", "solver", "calculix without its program ccx", "ccx on the PATH"});
  }
  m_bytes = std::size_t(end.peak_mb * 1e6);
  if (end.signal != 0) throw Error("CalculiX ended by signal " + std::to_string(end.signal));
  // It ends with 0 after some errors.
  if (end.exit_code != 0 || end.out.find("Job finished") == std::string::npos) {
    throw Error("CalculiX: " + last_line(end.out + end.err));
  }
  read_results(folder / "body.dat");
  return true;
}

void CalculixSolver::write_deck(const std::string& path) const {
  const TextFile file(std::fopen(path.c_str(), "w"));
  if (!file) throw SystemError(path + ": cannot create");
  write_body(file.get());
  write_step(file.get());
  if (std::fflush(file.get()) != 0 || std::ferror(file.get()) != 0) {
    throw SystemError(path + ": cannot write");
  }
}

/// Nodes, elements by class, and their materials.
void CalculixSolver::write_body(std::FILE* out) const {
  std::fputs("*NODE, NSET=ALL\n", out);
  const std::vector<Vec3d>& positions = m_problem.nodes;
  for (std::size_t n = 0; n < positions.size(); ++n) {
    const Vec3d& x = positions[n];
    std::fprintf(out, "%zu,%.12e,%.12e,%.12e\n", n + 1, x.x, x.y, x.z);
  }
  std::vector<std::size_t> by_class(m_problem.corners.size());
  std::iota(by_class.begin(), by_class.end(), 0);
  const std::vector<std::uint8_t>& classes = m_problem.classes;
  std::stable_sort(by_class.begin(), by_class.end(),
                   [&](std::size_t a, std::size_t b) { return classes[a] < classes[b]; });
  const int mirror = m_problem.is_mirrored ? 1 : 0;
  std::string materials;
  for (std::size_t n = 0; n < by_class.size(); ++n) {
    const int of = classes[by_class[n]];
    if (n == 0 || of != classes[by_class[n - 1]]) {
      std::fprintf(out, "*ELEMENT, TYPE=C3D8, ELSET=E%d\n", of);
      const double shear = m_problem.moduli.shear[of], bulk = m_problem.moduli.bulk[of];
      char text[200];
      std::snprintf(text, sizeof text,
                    "*MATERIAL, NAME=M%d\n*ELASTIC\n%.12e,%.12e\n"
                    "*SOLID SECTION, ELSET=E%d, MATERIAL=M%d\n",
                    of, 9 * bulk * shear / (3 * bulk + shear),
                    (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)), of, of);
      materials += text;
    }
    std::fprintf(out, "%zu", n + 1);
    for (const int corner : kCornerOrder) {
      std::fprintf(out, ",%d",
                   int(m_problem.corners[by_class[n]][std::size_t(corner ^ mirror)]) + 1);
    }
    std::fputs("\n", out);
  }
  std::fputs(materials.c_str(), out);
}

/// Writes what holds nodes, what acts on them, and what is to be printed.
void CalculixSolver::write_step(std::FILE* out) const {
  std::fprintf(out, "*STEP\n*STATIC%s\n*BOUNDARY\n",
               m_is_iterative ? ", SOLVER=ITERATIVE CHOLESKY" : "");
  for (std::size_t n = 0; n < m_loads.held.size(); ++n) {
    for (int a = 0; a < 3; ++a) {
      if ((m_loads.held[n] >> a & 1) == 0) continue;
      std::fprintf(out, "%zu,%d,%d,%.12e\n", n + 1, a + 1, a + 1,
                   m_loads.u_mm[3 * n + std::size_t(a)]);
    }
  }
  bool has_forces = false;
  for (std::size_t at = 0; at < m_loads.force_mn.size(); ++at) {
    if (m_loads.force_mn[at] == 0) continue;
    if (!has_forces) std::fputs("*CLOAD\n", out);
    has_forces = true;
    std::fprintf(out, "%zu,%zu,%.12e\n", at / 3 + 1, at % 3 + 1, m_loads.force_mn[at]);
  }
  std::fputs("*NODE PRINT, NSET=ALL\nU,RF\n*END STEP\n", out);
}

/// Reads two blocks with a line of three values per node: displacements, and forces in the nodes.
void CalculixSolver::read_results(const std::string& path) {
  std::ifstream stream(path);
  std::vector<double> values[2];
  int block = -1;
  for (std::string line; std::getline(stream, line);) {
    if (line.find(" for set ") != std::string::npos) ++block;
    char* end = nullptr;
    const long node = std::strtol(line.c_str(), &end, 10);
    if (block < 0 || block > 1 || node <= 0) continue;
    for (int a = 0; a < 3; ++a) values[block].push_back(std::strtod(end, &end));
  }
  const std::size_t wanted = 3 * m_problem.nodes.size();
  const bool is_finite = std::all_of(values[0].begin(), values[0].end(),
                                     [](double value) { return std::isfinite(value); });
  if (values[0].size() != wanted || values[1].size() != wanted || !is_finite) {
    throw Error("CalculiX gave " + std::to_string(values[0].size() / 3) +
                " displacements, expected finite ones of " + std::to_string(wanted / 3) + " nodes");
  }
  m_u = std::move(values[0]);
  m_residual.resize(wanted);
  set_to_forces(m_loads, m_residual);
  for (std::size_t n = 0; n < wanted; ++n) m_residual[n] -= values[1][n];
  m_size = ResidualMeter(m_loads)(m_residual);
  m_size.reaction_change = 0;  // of a single solution
}

}  // namespace supple
