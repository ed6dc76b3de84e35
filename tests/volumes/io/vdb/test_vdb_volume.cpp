// Volumes and warps as OpenVDB files: values come back to the bit, other programs' grids are read,
// damage is noticed.
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <openvdb/io/Stream.h>

#include "tests/support/io_fixtures.h"
#include "volumes/base/error.h"
#include "volumes/grid/density_grid_vdb.h"
#include "volumes/io/format/dense_writer.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/vdb/vdb_seal.h"
#include "volumes/io/warp_file.h"

namespace supple::test {
namespace {

const Geometry kOblique({19, 10, 17}, {1.5, -2, 0.1},
                        {Vec3d(0, 0.5, 0.1), {-2, 0, 0}, {0, 0.2, 3}});

std::vector<std::string> write(const std::string& path, const DenseImage& image,
                               const std::string& values) {
  const auto writer = create_dense(path, image);
  const std::size_t slice = values.size() / image.geometry.dims().z;
  for (int k = 0; k < image.geometry.dims().z; ++k) writer->write_slice(&values[slice * k]);
  writer->commit();
  return writer->warnings();
}

DenseImage scalars(ValueType type) {
  DenseImage image;
  image.geometry = kOblique;
  image.type = type;
  return image;
}

/// A box of noise in a uniform surrounding.
template <class Value>
std::string block_of_noise(Value surrounding) {
  std::mt19937 random(7);
  const Vec3i& dims = kOblique.dims();
  std::vector<Value> values;
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) {
        const bool inside = i > 3 && i < 14 && k > 4 && k < 12;
        values.push_back(inside ? Value(random() % 120) : surrounding);
      }
    }
  }
  return bytes_of_values(values);
}

void expect_same_volume(const std::string& path, ValueType type, const std::string& values) {
  const auto file = open_volume(path);
  EXPECT_EQ(file->header().format, "vdb");
  EXPECT_EQ(file->header().type, type) << numpy_name(type);
  EXPECT_TRUE(file->header().geometry == kOblique);
  EXPECT_EQ(read_all(*file), values) << numpy_name(type);
}

TEST(PropertyVdbVolume, EveryTypeComesBackToTheBit) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.vdb";
  const auto round_trip = [&](ValueType type, const std::string& values) {
    EXPECT_TRUE(write(path, scalars(type), values).empty());
    expect_same_volume(path, type, values);
  };
  round_trip(ValueType::int8, block_of_noise<std::int8_t>(-128));
  round_trip(ValueType::uint8, block_of_noise<std::uint8_t>(255));
  round_trip(ValueType::int16, block_of_noise<std::int16_t>(-1024));
  round_trip(ValueType::uint16, block_of_noise<std::uint16_t>(0));
  round_trip(ValueType::int32, block_of_noise<std::int32_t>(-70000));
  round_trip(ValueType::uint32, block_of_noise<std::uint32_t>(1u << 30));
  round_trip(ValueType::int64, block_of_noise<std::int64_t>(-(1ll << 40)));
  round_trip(ValueType::float32, block_of_noise<float>(0.1f));
  round_trip(ValueType::float64, block_of_noise<double>(0.5));
}

TEST(PropertyVdbVolume, SignedZerosAndNaNAreKept) {
  const TemporaryFolder folder;
  std::string values = block_of_noise<float>(0.0f);
  const float odd[] = {-0.0f, std::numeric_limits<float>::infinity(), std::nanf("")};
  std::memcpy(&values[4 * 100], odd, sizeof odd);
  write(folder / "a.vdb", scalars(ValueType::float32), values);
  expect_same_volume(folder / "a.vdb", ValueType::float32, values);
}

TEST(UnitVdbVolume, WhatNoFloatHoldsIsRoundedAndCounted) {
  const TemporaryFolder folder;
  const auto warnings = write(folder / "a.vdb", scalars(ValueType::int32),
                              block_of_noise<std::int32_t>((1 << 24) + 1));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0], "2530 values were rounded to 32-bit floats");
  EXPECT_EQ(open_volume(folder / "a.vdb")->header().type, ValueType::float32);
}

TEST(UnitVdbVolume, AWarpKeepsVectorsDirectionAndCertificate) {
  const TemporaryFolder folder;
  std::vector<float> values(std::size_t(kOblique.voxel_count()) * 3, 0.0f);
  for (std::size_t n = 900; n < 2000; ++n) values[n] = float(n) * 0.1f;
  DenseImage image = scalars(ValueType::float32);
  image.components = 3;
  image.direction = "material";
  image.certificate = "{\"cells\":3}";
  write(folder / "w.vdb", image, bytes_of_values(values));
  const Warp warp = read_warp(folder / "w.vdb");
  EXPECT_TRUE(warp.geometry == kOblique);
  EXPECT_EQ(warp.direction, WarpDirection::material);
  const std::vector<Vec3f> vectors = warp.vectors.all();
  EXPECT_EQ(std::memcmp(vectors.data(), values.data(), values.size() * sizeof(float)), 0);
}

TEST(UnitVdbVolume, EqualVolumesAreEqualFiles) {
  const TemporaryFolder folder;
  const std::string values = block_of_noise<std::int16_t>(3);
  for (const char* name : {"a.vdb", "b.vdb"}) {
    write(folder / name, scalars(ValueType::int16), values);
  }
  EXPECT_EQ(read_text(folder / "a.vdb"), read_text(folder / "b.vdb"));
}

/// A file as other programs write it.
void write_foreign(const std::string& path, const openvdb::GridCPtrVec& grids) {
  std::ofstream out(path, std::ios::binary);
  openvdb::io::Stream(out).write(grids);
}

openvdb::FloatGrid::Ptr fog(const std::string& name) {
  auto grid = make_grid<openvdb::FloatGrid>(-1.0f);
  grid->setName(name);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
  auto accessor = grid->getAccessor();
  accessor.setValue({-3, 4, 5}, 2.5f);
  accessor.setValue({1, 5, 7}, 7.0f);
  return grid;
}

TEST(UnitVdbVolume, AForeignFogVolumeFillsTheBoxOfItsActiveVoxels) {
  openvdb::initialize();
  const TemporaryFolder folder;
  write_foreign(folder / "f.vdb", {fog("cloud")});
  const auto file = open_volume(folder / "f.vdb");
  const Geometry expected({5, 2, 3}, {-1.5, 2, 2.5}, {Vec3d(0.5, 0, 0), {0, 0.5, 0}, {0, 0, 0.5}});
  EXPECT_TRUE(file->header().geometry == expected);
  std::vector<float> values(30, -1.0f);
  values[0] = 2.5f;
  values[29] = 7.0f;
  EXPECT_EQ(read_all(*file), bytes_of_values(values));
}

TEST(FaultVdbVolume, GridsThatAreNoVolumeAreNamed) {
  openvdb::initialize();
  const TemporaryFolder folder;
  const auto line_of = [&](const openvdb::GridCPtrVec& grids) {
    write_foreign(folder / "g.vdb", grids);
    return failure_of(folder / "g.vdb");
  };
  auto mask = make_grid<openvdb::BoolGrid>(false);
  mask->setName("mask");
  mask->tree().setValueOn({1, 2, 3}, true);
  EXPECT_NE(line_of({mask}).find("found mask (bool), expected one grid of floats"),
            std::string::npos);
  EXPECT_NE(line_of({fog("a"), fog("b")}).find("found a (float), b (float)"), std::string::npos);
  EXPECT_EQ(line_of({fog("a"), fog("density")}), "");
  // Neither of two of one name is "the" density.
  EXPECT_NE(line_of({fog("density"), fog("a"), fog("density")}).find("two grids called density"),
            std::string::npos);
  EXPECT_NE(line_of({make_grid<openvdb::FloatGrid>(0)}).find("no active voxel"), std::string::npos);
  auto apart = fog("apart");
  apart->tree().setValueOn({100000, 100000, 5}, 1.0f);
  EXPECT_NE(line_of({apart}).find("expected at most 2 GiB"), std::string::npos);
}

TEST(FaultVdbVolume, EveryFlippedByteAndEveryCutIsNoticed) {
  const TemporaryFolder folder;
  write(folder / "a.vdb", scalars(ValueType::int16), block_of_noise<std::int16_t>(3));
  const std::string sound = read_text(folder / "a.vdb");
  for (std::size_t at = 0; at < sound.size(); at += 97) {
    std::string damaged = sound;
    damaged[at] = char(damaged[at] ^ 4);
    EXPECT_NE(failure_of(folder.write("d.vdb", damaged)), "") << at;
  }
  for (int tenth = 0; tenth < 10; ++tenth) {
    EXPECT_NE(failure_of(folder.write("t.vdb", sound.substr(0, sound.size() * tenth / 10))), "");
  }
}

TEST(FaultVdbVolume, AStateIsNoVolume) {
  openvdb::initialize();
  const TemporaryFolder folder;
  std::ofstream out(folder / "s.vdb", std::ios::binary);
  openvdb::MetaMap metadata;
  metadata.insertMeta("supple_format", openvdb::StringMetadata("state 1"));
  openvdb::io::Stream(out).write(openvdb::GridCPtrVec{fog("density")}, metadata);
  out.close();
  EXPECT_NE(failure_of(folder / "s.vdb").find("a deformed body"), std::string::npos);
}

}  // namespace
}  // namespace supple::test
