// Blue noise: thresholds without low frequencies, so that neighbouring pixels differ and no pattern
// shows. R. Ulichney, The void-and-cluster method for dither array generation, Proc. SPIE 1913,
// 1993.
#pragma once

namespace supple {

/// A threshold, 0 … 1, from a tile of 64×64 pixels that repeats; every multiple of 1/4096 stands
/// once in a tile. The first call makes the tile, some 20 ms.
float blue_noise(int x, int y);

}  // namespace supple
