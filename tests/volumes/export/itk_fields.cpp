// supple-itk-fields NAME GRID.mha OUT.tfm FIELD.mha: writes a transform as ITK's text, and where it
// takes each point of a grid, the judge of how we read such files.
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>

#include <itkAffineTransform.h>
#include <itkBSplineTransform.h>
#include <itkCompositeTransform.h>
#include <itkEuler3DTransform.h>
#include <itkImageFileReader.h>
#include <itkImageFileWriter.h>
#include <itkMetaImageIO.h>
#include <itkSimilarity3DTransform.h>
#include <itkTransformFileWriter.h>
#include <itkTransformToDisplacementFieldFilter.h>
#include <itkTxtTransformIOFactory.h>

using Volume = itk::Image<float, 3>;
using Field = itk::Image<itk::Vector<double, 3>, 3>;
using Transform = itk::Transform<double, 3, 3>;

namespace {

/// Parameters around those of the identity.
template <class T>
typename T::Pointer shaken(typename T::Pointer transform, double by) {
  typename T::ParametersType parameters = transform->GetParameters();
  for (unsigned n = 0; n < parameters.Size(); ++n) parameters[n] += by * std::sin(12.9 * n + 1);
  transform->SetParameters(parameters);
  return transform;
}

template <class T>
typename T::Pointer linear(const Volume& grid, double by) {
  const auto transform = T::New();
  typename T::InputPointType centre = grid.GetOrigin();
  centre[0] += 3;
  transform->SetCenter(centre);
  return shaken<T>(transform, by);
}

Transform::Pointer spline(const Volume& grid) {
  using Spline = itk::BSplineTransform<double, 3, 3>;
  const auto transform = Spline::New();
  Spline::PhysicalDimensionsType length;
  Spline::MeshSizeType mesh;
  for (unsigned a = 0; a < 3; ++a) {
    length[a] = grid.GetSpacing()[a] * (grid.GetLargestPossibleRegion().GetSize()[a] - 1) * 0.875;
    mesh[a] = 3 + a;
  }
  // No point of the grid lies on the border, where ITK goes by the last bits of a place.
  itk::ContinuousIndex<double, 3> first;
  first.Fill(0.4);
  Volume::PointType origin;
  grid.TransformContinuousIndexToPhysicalPoint(first, origin);
  transform->SetTransformDomainOrigin(origin);
  transform->SetTransformDomainDirection(grid.GetDirection());
  transform->SetTransformDomainPhysicalDimensions(length);
  transform->SetTransformDomainMeshSize(mesh);
  return shaken<Spline>(transform, 4).GetPointer();
}

Transform::Pointer transform_of(const std::string& name, const Volume& grid) {
  if (name == "affine") return linear<itk::AffineTransform<double, 3>>(grid, 0.2).GetPointer();
  if (name == "euler") return linear<itk::Euler3DTransform<double>>(grid, 0.3).GetPointer();
  if (name == "similarity") {
    return linear<itk::Similarity3DTransform<double>>(grid, 0.2).GetPointer();
  }
  if (name == "bspline") return spline(grid);
  const auto composite = itk::CompositeTransform<double, 3>::New();
  for (const char* part : {"euler", "bspline", "affine"}) {
    composite->AddTransform(transform_of(part, grid));
  }
  return composite.GetPointer();
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 5) return 2;
  itk::TxtTransformIOFactory::RegisterOneFactory();
  const auto grid = itk::ImageFileReader<Volume>::New();
  grid->SetImageIO(itk::MetaImageIO::New());
  grid->SetFileName(argv[2]);
  grid->Update();
  const Transform::Pointer transform = transform_of(argv[1], *grid->GetOutput());
  const auto text = itk::TransformFileWriterTemplate<double>::New();
  text->SetFileName(argv[3]);
  text->SetInput(transform);
  text->Update();
  const auto field = itk::TransformToDisplacementFieldFilter<Field, double>::New();
  field->SetReferenceImage(grid->GetOutput());
  field->UseReferenceImageOn();
  field->SetTransform(transform);
  const auto writer = itk::ImageFileWriter<Field>::New();
  writer->SetImageIO(itk::MetaImageIO::New());
  writer->SetFileName(argv[4]);
  writer->SetInput(field->GetOutput());
  writer->Update();
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
