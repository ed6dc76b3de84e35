#include "raycast/microscope/picture_planes.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"
#include "volumes/base/stopwatch.h"

namespace supple {

namespace {

constexpr int kBlock = TriangleBins::kPixels;  // across a packet
constexpr int kTile = 32;                      // pixels across the work of a thread
constexpr int kTimedOf = 8;                    // one packet of so many is timed
constexpr float kDepthStepMm = 0.1f;
constexpr float kBrightest = 4;  // of a part of a pixel: it must not outshine the others

/// Calls work(tile) for tiles that begin at multiples of their size.
template <class Work>
void for_tiles(int width, int height, const Work& work) {
  const int across = (width + kTile - 1) / kTile, down = (height + kTile - 1) / kTile;
  parallel_for(across * down, [&](int n) {
    const int x = n % across * kTile, y = n / across * kTile;
    work(PixelTile{y, std::min(y + kTile, height), x, std::min(x + kTile, width)});
  });
}

void store_block(const LaneFloats& values, int stride, std::size_t at, std::vector<float>& plane) {
  for (int row = 0; row < kBlock; ++row) {
    std::copy_n(values.of + row * kBlock, kBlock, &plane[at + std::size_t(row) * stride]);
  }
}

/// Whatever is not kept apart lies over the colours already.
void put_front_over(PacketPicture& picture) {
  for (int lane = 0; lane < kPacketRays; ++lane) {
    const float clear = 1 - picture.front_opacity[lane];
    picture.colour.red[lane] = picture.front.red[lane] + clear * picture.colour.red[lane];
    picture.colour.green[lane] = picture.front.green[lane] + clear * picture.colour.green[lane];
    picture.colour.blue[lane] = picture.front.blue[lane] + clear * picture.colour.blue[lane];
  }
}

void draw_block(const EyeScene& scene, int left, int top, ShaderRoom& room, PicturePlanes& planes) {
  LaneFloats x, y;
  for (int lane = 0; lane < kPacketRays; ++lane) {
    x[lane] = float(left + lane % kBlock) + 0.5f;
    y[lane] = float(top + lane / kBlock) + 0.5f;
  }
  PacketPicture picture;
  shade_packet(scene, x, y, planes.seen.at_pixel(left, top), room, picture);
  for (int lane = 0; lane < kPacketRays; ++lane) {
    if (picture.front_opacity[lane] > 0) picture.key[lane] ^= 0x40000000u;
  }
  if (!planes.has_front) put_front_over(picture);
  const int stride = planes.stride;
  const std::size_t at = std::size_t(top) * stride + left;
  store_block(picture.colour.red, stride, at, planes.red);
  store_block(picture.colour.green, stride, at, planes.green);
  store_block(picture.colour.blue, stride, at, planes.blue);
  store_block(picture.depth_mm, stride, at, planes.depth_mm);
  for (int row = 0; row < kBlock; ++row) {
    std::copy_n(picture.key + row * kBlock, kBlock, &planes.key[at + std::size_t(row) * stride]);
  }
  if (!planes.has_front) return;
  store_block(picture.front.red, stride, at, planes.front_red);
  store_block(picture.front.green, stride, at, planes.front_green);
  store_block(picture.front.blue, stride, at, planes.front_blue);
  store_block(picture.front_opacity, stride, at, planes.front_opacity);
  store_block(picture.front_mm, stride, at, planes.front_mm);
}

/// Marks pixels of a row of a tile that differ from a neighbour.
void mark_edges(const PicturePlanes& planes, int y, int begin, int end, std::uint8_t* is_edge) {
  const int stride = planes.stride;
  const std::size_t row = std::size_t(y) * stride;
  const std::uint32_t* key = &planes.key[row];
  const std::uint32_t* above = y > 0 ? key - stride : key;
  const std::uint32_t* below = y + 1 < planes.height ? key + stride : key;
  const float* depth = &planes.depth_mm[row];
  const float* depth_above = y > 0 && y + 1 < planes.height ? depth - stride : depth;
  const float* depth_below = y > 0 && y + 1 < planes.height ? depth + stride : depth;
  const auto mark = [&](int x, int left, int right) {
    const bool differs = (key[x] != key[left]) | (key[x] != key[right]) | (key[x] != above[x]) |
                         (key[x] != below[x]);
    const float bend = std::abs(depth[left] + depth[right] - 2 * depth[x]);
    const float bend_down = std::abs(depth_above[x] + depth_below[x] - 2 * depth[x]);
    return std::uint8_t(differs | (bend > kDepthStepMm) | (bend_down > kDepthStepMm));
  };
  const int inner_begin = std::max(begin, 1), inner_end = std::min(end, planes.width - 1);
  for (int x = inner_begin; x < inner_end; ++x) is_edge[x - begin] = mark(x, x - 1, x + 1);
  if (begin == 0) is_edge[0] = mark(0, 0, std::min(1, planes.width - 1));
  if (end == planes.width) is_edge[end - 1 - begin] = mark(end - 1, std::max(end - 2, 0), end - 1);
}

/// Replaces the colours of up to four pixels by means over four rays, which lie as on a turned
/// square.
void smooth_pixels(const EyeScene& scene, const std::uint16_t* pixels, int count,
                   const PixelTile& tile, ShaderRoom& room, PicturePlanes& planes) {
  static constexpr float kAside[4] = {0.375f, 0.875f, 0.125f, 0.625f};
  static constexpr float kDown[4] = {0.125f, 0.375f, 0.625f, 0.875f};
  LaneFloats x, y;
  room.seen.clear();
  for (int lane = 0; lane < kPacketRays; ++lane) {
    const int pixel = pixels[std::min(lane / 4, count - 1)];
    const int column = tile.column_begin + pixel % kTile, row = tile.row_begin + pixel / kTile;
    x[lane] = float(column) + kAside[lane % 4];
    y[lane] = float(row) + kDown[lane % 4];
    if (lane % 4 != 0) continue;
    const TriangleList list = planes.seen.at_pixel(column, row);
    room.seen.add(list);
  }
  PacketPicture picture;
  shade_packet(scene, x, y, room.seen.list(), room, picture);
  if (!planes.has_front) put_front_over(picture);
  for (int n = 0; n < count; ++n) {
    const std::size_t at = std::size_t(tile.row_begin + pixels[n] / kTile) * planes.stride +
                           tile.column_begin + pixels[n] % kTile;
    const auto mean = [&](const LaneFloats& values, std::vector<float>& plane) {
      float sum = 0;
      for (int k = 0; k < 4; ++k) sum += std::min(values[4 * n + k], kBrightest);
      plane[at] = sum / 4;
    };
    mean(picture.colour.red, planes.red);
    mean(picture.colour.green, planes.green);
    mean(picture.colour.blue, planes.blue);
    if (!planes.has_front) continue;
    mean(picture.front.red, planes.front_red);
    mean(picture.front.green, planes.front_green);
    mean(picture.front.blue, planes.front_blue);
    mean(picture.front_opacity, planes.front_opacity);
  }
}

}  // namespace

void PicturePlanes::resize(int width_, int height_, bool has_front_) {
  const auto up = [](int size) { return (size + kBlock - 1) / kBlock * kBlock; };
  width = width_, height = height_, stride = up(width_), has_front = has_front_;
  // Vectors may read beyond the last row.
  const std::size_t count = std::size_t(stride) * up(height_) + kPacketRays;
  for (auto* plane : {&red, &green, &blue, &depth_mm}) plane->resize(count);
  key.resize(count);
  for (auto* plane : {&front_red, &front_green, &front_blue, &front_opacity, &front_mm}) {
    plane->resize(has_front ? count : 0);
  }
}

void draw_pixels(const EyeScene& scene, PicturePlanes& planes, PassTimes* times) {
  const Stopwatch watch;
  scene.shapes->sort_seen(scene.lens, planes.width, planes.height, planes.seen);
  PerThread<ShaderRoom> rooms;
  for_tiles(planes.width, planes.height, [&](const PixelTile& tile) {
    ShaderRoom& room = rooms.local();
    int n = 0;
    for (int y = tile.row_begin; y < tile.row_end; y += kBlock) {
      for (int x = tile.column_begin; x < tile.column_end; x += kBlock) {
        room.is_timed = times != nullptr && n++ % kTimedOf == 0;
        draw_block(scene, x, y, room, planes);
      }
    }
  });
  if (times == nullptr) return;
  double shadow_ms = 0, whole_ms = 0;
  for (const ShaderRoom& room : rooms) shadow_ms += room.shadow_ms, whole_ms += room.whole_ms;
  const double part = whole_ms > 0 ? shadow_ms / whole_ms : 0;
  times->shadow_ms += part * watch.ms();
  times->rays_ms += (1 - part) * watch.ms();
}

void smooth_edges(const EyeScene& scene, PicturePlanes& planes) {
  PerThread<ShaderRoom> rooms;
  for_tiles(planes.width, planes.height, [&](const PixelTile& tile) {
    std::uint8_t is_edge[kTile][kTile] = {};
    for (int y = tile.row_begin; y < tile.row_end; ++y) {
      mark_edges(planes, y, tile.column_begin, tile.column_end, is_edge[y - tile.row_begin]);
    }
    // Block by block, so that rays of a packet are near each other.
    std::uint16_t pixels[kTile * kTile];
    int count = 0;
    for (int n = 0; n < kTile * kTile; ++n) {
      const int block = n / (kBlock * kBlock), within = n % (kBlock * kBlock);
      const int row = block / (kTile / kBlock) * kBlock + within / kBlock;
      const int column = block % (kTile / kBlock) * kBlock + within % kBlock;
      if (is_edge[row][column] != 0) pixels[count++] = std::uint16_t(row * kTile + column);
    }
    for (int n = 0; n < count; n += 4) {
      smooth_pixels(scene, pixels + n, std::min(4, count - n), tile, rooms.local(), planes);
    }
  });
}

}  // namespace supple
