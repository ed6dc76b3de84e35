// Point files computed by hand: columns, frames, comments, damage.
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/io/point_file.h"

namespace supple::test {
namespace {

PointFile points_of(const std::string& text, const std::string& name = "a.csv") {
  const TemporaryFolder folder;
  return read_point_file(folder.write(name, text));
}

/// The error without the folder.
std::string error_of(const std::string& text) {
  try {
    points_of(text);
  } catch (const InputError& error) {
    const std::string line = error.what();
    return line.substr(line.find("a.csv"));
  }
  return "none";
}

TEST(UnitPointFile, ColumnsComeInAnyOrderAndCaseAndOthersAreIgnored) {
  const PointFile points =
      points_of("label, Z ,x,colour,Y\nnose,3,1,red,2\n\"a, b\",-3.5,+1e1,,0\n");
  EXPECT_FALSE(points.has_displacements);
  ASSERT_EQ(points.rows.size(), 2u);
  EXPECT_EQ(points.rows[0].at_lps_mm, Vec3d(1, 2, 3));
  EXPECT_EQ(points.rows[1].at_lps_mm, Vec3d(10, 0, -3.5));
  EXPECT_EQ(points.rows[1].line, 3);
}

TEST(UnitPointFile, DisplacementsCommentsBlankLinesAndWindowsLineEndsAreRead) {
  const PointFile points =
      points_of("\xef\xbb\xbf# by hand\r\n\r\nx,y,z,dx,dy,dz\r\n# nose\r\n1,2,3,4,5,6\r\n\r\n");
  EXPECT_TRUE(points.has_displacements);
  ASSERT_EQ(points.rows.size(), 1u);
  EXPECT_EQ(points.rows[0].at_lps_mm, Vec3d(1, 2, 3));
  EXPECT_EQ(points.rows[0].by_lps_mm, Vec3d(4, 5, 6));
  EXPECT_EQ(points.rows[0].line, 5);
}

TEST(UnitPointFile, SlicerFiducialsAreReadInTheirFrame) {
  const std::string head = "# Markups fiducial file version = 4.11\n# CoordinateSystem = ";
  const std::string tail =
      "\n# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc\n"
      "1,10,20,30,0,0,0,1,1,1,0,F-1,\n";
  for (const char* lps : {"LPS", "1"}) {
    EXPECT_EQ(points_of(head + lps + tail, "a.fcsv").rows[0].at_lps_mm, Vec3d(10, 20, 30));
  }
  for (const char* ras : {"RAS", "0"}) {
    EXPECT_EQ(points_of(head + ras + tail, "a.fcsv").rows[0].at_lps_mm, Vec3d(-10, -20, 30));
  }
  const PointFile moved = points_of("# CoordinateSystem = RAS\nx,y,z,dx,dy,dz\n1,2,3,4,5,6\n");
  EXPECT_EQ(moved.rows[0].at_lps_mm, Vec3d(-1, -2, 3));
  EXPECT_EQ(moved.rows[0].by_lps_mm, Vec3d(-4, -5, 6));
}

/// The file with its points moved in LPS.
std::string moved(const std::string& text, const Vec3d& by = Vec3d(1, 0.5, 0)) {
  const TemporaryFolder folder;
  const PointFile file = read_point_file(folder.write("a.csv", text));
  std::vector<Vec3d> points;
  for (const PointFile::Row& row : file.rows) points.push_back(row.at_lps_mm + by);
  write_points_like(folder / "b.csv", file, points);
  std::ifstream in(folder / "b.csv", std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(UnitPointFile, MovedPointsKeepAllElseOfTheirFile) {
  EXPECT_EQ(moved("\xef\xbb\xbf# a, comment\r\n\r\nname,Z , x ,y,\"a, b\"\r\n"
                  "\"Nose, tip\", 3.00 , 0.1,\"2\",  7 \r\n# end\r\nx,-4,1e2,-0.5,"),
            "\xef\xbb\xbf# a, comment\r\n\r\nname,Z , x ,y,\"a, b\"\r\n"
            "\"Nose, tip\", 3.00 , 1.1,\"2.5\",  7 \r\n# end\r\nx,-4,101,0,");
  EXPECT_EQ(moved("# CoordinateSystem = RAS\n# columns = id,x,y,z\nF,1,2,3\n", {1, 0.5, 4}),
            "# CoordinateSystem = RAS\n# columns = id,x,y,z\nF,0,1.5,7\n");
  EXPECT_EQ(moved("x,y,z\n0.30000000000000004,0.1,9\n"), "x,y,z\n1.3,0.6,9\n");
}

/// A point list as 3D Slicer 5 writes it, shortened.
std::string markups(const std::string& head, const std::string& points) {
  return "{\n  \"@schema\": "
         "\"https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/"
         "Markups/Resources/Schema/markups-schema-v1.0.3.json#\",\n  \"markups\": [\n    {\n     "
         " " +
         head + ",\n      \"locked\": false,\n      \"controlPoints\": [" + points +
         "],\n      \"measurements\": [{ \"name\": \"length\", \"value\": 1.50 }]\n    }\n  ]\n}\n";
}

std::string control_point(const std::string& position, const std::string& status = "defined") {
  return "\n  { \"id\": \"1\", \"label\": \"F-1 {7}\", \"position\": " + position +
         ",\n    \"orientation\": [-1.0, -0.0, -0.0, -0.0, -1.0, -0.0, 0.0, 0.0, 1.0],\n    "
         "\"positionStatus\": \"" +
         status + "\" }";
}

const char* const kPointList =
    "\"type\": \"Fiducial\", \"coordinateSystem\": \"LPS\", \"coordinateUnits\": \"mm\"";

TEST(UnitPointFile, SlicerMarkupsAreReadInTheirFrame) {
  const std::string points = control_point("[10.5, -2e1, 30]") + "," +
                             control_point("[0.0, 0.0, 0.0]", "undefined") + "," +
                             control_point("[1,\n2,\n3]");
  const PointFile lps = points_of(markups(kPointList, points), "a.mrk.json");
  EXPECT_FALSE(lps.has_displacements);
  ASSERT_EQ(lps.rows.size(), 2u);
  EXPECT_EQ(lps.rows[0].at_lps_mm, Vec3d(10.5, -20, 30));
  EXPECT_EQ(lps.rows[1].at_lps_mm, Vec3d(1, 2, 3));
  EXPECT_EQ(lps.rows[0].line, 8);
  EXPECT_EQ(lps.rows[1].line, 14);
  for (const char* frame : {"RAS", "0"}) {
    const std::string head = "\"type\": \"Curve\", \"coordinateSystem\": \"" + std::string(frame) +
                             "\", \"coordinateUnits\": [\"mm\", \"UCUM\", \"millimeter\"]";
    EXPECT_EQ(points_of(markups(head, points)).rows[0].at_lps_mm, Vec3d(-10.5, 20, 30));
  }
  EXPECT_EQ(points_of(markups("\"type\": \"Line\"", points)).rows[0].at_lps_mm[0], 10.5);
}

TEST(UnitPointFile, MovedMarkupsKeepAllElseOfTheirFile) {
  const std::string undefined = control_point("[7.0, 7.0, 7.0]", "undefined");
  const std::string before = control_point("[ 0.10 ,2,\n30.0]") + "," + undefined;
  const std::string after = control_point("[ 1.1 ,2.5,\n30.0]") + "," + undefined;
  EXPECT_EQ(moved(markups(kPointList, before)), markups(kPointList, after));
  const std::string ras = "\"type\": \"Angle\", \"coordinateSystem\": \"RAS\"";
  EXPECT_EQ(moved("\xef\xbb\xbf" + markups(ras, control_point("[1,2,3]"))),
            "\xef\xbb\xbf" + markups(ras, control_point("[0,1.5,3]")));
}

TEST(FaultPointFile, WhatIsWrongInMarkupsIsNamed) {
  const std::string point = control_point("[1, 2, 3]");
  EXPECT_EQ(error_of("{\"markups\": [}"),
            "a.csv: JSON: found parse error at line 1, column 14, expected intact markups");
  EXPECT_EQ(error_of("{\"points\": 3}"),
            "a.csv: markups: found none, expected an array, as 3D Slicer writes it");
  EXPECT_EQ(error_of(markups("\"type\": \"Plane\"", point)),
            "a.csv: type: found Plane, expected Fiducial, Line, Angle, Curve or ClosedCurve");
  EXPECT_EQ(error_of(markups("\"type\": \"Line\", \"coordinateSystem\": \"IJK\"", point)),
            "a.csv: coordinateSystem: found 'ijk', expected LPS or RAS");
  EXPECT_EQ(error_of(markups("\"type\": \"Line\", \"coordinateUnits\": \"um\"", point)),
            "a.csv: coordinateUnits: found 'um', expected mm");
  EXPECT_EQ(error_of(markups(kPointList, point + "," + control_point("[1, 2]"))),
            "a.csv: position of control point 1: found something else, expected three numbers");
  EXPECT_EQ(error_of(markups(kPointList, "{\"label\": \"F\"}")),
            "a.csv: position of control point 0: found nothing, expected three numbers");
  EXPECT_EQ(error_of(markups(kPointList, control_point("[1, 2, 3]", "undefined"))),
            "a.csv: controlPoints: found none that is defined, expected one at least");
  EXPECT_NE(error_of(markups(kPointList, control_point("[1, 2, 1e999]"))).find("a.csv: JSON"),
            std::string::npos);
  for (const char* odd : {"{\"markups\": [3]}", "{\"markups\": [[]]}", "{\"markups\": {}}", "{",
                          "{\"markups\": [{\"type\": 3}]}", "{}", "[1]"}) {
    EXPECT_NE(error_of(odd), "none") << odd;
  }
}

TEST(FaultPointFile, WhatIsWrongIsNamedWithItsLine) {
  EXPECT_EQ(error_of("x,y,z\n1,2,3\n1,two,3\n"), "a.csv:3: y: found two, expected a number");
  EXPECT_EQ(error_of("x,y,z\n1,nan,3\n"),
            "a.csv:2: y: found nan, expected a finite number of millimetres");
  EXPECT_EQ(error_of("x,y,z\n1,,3\n"), "a.csv:2: y: found nothing, expected a number");
  EXPECT_EQ(error_of("x,y,z\n1,2\n"), "a.csv:2: z: found 2 columns, expected it in column 3");
  EXPECT_EQ(error_of("1,2,3\n"),
            "a.csv:1: header: found '1,2,3', expected columns x,y,z, with or without dx,dy,dz, "
            "separated by commas");
  EXPECT_NE(error_of("x,y,z,dx\n1,2,3,4\n").find("a.csv:1: header"), std::string::npos);
  EXPECT_EQ(error_of("# CoordinateSystem = scanner\nx,y,z\n1,2,3\n"),
            "a.csv:1: CoordinateSystem: found 'scanner', expected LPS or RAS");
  EXPECT_EQ(error_of("x,y,z\n"),
            "a.csv: points: found none, expected one point a line below the header");
  EXPECT_EQ(error_of(""),
            "a.csv: points: found none, expected a header line with x,y,z and one point a line");
}

TEST(FaultPointFile, MissingFilesAndFoldersAreRefused) {
  const TemporaryFolder folder;
  EXPECT_THROW(read_point_file(folder / "none.csv"), InputError);
  EXPECT_THROW(read_point_file(folder / ""), InputError);
}

}  // namespace
}  // namespace supple::test
