# Compile options shared by every target, and the recipe for a test binary.
add_library(supple_options INTERFACE)
target_include_directories(supple_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(supple_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                                                -Wno-sign-conversion)
if(SUPPLE_WERROR)
  target_compile_options(supple_options INTERFACE -Werror)
endif()
if(SUPPLE_NATIVE)
  target_compile_options(supple_options INTERFACE -march=native)
endif()
if(SUPPLE_SANITIZE)
  target_compile_options(supple_options INTERFACE
    -fsanitize=${SUPPLE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize=vptr,null,alignment
    -fno-sanitize-recover=all
    # GCC 12 finds false ones in instrumented library code.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(supple_options INTERFACE -fsanitize=${SUPPLE_SANITIZE})
endif()

# What waits for files, people or a test's expectation: the optimiser would take half of the time of
# compiling it and save none.
add_library(supple_cold INTERFACE)
if(SUPPLE_SANITIZE)
  target_compile_options(supple_cold INTERFACE -O0)
else()
  target_compile_options(supple_cold INTERFACE $<$<CONFIG:Release>:-O1>)
endif()

# supple_add_module(NAME FOR LIBRARY SOURCES ... LIBRARIES ...)
# A shared object that the program loads from its own folder when it needs it (volumes/base/module.h):
# with its libraries linked in, every start would cost their time and memory. It compiles the few
# sources of other rooms that it needs a second time, position-independent. Whoever links LIBRARY
# finds it.
function(supple_add_module name)
  cmake_parse_arguments(ARG "" "FOR" "SOURCES;LIBRARIES" ${ARGN})
  add_library(${name} MODULE ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE supple_options ${ARG_LIBRARIES})
  # A symbol that is missing is found at link time, not when the module is loaded. Those of clang's
  # sanitizers come from the program.
  if(NOT SUPPLE_FUZZ)
    target_link_options(${name} PRIVATE LINKER:-z,defs)
  endif()
  set_target_properties(${name} PROPERTIES
    PREFIX "" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
  add_dependencies(${ARG_FOR} ${name})
endfunction()

# supple_add_tests(NAME SOURCES ... LIBRARIES ... LABELS ...)
# One binary, one CTest entry per label. A suite belongs to the label its name starts with:
# TEST(PropertyEcm, ...) runs under the label "property".
function(supple_add_tests name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES;LABELS" ${ARGN})
  add_executable(test_${name} ${ARG_SOURCES})
  target_link_libraries(test_${name} PRIVATE supple_options supple_cold supple_test_support
                                             ${ARG_LIBRARIES} GTest::gtest GTest::gtest_main)
  target_precompile_headers(test_${name} PRIVATE <algorithm> <filesystem> <functional> <random>
                                                 <string> <vector> <gtest/gtest.h>)
  foreach(label IN LISTS ARG_LABELS)
    string(SUBSTRING ${label} 0 1 first)
    string(SUBSTRING ${label} 1 -1 rest)
    string(TOUPPER ${first} first)
    add_test(NAME ${name}.${label}
             COMMAND test_${name} --gtest_filter=${first}${rest}* --gtest_brief=1)
    set_tests_properties(${name}.${label} PROPERTIES LABELS ${label} TIMEOUT 900
      FAIL_REGULAR_EXPRESSION "0 tests from 0 test suites"
      ENVIRONMENT "SUPPLE_BINARY=$<TARGET_FILE:supple>;SUPPLE_SOURCE_DIR=${PROJECT_SOURCE_DIR};SUPPLE_TEST_OUTPUT=${PROJECT_BINARY_DIR}/test-output;LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/leaks.supp:print_suppressions=0")
  endforeach()
endfunction()
