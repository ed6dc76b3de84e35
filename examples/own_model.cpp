// A model of one's own behind the interface of models: own_model VOLUME I J K
//
// Each step takes every handle one voxel on; Enhanced ChainMail then puts the body in order.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include <supple/lib/model/model.h>
#include <supple/supple.h>

// [model]
class Creep final : public supple::Model<supple::Handle> {
 public:
  explicit Creep(const supple::HeldBody& held) : m_ecm(supple::make_ecm_model(held)) {}

  void move(const std::vector<supple::Handle>& handles, int steps, supple::Progress*) override {
    m_left = handles;
    m_most = steps;
  }
  bool step(const supple::Progress*) override {
    std::vector<supple::Handle> now = m_left;
    bool moves = false;
    for (std::size_t n = 0; n < now.size(); ++n) {
      for (int c = 0; c < 3; ++c) {
        now[n].by_q[c] = std::clamp(m_left[n].by_q[c], -kVoxel, kVoxel);
        m_left[n].by_q[c] -= now[n].by_q[c];
        moves = moves || now[n].by_q[c] != 0;
      }
    }
    if (!moves || m_most-- <= 0) return false;
    m_ecm->move(now, 1, nullptr);
    return true;
  }
  supple::ModelEnergy energy() override { return m_ecm->energy(); }
  std::vector<supple::Reaction> reactions(const std::vector<supple::Handle>& handles) override {
    return m_ecm->reactions(handles);
  }
  void store() override { m_ecm->store(); }

 private:
  static constexpr std::int32_t kVoxel = 1 << supple::kFixedBits;
  std::unique_ptr<supple::Model<supple::Handle>> m_ecm;
  std::vector<supple::Handle> m_left;
  int m_most = 0;
};
// [model]

int main(int argc, char** argv) try {
  if (argc != 5) return std::fprintf(stderr, "usage: own_model VOLUME I J K\n"), 2;
  const supple::Vec3i voxel(std::atoi(argv[2]), std::atoi(argv[3]), std::atoi(argv[4]));
  supple::Session session(argv[1]);
  supple::Body body = session.body();
  const std::vector<supple::Region> anchors;
  supple::Holds holds;
  Creep creep({body, anchors, holds});
  creep.move({{voxel, {3 << supple::kFixedBits, 0, 0}}}, 10, nullptr);
  const int steps = supple::run_model(creep, 10);
  std::printf("%d steps; the voxel is %g voxels from rest\n", steps,
              body.offset(voxel, 0) / supple::kFixedOne);
  return body.offset(voxel, 0) == 3 << supple::kFixedBits ? 0 : 1;
} catch (const supple::Error& error) {
  return std::fprintf(stderr, "own_model: %s\n", error.what()), 1;
}
