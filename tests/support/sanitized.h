// Differences of tests in a build with sanitizers, where they take ten times as long and look for
// errors of memory: figures are looked at elsewhere.
#pragma once

namespace supple::test {

#ifdef SUPPLE_SANITIZED  // tests/CMakeLists.txt
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

// Marks of tests, which cmake/SuppleTargets.cmake finds in the sources: the first statement of a
// body. Beside an instantiation the filter of what is meant is given as text.

/// Marks a long test that looks at figures and runs through code that others run through, too.
#define LEFT_OUT_WHEN_SANITIZED(...) static_assert(true)
/// Marks a test that stands for others of its program, which sanitized builds leave out.
#define RUN_WHEN_SANITIZED() static_assert(true)

/// Number of `n` random cases that are tried, or of `n` events among them that are expected.
constexpr int cases(int n) {
  return kSanitized ? (n + 19) / 20 : n;
}

}  // namespace supple::test
