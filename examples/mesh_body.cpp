// Enhanced ChainMail on a body of explicit links: a chain of nodes, dragged at one end.
#include <cstdio>

#include <supple/lib/chainmail/mesh_ecm.h>

int main() try {
  // [mesh]
  std::vector<supple::Vec3d> points;
  std::vector<supple::LinkNodes> links;
  for (int n = 0; n < 20; ++n) points.push_back({10.0 * n, 0, 0});
  for (int n = 0; n < 19; ++n) links.push_back({n, n + 1});
  supple::MeshBody body = supple::make_network(points, links);

  const supple::MeshLimits limits{1.2, 0.8, 0.3};  // factors of a link's length at rest
  supple::MeshEcm ecm(body, limits);
  const supple::MeshEcmReport report = ecm.drag({{{19}, {30, 0, 0}}}, {{0}});
  // [mesh]
  std::printf("%lld nodes moved, %g of the drag; the end is at %g mm\n",
              static_cast<long long>(report.moved), report.fraction(), body.pos_mm[19].x);
  return 0;
} catch (const supple::Error& error) {
  return std::fprintf(stderr, "mesh_body: %s\n", error.what()), 1;
}
