#include "tools/lab/bench/bodies/ecm_engines.h"

#include <algorithm>

#include "lib/body/slot_set.h"
#include "lib/chainmail/ecm.h"
#include "lib/chainmail/reference/thesis_ecm.h"
#include "volumes/base/parallel.h"

namespace supple::tools {

namespace {

/// Nodes, chains and candidates of the thesis' algorithm, measured at 64^3 and 128^3.
constexpr std::int64_t kMultisetBytesPerNode = 500;

std::uint64_t mix(std::uint64_t value) {
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
  value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
  return value ^ (value >> 31);
}

/// One element's part of the checksum; parts are added up.
std::uint64_t offset_hash(const Vec3i& voxel, int c, std::int32_t offset) {
  const std::uint64_t place = (std::uint64_t(voxel.x) << 40) ^ (std::uint64_t(voxel.y) << 20) ^
                              std::uint64_t(voxel.z) ^ (std::uint64_t(c) << 60);
  return mix(mix(place) + std::uint32_t(offset));
}

class BodyEngine final : public EcmEngine {
 public:
  BodyEngine(Body& body, Engine engine, Progress* cancel)
      : m_body(body), m_solver(body, engine), m_cancel(cancel) {}

  void reset() override {
    for (BrickValues& q : m_body.q) {
      for (std::size_t b = 0; b < q.brick_count(); ++b) q.release(b);
    }
    m_body.links_known_valid = true;
  }
  void fix(const IndexBox& box) override { m_anchors.push_back(box); }
  void pull(const BenchDrag& pull) override {
    m_report = m_solver.drag({Handle(pull.voxel, pull.by_q)}, m_anchors, m_cancel);
  }
  std::int64_t moved() override { return m_report.moved; }
  std::int64_t max_list() const override { return m_report.max_queue; }
  std::string path() const override {
    return m_solver.engine() == Engine::block ? "block" : "flat";
  }

  std::uint64_t checksum() const override {
    return parallel_reduce(
        m_body.elements.brick_count(), Grain{64}, std::uint64_t(0),
        [&](std::size_t b, std::uint64_t& sum) { sum += brick_checksum(b); }, std::plus<>());
  }

 private:
  std::uint64_t brick_checksum(std::size_t b) const {
    std::uint64_t sum = 0;
    for_each_active(m_body.elements.mask(b), [&](int offset) {
      const Vec3i voxel = m_body.elements.origin(b) + brick_local(offset);
      for (int c = 0; c < 3; ++c) {
        sum += offset_hash(voxel, c, m_body.q[c].brick_or_zero(b)[offset]);
      }
    });
    return sum;
  }

  Body& m_body;
  EcmSolver m_solver;
  std::vector<Region> m_anchors;
  Progress* m_cancel;
  EcmReport m_report;
};

class MultisetEngine final : public EcmEngine {
 public:
  explicit MultisetEngine(const Body& body) : m_body(body) { reset(); }

  void reset() override {
    m_solver.reset();
    const reference::ReferenceLattice lattice = reference::lattice_of(m_body);
    m_origin = lattice.origin;
    m_dims = lattice.dims;
    m_solver = std::make_unique<Solver>(lattice, lattice.at_rest());
    m_previous = {};
  }
  void fix(const IndexBox&) override { throw Error("multiset: anchors are not part of it"); }
  void pull(const BenchDrag& pull) override { m_solver->move(pull.voxel - m_origin, pull.by_q); }
  /// Number of elements moved since the last call or reset.
  std::int64_t moved() override {
    const reference::Offsets now = m_solver->offsets();
    std::int64_t count = 0;
    for (std::size_t n = 0; n < now[0].size(); ++n) {
      bool changed = false;
      for (int c = 0; c < 3; ++c) {
        changed |= now[c][n] != (m_previous[c].empty() ? 0 : m_previous[c][n]);
      }
      count += changed;
    }
    m_previous = now;
    return count;
  }
  std::int64_t max_list() const override { return std::int64_t(m_solver->max_candidates()); }
  std::string path() const override { return "multiset"; }

  std::uint64_t checksum() const override {
    const reference::Offsets offsets = m_solver->offsets();
    std::uint64_t sum = 0;
    for_each_element(m_body.elements, [&](Slot slot) {
      const Vec3i voxel = voxel_of(m_body.elements, slot);
      const Vec3i node = voxel - m_origin;
      const std::size_t index = (std::size_t(node.z) * m_dims.y + node.y) * m_dims.x + node.x;
      for (int c = 0; c < 3; ++c) sum += offset_hash(voxel, c, offsets[c][index]);
    });
    return sum;
  }

 private:
  using Solver = reference::ThesisEcm<std::int64_t>;
  const Body& m_body;
  Vec3i m_origin, m_dims;
  std::unique_ptr<Solver> m_solver;
  reference::Offsets m_previous;
};

}  // namespace

std::unique_ptr<EcmEngine> make_engine(const std::string& name, Body& body, Progress* cancel) {
  if (name == "multiset") return std::make_unique<MultisetEngine>(body);
  const Engine engine = name == "bucket" ? Engine::flat : Engine::automatic;
  return std::make_unique<BodyEngine>(body, engine, cancel);
}

std::int64_t expected_multiset_bytes(const Vec3i& size) {
  return std::int64_t(size.x) * size.y * size.z * kMultisetBytesPerNode;
}

void release_offsets(Body& body) {
  for (BrickValues& q : body.q) q.clear();
  body.links_known_valid = true;
}

}  // namespace supple::tools
