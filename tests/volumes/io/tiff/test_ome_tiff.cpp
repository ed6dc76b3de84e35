// OME-TIFF: which page is which plane, sizes and units, and descriptions that do not fit.
#include <gtest/gtest.h>

#include "tests/volumes/io/tiff_fixtures.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

/// An OME description of 1 x 1 planes; `more` goes among the attributes, `data` inside Pixels.
std::string ome(const std::string& more, const std::string& data = "<TiffData/>",
                const std::string& root = "") {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<OME xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\"" +
         root +
         "><Image ID=\"Image:0\"><Pixels ID=\"Pixels:0\" Type=\"uint8\" SizeX=\"1\" SizeY=\"1\" " +
         more + ">" + data + "</Pixels></Image></OME>\n";
}

/// Opens a file of `pages` pages a, b, c ... with this description.
std::string write_ome(const TemporaryFolder& folder, const std::string& description, int pages) {
  TiffOptions options;
  options.description = description;
  write_tiff_pages(folder / "a.ome.tif", 1, 1, options, lettered_pages(pages, 1));
  return folder / "a.ome.tif";
}

TEST(UnitOmeTiff, DimensionOrderSaysWhatCountsFastest) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, std::string>> orders = {
      {"XYZCT", "jkl"}, {"XYCZT", "hjl"}, {"XYZTC", "jkl"},
      {"XYTZC", "hjl"}, {"XYCTZ", "dhl"}, {"XYTCZ", "dhl"}};
  for (const auto& [order, slices] : orders) {
    const std::string sizes =
        "SizeZ=\"3\" SizeC=\"2\" SizeT=\"2\" DimensionOrder=\"" + order + "\"";
    const std::string path = write_ome(folder, ome(sizes), 12);
    EXPECT_EQ(read_all(*open_volume(path, choice(1, 1))), slices) << order;
  }
}

TEST(UnitOmeTiff, TiffDataPlacesPlanesOnPages) {
  const TemporaryFolder folder;
  const std::string sizes = "SizeZ=\"3\" SizeC=\"1\" SizeT=\"1\" DimensionOrder=\"XYZCT\"";
  const std::string path = write_ome(
      folder,
      ome(sizes,
          "<TiffData FirstZ=\"2\" IFD=\"0\"/><TiffData FirstZ=\"0\" IFD=\"2\" PlaneCount=\"2\"/>"),
      4);
  EXPECT_EQ(read_all(path), "cda");
}

TEST(UnitOmeTiff, PhysicalSizesAreMicrometresUnlessTheirUnitSaysOtherwise) {
  const TemporaryFolder folder;
  const std::string sizes = "SizeZ=\"2\" SizeC=\"1\" SizeT=\"1\" DimensionOrder=\"XYZCT\" ";
  const auto spacing = [&](const std::string& more) {
    const auto file = open_volume(write_ome(folder, ome(sizes + more), 2));
    EXPECT_TRUE(file->header().warnings.empty()) << more;
    return file->header().geometry.spacing_mm();
  };
  const auto expect = [](const Vec3d& found, const Vec3d& expected) {
    for (int a = 0; a < 3; ++a) EXPECT_DOUBLE_EQ(found[a], expected[a]);
  };
  expect(spacing(""), {1, 1, 1});
  expect(spacing("PhysicalSizeX=\"500\" PhysicalSizeY=\"250\" PhysicalSizeZ=\"2000\""),
         {0.5, 0.25, 2});
  expect(spacing("PhysicalSizeX=\"0.5\" PhysicalSizeXUnit=\"mm\" PhysicalSizeY=\"2\" "
                 "PhysicalSizeYUnit=\"cm\" PhysicalSizeZ=\"3000\" PhysicalSizeZUnit=\"nm\""),
         {0.5, 20, 0.003});
  expect(spacing("PhysicalSizeX=\"2\" PhysicalSizeXUnit=\"\xc2\xb5m\" PhysicalSizeY=\"2\" "
                 "PhysicalSizeYUnit=\"m\" PhysicalSizeZ=\"1\""),
         {0.002, 2000, 0.001});
}

TEST(UnitOmeTiff, WhatIsUnsaidOrLeftOutIsAWarning) {
  const TemporaryFolder folder;
  const std::string sizes = "SizeZ=\"2\" SizeC=\"1\" SizeT=\"1\" DimensionOrder=\"XYZCT\" ";
  const auto warnings = [&](const std::string& description) {
    return open_volume(write_ome(folder, description, 2))->header().warnings;
  };
  const auto unit = warnings(ome(sizes + "PhysicalSizeX=\"1\" PhysicalSizeXUnit=\"pixel\""));
  ASSERT_EQ(unit.size(), 2u);
  EXPECT_NE(unit[0].find("pixel"), std::string::npos);
  EXPECT_NE(unit[1].find("distance of slices"), std::string::npos);
  std::string two = ome(sizes);
  two.insert(two.find("</OME>"), "<Image ID=\"Image:1\"/>");
  ASSERT_EQ(warnings(two).size(), 1u);
  EXPECT_NE(warnings(two)[0].find("first of 2 images"), std::string::npos);
}

TEST(FaultOmeTiff, DescriptionsThatDoNotFitThePagesAreErrors) {
  const TemporaryFolder folder;
  const std::string sizes = "SizeZ=\"2\" SizeC=\"1\" SizeT=\"1\" DimensionOrder=\"XYZCT\" ";
  const std::string other =
      "<TiffData IFD=\"0\"><UUID FileName=\"b.tif\">urn:uuid:2</UUID></TiffData>";
  std::string wide = ome(sizes);
  wide.replace(wide.find("SizeX=\"1\""), 9, "SizeX=\"9\"");
  std::string entities = ome(sizes);
  entities.insert(entities.find("<OME"),
                  "<!DOCTYPE OME [<!ENTITY a \"&b;&b;\"><!ENTITY b \"x\">]>");
  entities.replace(entities.find("SizeZ=\"2\""), 9, "SizeZ=\"&a;\"");
  const std::vector<std::pair<std::string, std::string>> faults = {
      {ome("SizeZ=\"3\" SizeC=\"1\" SizeT=\"1\" DimensionOrder=\"XYZCT\""), "as there are pages"},
      {ome("SizeZ=\"2147483647\" SizeC=\"2147483647\" SizeT=\"9\" DimensionOrder=\"XYZCT\""),
       "as there are pages"},
      {ome("SizeZ=\"0\" SizeC=\"1\" SizeT=\"1\" DimensionOrder=\"XYZCT\""), "SizeZ"},
      {ome("SizeZ=\"two\" SizeC=\"1\" SizeT=\"1\" DimensionOrder=\"XYZCT\""), "SizeZ"},
      {ome("SizeZ=\"2\" SizeT=\"1\" DimensionOrder=\"XYZCT\""), "SizeC"},
      {ome("SizeZ=\"2\" SizeC=\"1\" SizeT=\"1\" DimensionOrder=\"XYZZT\""), "DimensionOrder"},
      {wide, "9 x 1"},
      {entities, "SizeZ"},
      {ome(sizes + "PhysicalSizeX=\"-1\""), "PhysicalSizeX"},
      {ome(sizes, "<TiffData IFD=\"7\"/>"), "IFD 7"},
      {ome(sizes, "<TiffData IFD=\"0\" PlaneCount=\"3\"/>"), "PlaneCount 3"},
      {ome(sizes, "<TiffData FirstZ=\"2\" IFD=\"0\"/>"), "beyond SizeZ"},
      {ome(sizes, "<TiffData IFD=\"0\"/>"), "no page for plane 1"},
      {ome(sizes, other, " UUID=\"urn:uuid:1\""), "several files"},
      {"<OME><Image></OME>", "OME XML"},
      {"<NOME></NOME> OME>", "OME element"},
      {"<OME><BinaryOnly MetadataFile=\"c.ome.xml\"/></OME>", "BinaryOnly"},
      {"<OME></OME>", "OME Image"}};
  for (const auto& [description, part] : faults) {
    const std::string line = failure_of(write_ome(folder, description, 2));
    EXPECT_NE(line.find(part), std::string::npos) << part << " in: " << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace supple::test
