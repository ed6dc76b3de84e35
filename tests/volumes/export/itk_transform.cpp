// supple-itk-transform VOLUME TRANSFORM.h5 OUTPUT: ITK's linear resampling of a volume of floats
// through a transform file on the volume's own grid, the judge of what we write as such.
#include <cstdio>
#include <exception>

#include <itkHDF5TransformIOFactory.h>
#include <itkImageFileReader.h>
#include <itkImageFileWriter.h>
#include <itkMetaImageIO.h>
#include <itkResampleImageFilter.h>
#include <itkTransformFileReader.h>

using Volume = itk::Image<float, 3>;
using Transform = itk::Transform<double, 3, 3>;

int main(int argc, char** argv) try {
  if (argc != 4) return 2;
  itk::HDF5TransformIOFactory::RegisterOneFactory();
  const auto volume = itk::ImageFileReader<Volume>::New();
  volume->SetImageIO(itk::MetaImageIO::New());
  volume->SetFileName(argv[1]);
  volume->Update();
  const auto transforms = itk::TransformFileReaderTemplate<double>::New();
  transforms->SetFileName(argv[2]);
  transforms->Update();
  const auto* transform =
      dynamic_cast<const Transform*>(transforms->GetTransformList()->front().GetPointer());
  if (transform == nullptr) return 1;
  const auto resample = itk::ResampleImageFilter<Volume, Volume>::New();  // linear by default
  resample->SetInput(volume->GetOutput());
  resample->SetTransform(transform);
  resample->SetOutputParametersFromImage(volume->GetOutput());
  const auto writer = itk::ImageFileWriter<Volume>::New();
  writer->SetImageIO(itk::MetaImageIO::New());
  writer->SetFileName(argv[3]);
  writer->SetInput(resample->GetOutput());
  writer->Update();
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
