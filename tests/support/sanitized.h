// Differences of tests in a build with sanitizers, where they take ten times as long and look for
// errors of memory: figures are looked at elsewhere.
#pragma once

namespace supple::test {

#ifdef SUPPLE_SANITIZED  // tests/CMakeLists.txt
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

/// Number of `n` random cases that are tried, or of `n` events among them that are expected.
constexpr int cases(int n) {
  return kSanitized ? (n + 19) / 20 : n;
}

}  // namespace supple::test
