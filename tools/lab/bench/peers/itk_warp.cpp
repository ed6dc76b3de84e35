// supple-itk-warp VOLUME FIELD OUTPUT THREADS: ITK's linear warp of a volume of int16 by a dense
// resample-direction field (both MetaImage), for `supple bench render`. Writes OUTPUT, prints
// {"warp_ms", "base_mbytes", "peak_mbytes"} and warps again for every line on stdin.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <string>

#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkImageFileWriter.h>
#include <itkMetaImageIO.h>
#include <itkMultiThreaderBase.h>
#include <itkVector.h>
#include <itkWarpImageFilter.h>

namespace {

using ItkVolume = itk::Image<short, 3>;
using ItkField = itk::Image<itk::Vector<float, 3>, 3>;
constexpr short kAir = -1000;  // HU

/// VmRSS or VmHWM of this process.
double mbytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(name + ":", 0) == 0) return std::stod(line.substr(name.size() + 1)) * 1.024e-3;
  }
  return 0;
}

template <class Image>
typename Image::Pointer read(const char* path) {
  const auto reader = itk::ImageFileReader<Image>::New();
  reader->SetImageIO(itk::MetaImageIO::New());
  reader->SetFileName(path);
  reader->Update();
  return reader->GetOutput();
}

void warp_and_tell(itk::WarpImageFilter<ItkVolume, ItkVolume, ItkField>& warp, double base) {
  warp.Modified();
  const auto begin = std::chrono::steady_clock::now();
  warp.Update();
  const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - begin;
  std::printf("{\"warp_ms\": %.3f, \"base_mbytes\": %.1f, \"peak_mbytes\": %.1f}\n", ms.count(),
              base, mbytes("VmHWM"));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 5) return 2;
  const double base = mbytes("VmRSS");
  itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(unsigned(std::atoi(argv[4])));
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(unsigned(std::atoi(argv[4])));
  const auto volume = read<ItkVolume>(argv[1]);
  const auto warp =
      itk::WarpImageFilter<ItkVolume, ItkVolume, ItkField>::New();  // linear by default
  warp->SetInput(volume);
  warp->SetDisplacementField(read<ItkField>(argv[2]));
  warp->SetOutputParametersFromImage(volume);
  warp->SetEdgePaddingValue(kAir);
  warp_and_tell(*warp, base);
  const auto writer = itk::ImageFileWriter<ItkVolume>::New();
  writer->SetImageIO(itk::MetaImageIO::New());
  writer->SetFileName(argv[3]);
  writer->SetInput(warp->GetOutput());
  writer->Update();
  for (std::string line; std::getline(std::cin, line);) warp_and_tell(*warp, base);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
