// supple-itk-inverse FOLDER THREADS NX NY NZ: ITK's inversion of a displacement field, for
// `supple bench invert`. Reads u.raw, writes o.raw (floats, three per voxel, i fastest, spacing 1)
// and prints the milliseconds of the inversion alone.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include <itkImage.h>
#include <itkInvertDisplacementFieldImageFilter.h>
#include <itkMultiThreaderBase.h>
#include <itkVector.h>

int main(int argc, char** argv) {
  if (argc != 6) return 2;
  using Vector = itk::Vector<float, 3>;
  using Field = itk::Image<Vector, 3>;
  const std::string folder = argv[1];
  itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(unsigned(std::atoi(argv[2])));
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(unsigned(std::atoi(argv[2])));
  Field::SizeType size;
  for (unsigned a = 0; a < 3; ++a) size[a] = unsigned(std::atoi(argv[3 + a]));
  const auto u = Field::New();
  u->SetRegions(size);
  u->Allocate();
  const auto bytes = std::streamsize(size[0] * size[1] * size[2] * sizeof(Vector));
  std::ifstream in(folder + "/u.raw", std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(u->GetBufferPointer()), bytes)) return 1;

  using Inverter = itk::InvertDisplacementFieldImageFilter<Field>;
  const auto inverter = Inverter::New();
  inverter->SetDisplacementField(u);
  inverter->SetMaximumNumberOfIterations(50);
  inverter->SetMeanErrorToleranceThreshold(1e-3f);
  inverter->SetMaxErrorToleranceThreshold(1e-2f);
  inverter->SetEnforceBoundaryCondition(false);
  const auto begin = std::chrono::steady_clock::now();
  inverter->Update();
  const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - begin;
  std::ofstream out(folder + "/o.raw", std::ios::binary);
  out.write(reinterpret_cast<const char*>(inverter->GetOutput()->GetBufferPointer()), bytes);
  out.flush();
  if (!out) return 1;
  std::printf("%.3f\n", ms.count());
  return 0;
}
