// The seed corpus of the fuzz targets: small files of every format and variant, one folder each.
//
//   fuzz_seeds FOLDER
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include <openvdb/io/Stream.h>

#include "tests/support/dicom_fixtures.h"
#include "volumes/grid/density_grid_vdb.h"
#include "volumes/io/format/dense_writer.h"

namespace supple::fuzz {

namespace {

const Geometry kGrid({9, 4, 3}, {1.5, -2, 0.1}, {Vec3d(0, 0.5, 0), {-2, 0, 0}, {0, 0, 3}});

class Seeds {
 public:
  explicit Seeds(std::string folder) : m_folder(std::move(folder)) {}

  /// Path of seed `name` of a target.
  std::string path(const std::string& target, const std::string& name) const {
    std::filesystem::create_directories(m_folder + "/" + target);
    return m_folder + "/" + target + "/" + name;
  }
  void text(const std::string& target, const std::string& name, const std::string& content) const {
    std::ofstream(path(target, name), std::ios::binary) << content;
  }
  void volume(const std::string& target, const std::string& name, ValueType type,
              const WriteOptions& options = {}) const {
    DenseImage image;
    image.geometry = kGrid;
    image.type = type;
    write(path(target, name), image, options);
  }
  void warp(const std::string& target, const std::string& name) const {
    DenseImage image;
    image.geometry = kGrid;
    image.components = 3;
    image.direction = "resample";
    image.certificate = "{\"cells\":3}";
    write(path(target, name), image, {});
  }

 private:
  static void write(const std::string& path, const DenseImage& image, const WriteOptions& options) {
    const auto writer = create_dense(path, image, options);
    std::string slice(std::size_t(9) * 4 * image.components * bytes_of(image.type), '\x3f');
    for (int k = 0; k < kGrid.dims().z; ++k) {
      slice[std::size_t(k)] = char(k);
      writer->write_slice(slice.data());
    }
    writer->commit();
  }

  std::string m_folder;
};

void make_text_formats(const Seeds& seeds) {
  const WriteOptions compressed{true};
  seeds.volume("nrrd", "raw.nrrd", ValueType::int16);
  seeds.volume("nrrd", "gzip.nrrd", ValueType::float32, compressed);
  seeds.warp("nrrd", "warp.nrrd");
  const std::string head = "NRRD0005\ntype: short\ndimension: 3\nsizes: 2 2 2\n";
  seeds.text("nrrd", "ascii.nrrd",
             head +
                 "space: RAS\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nencoding: ascii\n"
                 "space origin: (0,0,-1)\n\n1 2 3 4\n5 6 7 -8\n");
  seeds.text("nrrd", "hex.nrrd", head + "endian: big\nencoding: hex\n\n" + std::string(32, '7'));
  seeds.text("nrrd", "list.nhdr",
             head + "endian: little\nencoding: raw\nspacings: 1 1 2\ndata file: LIST\na.nrrd\n");
  seeds.text("nrrd", "pattern.nhdr",
             head + "endian: little\nencoding: raw\nbyte skip: -1\ndata file: a%d.nrrd 1 9 1 2\n");
  seeds.text("nrrd", "layers.seg.nrrd",
             "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 2 1 1\nspace: LPS\nspace directions: "
             "none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\nencoding: raw\n"
             "Segment0_Name:=a\nSegment0_Layer:=1\nSegment1_LabelValue:=2\nSegment1_Name:=b\n\n"
             "abcd");
  seeds.volume("metaimage", "raw.mha", ValueType::uint16);
  seeds.volume("metaimage", "zlib.mha", ValueType::float64, compressed);
  seeds.warp("metaimage", "warp.mha");
  seeds.text("metaimage", "text.mha",
             "ObjectType = Image\nNDims = 3\nBinaryData = False\nDimSize = 2 2 1\n"
             "ElementSpacing = 1 2 3\nHeaderSize = 0\nElementType = MET_SHORT\n"
             "ElementDataFile = LOCAL\n1 2 3 4\n");
  std::string gipl(256, '\0');
  for (const int byte : {1, 3, 5, 7}) gipl[std::size_t(byte)] = 2;  // 2 x 2 x 2, 2 frames
  gipl[9] = 15;                                                     // int16
  for (const std::size_t size : {10, 14, 18}) gipl.replace(size, 2, "\x3f\x80");  // 1 mm
  gipl.replace(252, 4, "\x2a\xe3\x89\xb8");
  seeds.text("gipl", "frames.gipl", gipl + std::string(32, '\1'));
  seeds.text("raw", "spec", "dims=2,2,4,type=int16,spacing=1,1,2.5,endian=big,offset=32");
  seeds.text("points", "points.csv", "# a comment\nx,y,z,dx,dy,dz,name\n1,2,3,0.5,0,-1e-3,tip\n");
  seeds.text(
      "points", "points.mrk.json",
      "{\"markups\": [{\"type\": \"Line\", \"coordinateSystem\": \"RAS\", \"coordinateUnits\": "
      "[\"mm\"], \"controlPoints\": [{\"position\": [1, -2.5, 3e1], \"positionStatus\": "
      "\"defined\"}]}]}\n");
}

void make_transforms(const Seeds& seeds) {
  const std::string head = "#Insight Transform File V1.0\n#Transform 0\n";
  const std::string grid = "2 2 2 0 0 0 1 1 1 1 0 0 0 1 0 0 0 1\n";
  std::string numbers;
  for (int n = 0; n < 24; ++n) numbers += std::to_string(0.1 * n) + " ";
  seeds.text("transform", "composite.tfm",
             head +
                 "Transform: CompositeTransform_double_3_3\nTransform: "
                 "Euler3DTransform_double_3_3\nParameters: 0.1 0 0 1 2 3\nFixedParameters: 1 1 1 "
                 "0\nTransform: DisplacementFieldTransform_double_3_3\nParameters: " +
                 numbers + "\nFixedParameters: " + grid);
  seeds.text("transform", "bspline.tfm",
             head + "Transform: BSplineTransform_double_3_3_1\nParameters: " + numbers +
                 "\nFixedParameters: " + grid);
  seeds.text("transform", "elastix.txt",
             "(Transform \"BSplineTransform\")\n(TransformParameters " + numbers +
                 ")\n(FixedImageDimension 3)\n(MovingImageDimension 3)\n(Size 2 2 2)\n(Index 0 0 "
                 "0)\n(Spacing 1 1 1)\n(Origin 0 0 0)\n(Direction 1 0 0 0 1 0 0 0 1)\n"
                 "(GridSize 2 2 2)\n(GridIndex 0 0 0)\n(GridSpacing 1 1 1)\n(GridOrigin 0 0 "
                 "0)\n(GridDirection 1 0 0 0 1 0 0 0 1)\n(BSplineTransformSplineOrder 1)\n");
}

/// Solids that have moved (VTU), which are opened with a grid as transforms are.
void make_solids(const Seeds& seeds) {
  const auto solid = [](const std::string& compressor, const std::string& format,
                        const std::array<std::string, 5>& values, const std::string& appended) {
    const char* const heads[] = {"\"Float64\" Name=\"U\" NumberOfComponents=\"3\"",
                                 "\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"",
                                 "\"Int64\" Name=\"connectivity\"", "\"Int64\" Name=\"offsets\"",
                                 "\"UInt8\" Name=\"types\""};
    std::array<std::string, 5> arrays;
    for (std::size_t n = 0; n < 5; ++n) {
      const bool is_offset = format == "appended";
      arrays[n] =
          std::string("<DataArray type=") + heads[n] + " format=\"" + format + "\"" +
          (is_offset ? " offset=\"" + values[n] + "\"/>" : ">" + values[n] + "</DataArray>");
    }
    return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"" +
           compressor +
           "><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData>" +
           arrays[0] + "</PointData><Points>" + arrays[1] + "</Points><Cells>" + arrays[2] +
           arrays[3] + arrays[4] + "</Cells></Piece></UnstructuredGrid>" + appended + "</VTKFile>";
  };
  seeds.text("transform", "ascii.vtu",
             solid("", "ascii",
                   {".5 .5 .5 .6 .5 .5 .5 .6 .5 .5 .5 .6", "0 0 0 1 0 0 0 1 0 0 0 1", "0 1 2 3",
                    "4", "10"},
                   ""));
  // The bytes are as VTK writes them.
  seeds.text(
      "transform", "zlib.vtu",
      solid(" header_type=\"UInt32\" compressor=\"vtkZLibDataCompressor\"", "binary",
            {"AQAAAACAAABgAAAAGAAAAA==eF5jYACBB/YMaLQxGDzGECdVHgDwDREU",
             "AQAAAACAAABgAAAAEgAAAA==eF5jYMAHPtjjlSZCHgB4XQOO",
             "AQAAAACAAAAgAAAAEwAAAA==eF5jYIAARijNBKWZoTQAAHAABw==",
             "AQAAAACAAAAIAAAACwAAAA==eF5jYYAAAAAoAAU=", "AQAAAACAAAABAAAACQAAAA==eF7jAgAACwAL"},
            ""));
  const auto block = [](const std::string& bytes) {
    return std::string(1, char(bytes.size())) + std::string(3, '\0') + bytes;
  };
  const std::string numbers(96, '\x3f');
  const std::string ids("\0\0\0\0\0\0\0\0\1\0\0\0\0\0\0\0\2\0\0\0\0\0\0\0\3\0\0\0\0\0\0\0", 32);
  seeds.text(
      "transform", "raw.vtu",
      solid("", "appended", {"0", "100", "200", "236", "248"},
            "<AppendedData encoding=\"raw\">_" + block(numbers) + block(numbers) + block(ids) +
                block(std::string("\4\0\0\0\0\0\0\0", 8)) + block("\n") + "</AppendedData>"));
}

void make_binary_formats(const Seeds& seeds) {
  for (const ValueType type : {ValueType::uint8, ValueType::int16, ValueType::float32}) {
    const std::string name = numpy_name(type);
    seeds.volume("nifti", name + ".nii", type);
    seeds.volume("tiff", name + ".tif", type);
    seeds.volume("tiff", name + "-deflate.tif", type, WriteOptions{true});
    seeds.volume("hdf5", name + ".h5", type);
    seeds.volume("hdf5", name + "-deflate.h5", type, WriteOptions{true});
  }
  seeds.volume("nifti", "int16.nii.gz", ValueType::int16);
  seeds.warp("nifti", "warp.nii");
  seeds.warp("hdf5", "warp.h5");
}

/// Other programs' grids: ours carry a checksum, which no changed byte survives.
void make_grids(const Seeds& seeds) {
  auto fog = make_grid<openvdb::FloatGrid>(-1.0f);
  fog->setName("density");
  auto vectors = make_grid<openvdb::Vec3SGrid>(openvdb::Vec3f(0));
  for (int n = 0; n < 20; ++n) {
    fog->tree().setValueOn({n, n % 3, 2 * n % 5}, float(n));
    vectors->tree().setValueOn({n, n % 4, 1}, openvdb::Vec3f(float(n), 1, 2));
  }
  const auto write = [&](const char* name, const openvdb::GridBase::Ptr& grid,
                         std::uint32_t compression) {
    std::ofstream out(seeds.path("vdb", name), std::ios::binary);
    openvdb::io::Stream stream(out);
    stream.setCompression(compression);
    stream.write(openvdb::GridCPtrVec{grid});
  };
  write("fog-mask.vdb", fog, openvdb::io::COMPRESS_ACTIVE_MASK);
  write("fog-zip.vdb", fog, openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
  write("fog-blosc.vdb", fog, openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
  write("vectors.vdb", vectors, openvdb::io::COMPRESS_ACTIVE_MASK);
  seeds.volume("vdb", "ours.vdb", ValueType::int16);
}

void make_dicom(const Seeds& seeds) {
  const test::TemporaryFolder folder;
  for (const E_TransferSyntax syntax :
       {EXS_LittleEndianExplicit, EXS_LittleEndianImplicit, EXS_BigEndianExplicit, EXS_RLELossless,
        EXS_JPEG2000LosslessOnly}) {
    test::SeriesFixture series;
    series.syntax = syntax;
    const std::string path = series.write(folder, 0);
    std::filesystem::copy_file(path, seeds.path("dicom", std::to_string(int(syntax)) + ".dcm"),
                               std::filesystem::copy_options::overwrite_existing);
  }
  test::write_enhanced(seeds.path("dicom", "enhanced.dcm"), {}, {1, 0, 2, 3, 4, 5});
}

void make_pictures(const Seeds& seeds) {
  test::write_png(seeds.path("png", "grey8.png"), 5, 4, 8, 0, std::string(20, 'p'));
  test::write_png(seeds.path("png", "grey16.png"), 5, 4, 16, 0, std::string(40, 'p'), true);
  test::TiffOptions tiles;
  tiles.tile = 16;
  tiles.compression = 8;
  test::write_tiff(seeds.path("tiff", "tiles.tif"), 20, 18, tiles, std::string(360, 't'));
  test::TiffOptions big;
  big.mode = "w8";
  big.bits = 16;
  test::write_tiff(seeds.path("tiff", "big.tif"), 5, 4, big, std::string(40, 't'));
}

void make_meshes(const Seeds& seeds) {
  seeds.text("stl", "text.stl",
             "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
             "endloop\nendfacet\nendsolid a\n");
  seeds.text("stl", "binary.stl",
             std::string(80, ' ') + std::string("\1\0\0\0", 4) + std::string(50, '\x3f'));
  const std::string head =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  seeds.text(
      "ply", "text.ply",
      "ply\nformat ascii 1.0\ncomment SPACE=RAS\n" + head + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  seeds.text("ply", "binary.ply",
             "ply\nformat binary_little_endian 1.0\n" + head + std::string(36, '\x3f') +
                 std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13));
  seeds.text("vtk", "text.vtk",
             "# vtk DataFile Version 3.0\nSPACE=RAS\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n"
             "0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\nPOINT_DATA 3\nSCALARS a float 1\n"
             "LOOKUP_TABLE default\n1 2 3\n");
  seeds.text("vtk", "offsets.vtk",
             "# vtk DataFile Version 5.1\na\nASCII\nDATASET POLYDATA\nPOINTS 3 double\n"
             "0 0 0 1 0 0 0 1 0\nPOLYGONS 2 3\nOFFSETS vtktypeint64\n0 3\n"
             "CONNECTIVITY vtktypeint64\n0 1 2\nMETADATA\nINFORMATION 0\n\n");
  seeds.text("vtk", "binary.vtk",
             "# vtk DataFile Version 3.0\na\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 3 float\n" +
                 std::string(36, '\x3f') + "\nCELLS 1 4\n" +
                 std::string("\0\0\0\3\0\0\0\0\0\0\0\1\0\0\0\2", 16) + "\nCELL_TYPES 1\n" +
                 std::string("\0\0\0\5", 4) + "\n");
  seeds.text("obj", "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 -1\n");
}

/// One message of a page per verb and kind of event, and heads of requests.
void make_messages(const Seeds& seeds) {
  const char* const values[] = {
      R"("cancel":true)",
      R"("ack":7)",
      R"("deformed":false)",
      R"("size":{"3d":[640,480],"axial":[0,0]})",
      R"("slices":{"cursor":[1,2,3],"window":400,"overlay":"det_f","centre":{"axial":[1,2,3]}})",
      R"("pick":{"view":"3d","at":[10.5,20],"ray_only":true})",
      R"("list":{"path":"/tmp"})",
      R"("open":{"path":"/tmp/a.nrrd","material":"ct-head","preset":"Bone"})",
      R"("save":{"what":"screenshot","path":"/tmp/a.png","view":"3d","size":[64,64],"force":true})",
      R"("histogram":{"bins":256})",
      R"("options":{"kind":"relax"})",
  };
  const char* const events[] = {
      R"("kind":"grab","grab_ball":[1,2,3],"radius":5,"soft":2)",
      R"("kind":"push","grab":[1,2,3])",
      R"("kind":"drag","to":[0,1.5,-2e1])",
      R"("kind":"release","restore":true)",
      R"("kind":"release","all":true,"no_relax":true)",
      R"("kind":"anchor","grab_box":[0,0,0,3,3,3])",
      R"("kind":"anchor","grab_density":[-100,200])",
      R"("kind":"cut","curve":{"points":[[0,0,0],[1,2,3]],"direction":[0,0,1],"depth":20,"straight":true})",
      R"("kind":"cut","plane":{"corner":[0,0,0],"edge1":[1,0,0],"edge2":[0,1,0]})",
      R"("kind":"relax","passes":50,"method":"chaotic")",
      R"("kind":"limits","limits":"tighten")",
      R"("kind":"model","model":"springs","springs":{"time":1})",
      R"("kind":"material","material":{"table":{"domain":[-1000,2000],"active":[[-500,0],[-400,1]]}})",
      R"("kind":"material","material":{"preset":"ct-head"})",
      R"("kind":"undo","all":true)",
      R"("kind":"camera","camera":{"position":[0,-300,0],"target":[0,0,0],"up":[0,0,1],"fov":30})",
      R"("kind":"look","preset":"Bone")",
      R"("kind":"look","transfer":{"opacity":[[0,0],[100,1]],"colour":[[0,1,1,1]],"ambient":0.1})",
      R"("kind":"clip","clip":[{"box":[0,0,0,3,3,3],"keep":"outside","space":"source"}])",
      R"("kind":"step","grab":[1,2,3],"by":[0,1,0],"relax":{"passes":2})",
  };
  int number = 0;
  const auto add = [&](const std::string& text) {
    seeds.text("page", std::to_string(++number) + ".json", text);
  };
  for (const char* value : values) add(std::string("{\"n\":1,") + value + "}");
  for (const char* event : events) add(std::string("{\"event\":{") + event + "}}");
  add("chat, supple." + std::string(32, 'a'));
  add("http://localhost:8080");
}

}  // namespace

}  // namespace supple::fuzz

int main(int count, char** arguments) {
  if (count != 2) {
    std::fputs("usage: fuzz_seeds FOLDER\n", stderr);
    return 2;
  }
  const supple::fuzz::Seeds seeds(arguments[1]);
  supple::fuzz::make_text_formats(seeds);
  supple::fuzz::make_transforms(seeds);
  supple::fuzz::make_solids(seeds);
  supple::fuzz::make_binary_formats(seeds);
  supple::fuzz::make_grids(seeds);
  supple::fuzz::make_dicom(seeds);
  supple::fuzz::make_pictures(seeds);
  supple::fuzz::make_meshes(seeds);
  supple::fuzz::make_messages(seeds);
  return 0;
}
