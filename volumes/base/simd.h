// Vectors as wide as the machine's registers, as GCC and Clang extend the language: operators work
// lane by lane, comparisons make masks for `?:`; __builtin_shufflevector and
// __builtin_convertvector do the rest. Only for kernels: such types must not cross the border of a
// translation unit, since their calling convention depends on its flags. Kernels that are chosen
// while the program runs use Highway instead (raycast/march).
#pragma once

#include <cmath>
#include <cstring>

namespace supple {

template <class T, int lanes>
struct PackOf {
  using type __attribute__((vector_size(lanes * sizeof(T)))) = T;
  using aliasing __attribute__((vector_size(lanes * sizeof(T)), may_alias)) = T;
  using anywhere __attribute__((vector_size(lanes * sizeof(T)), aligned(sizeof(T)), may_alias)) = T;
};

/// So many numbers side by side.
template <class T, int lanes>
using Pack = typename PackOf<T, lanes>::type;
/// The same, for pointers to numbers that are aligned as it is.
template <class T, int lanes>
using AliasingPack = typename PackOf<T, lanes>::aliasing;
/// The same, for pointers to numbers at any address.
template <class T, int lanes>
using PackAnywhere = typename PackOf<T, lanes>::anywhere;

template <class P, class T>
inline P load_pack(const T* values) {
  P pack;
  std::memcpy(&pack, values, sizeof pack);
  return pack;
}
template <class T, class P>
inline void store_pack(T* values, const P& pack) {
  std::memcpy(values, &pack, sizeof pack);
}

template <class P>
inline P lanes_min(P a, P b) {
  return a < b ? a : b;
}
template <class P>
inline P lanes_max(P a, P b) {
  return a > b ? a : b;
}

/// Rounds towards zero.
template <class P>
inline P truncated(P pack) {
  for (std::size_t lane = 0; lane < sizeof(P) / sizeof pack[0]; ++lane) {
    pack[lane] = std::trunc(pack[lane]);
  }
  return pack;
}

}  // namespace supple
