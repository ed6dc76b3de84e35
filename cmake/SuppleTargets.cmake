# Compile options shared by every target, and the recipes for sources, plugins and test binaries.
add_library(supple_options INTERFACE)
target_include_directories(supple_options INTERFACE ${PROJECT_SOURCE_DIR}
                                                     ${PROJECT_BINARY_DIR}/generated)
target_compile_options(supple_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                                                -Wno-sign-conversion)
# Calls inside a library are not open to replacement, as in a program.
target_compile_options(supple_options INTERFACE -fno-semantic-interposition
                                                -fvisibility-inlines-hidden)
if(SUPPLE_WERROR)
  target_compile_options(supple_options INTERFACE -Werror)
endif()
# Single files switch off warnings that only GCC has.
target_compile_options(supple_options INTERFACE
                       $<$<CXX_COMPILER_ID:Clang>:-Wno-unknown-warning-option>)
if(SUPPLE_UNITY GREATER 1)  # said of types in the anonymous namespace of a file that another includes
  target_compile_options(supple_options INTERFACE
                         $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endif()
if(SUPPLE_NATIVE)
  target_compile_options(supple_options INTERFACE -march=native)
elseif(SUPPLE_LEVEL)
  target_compile_options(supple_options INTERFACE -march=${SUPPLE_LEVEL})
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

# Tests, which take longer to optimise than to run.
add_library(supple_unoptimised INTERFACE)
target_compile_options(supple_unoptimised INTERFACE $<$<CONFIG:Release>:-O0>)

# supple_add_sources(TARGET FOLDER ... [EXCLUDE REGEX] [UNOPTIMISED])
# Every .cpp directly in these folders of the current directory, so that a new file needs no line
# here. Those of a folder are compiled together, SUPPLE_UNITY at a time.
# UNOPTIMISED: in sanitized builds, where compiling them takes longer than running them.
function(supple_add_sources target)
  cmake_parse_arguments(ARG "UNOPTIMISED" "EXCLUDE" "" ${ARGN})
  foreach(folder IN LISTS ARG_UNPARSED_ARGUMENTS)
    file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
    if(ARG_EXCLUDE)
      list(FILTER sources EXCLUDE REGEX ${ARG_EXCLUDE})
    endif()
    target_sources(${target} PRIVATE ${sources})
    if(SUPPLE_UNITY GREATER 1)
      string(MAKE_C_IDENTIFIER "${folder}" name)
      set(count 0)
      foreach(source IN LISTS sources)
        math(EXPR group "${count} / ${SUPPLE_UNITY}")
        set_source_files_properties(${source} TARGET_DIRECTORY ${target}
                                    PROPERTIES UNITY_GROUP ${name}_${group})
        if(ARG_UNOPTIMISED AND SUPPLE_SANITIZE)
          set_source_files_properties(
            ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/Unity/unity_${name}_${group}_cxx.cxx
            PROPERTIES COMPILE_OPTIONS -O0)
        endif()
        math(EXPR count "${count} + 1")
      endforeach()
    endif()
  endforeach()
  if(SUPPLE_UNITY GREATER 1)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  endif()
endfunction()

# supple_add_plugin(NAME FOR LIBRARY SOURCES ... LIBRARIES ...)
# A shared object that is loaded when it is first needed (volumes/base/plugin.h): with its libraries
# linked in, every start would cost their time and memory. It compiles the few sources of other
# folders that it needs a second time, position-independent. Whoever links LIBRARY finds it.
function(supple_add_plugin name)
  cmake_parse_arguments(ARG "" "FOR;FOLDER" "SOURCES;LIBRARIES" ${ARGN})
  add_library(${name} MODULE ${ARG_SOURCES})
  supple_add_sources(${name} ${ARG_FOLDER} EXCLUDE "/linked\\.cpp$")
  target_link_libraries(${name} PRIVATE supple_options ${ARG_LIBRARIES})
  # A symbol that is missing is found at link time, not when the plugin is loaded. Those of clang's
  # sanitizers come from the program.
  if(NOT (SUPPLE_SANITIZE AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang"))
    target_link_options(${name} PRIVATE LINKER:-z,defs)
  endif()
  set_target_properties(${name} PROPERTIES
    PREFIX "" CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
  add_dependencies(${ARG_FOR} ${name})
endfunction()

set(supple_leaks
    LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/leaks.supp:print_suppressions=0)

# supple_add_entry(NAME LABEL PARTS FILTER): tests of test_NAME as PARTS entries of CTest, so that no
# processor waits for a long one.
function(supple_add_entry name label parts filter)
  foreach(part RANGE 1 ${parts})
    set(test ${name}.${label})
    set(environment SUPPLE_BINARY=$<TARGET_FILE:supple> SUPPLE_SOURCE_DIR=${PROJECT_SOURCE_DIR}
        SUPPLE_TEST_OUTPUT=${PROJECT_BINARY_DIR}/test-output ${supple_leaks} ${supple_forks})
    if(parts GREATER 1)
      string(APPEND test .${part})
      math(EXPR index "${part} - 1")
      list(APPEND environment GTEST_TOTAL_SHARDS=${parts} GTEST_SHARD_INDEX=${index})
    endif()
    add_test(NAME ${test} COMMAND test_${name} --gtest_filter=${filter} --gtest_brief=1)
    set_tests_properties(${test} PROPERTIES LABELS ${label} TIMEOUT 900 COST ${parts}
      FAIL_REGULAR_EXPRESSION "0 tests from 0 test suites" ENVIRONMENT "${environment}")
  endforeach()
endfunction()

# supple_test_folders(OUT): the current folder and those below it with tests, but for folders with a
# CMakeLists.txt of their own and what lies below them.
function(supple_test_folders out)
  file(GLOB_RECURSE sources RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS *.cpp)
  file(GLOB_RECURSE others RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS */CMakeLists.txt)
  list(REMOVE_ITEM others CMakeLists.txt)
  list(TRANSFORM others REPLACE "CMakeLists\\.txt$" "")
  set(folders .)
  foreach(source IN LISTS sources)
    get_filename_component(folder ${source} DIRECTORY)
    set(is_here ON)
    foreach(other IN LISTS others)
      string(FIND "${source}" "${other}" at)
      if(at EQUAL 0)
        set(is_here OFF)
      endif()
    endforeach()
    if(folder AND is_here)
      list(APPEND folders ${folder})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES folders)
  set(${out} ${folders} PARENT_SCOPE)
endfunction()

# supple_label_filter(OUT LIST LABEL ...): a filter of the suites of these labels but for those of their tests that the
# list has.
function(supple_label_filter out list)
  set(suites)
  set(without)
  foreach(label IN LISTS ARGN)
    string(SUBSTRING ${label} 0 1 first)
    string(SUBSTRING ${label} 1 -1 rest)
    string(TOUPPER ${first} first)
    list(APPEND suites "${first}${rest}*")
    set(of_label ${${list}})
    list(FILTER of_label INCLUDE REGEX "^${first}${rest}")
    list(APPEND without ${of_label})
  endforeach()
  list(JOIN suites ":" filter)
  if(without)
    list(JOIN without ":" without)
    string(APPEND filter ":-${without}")
  endif()
  set(${out} "${filter}" PARENT_SCOPE)
endfunction()

# supple_find_marks(OUT MARK TARGET): filters of the target's tests that bear a mark of tests/support/sanitized.h.
function(supple_find_marks out mark target)
  set(filters)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    if(NOT source MATCHES "^/")
      continue()
    endif()
    file(READ ${source} text)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
    string(REGEX MATCHALL "TEST(_F|_P)?\\([A-Za-z0-9]+,[ \n]+[A-Za-z0-9]+\\) {\n  ${mark}\\(\\)" bodies "${text}")
    foreach(body IN LISTS bodies)
      string(REGEX REPLACE "^TEST(_F|_P)?\\(([A-Za-z0-9]+),[ \n]+([A-Za-z0-9]+).*" "\\2.\\3" filter "${body}")
      if(body MATCHES "^TEST_P")
        string(APPEND filter "/*")
      endif()
      list(APPEND filters ${filter})
    endforeach()
    string(REGEX MATCHALL "\n${mark}\\(\"[^\"]+" beside "${text}")
    list(TRANSFORM beside REPLACE ".*\"" "")
    list(APPEND filters ${beside})
  endforeach()
  set(${out} ${filters} PARENT_SCOPE)
endfunction()

# supple_add_tests(NAME [COLD] [MARKED_WHEN_SANITIZED] [QUICK LABEL ...] [EXCLUDE REGEX] [ALSO FOLDER ...]
#                  [SOURCES ...] LIBRARIES ... LABELS ...)
# COLD: tests that compute much themselves; all others are not optimised at all.
# All .cpp of the current folder, of those below it that have no CMakeLists.txt of their own, and of
# those ALSO named become one binary with one entry per label, or N of them for LABEL/N. A
# suite belongs to the label its name starts with: TEST(PropertyEcm, ...) runs under the label
# "property". Sanitized builds leave out tests that bear LEFT_OUT_WHEN_SANITIZED, and with MARKED_WHEN_SANITIZED
# all that do not bear RUN_WHEN_SANITIZED (tests/support/sanitized.h); their entry "sanitize" has the tests of QUICK
# labels that are not left out, since those labels are not run there. Anonymous namespaces of
# one folder share their names, as its files are compiled together.
function(supple_add_tests name)
  cmake_parse_arguments(ARG "COLD;MARKED_WHEN_SANITIZED" "EXCLUDE" "ALSO;SOURCES;LIBRARIES;LABELS;QUICK" ${ARGN})
  set(how unoptimised)
  if(ARG_COLD OR SUPPLE_SANITIZE)  # sanitized, cold code is not optimised either
    set(how cold)
  endif()
  add_executable(test_${name} ${ARG_SOURCES})
  set(not_here "/itk_[a-z]+\\.cpp$")
  if(ARG_EXCLUDE)
    string(APPEND not_here "|${ARG_EXCLUDE}")
  endif()
  supple_test_folders(folders)
  supple_add_sources(test_${name} ${folders} ${ARG_ALSO} EXCLUDE "${not_here}")
  target_link_libraries(test_${name} PRIVATE supple_options supple_${how} supple_test_support
                                             ${ARG_LIBRARIES} GTest::gtest GTest::gtest_main)
  target_precompile_headers(test_${name} REUSE_FROM supple_${how}_headers)
  set(left_out)
  if(SUPPLE_SANITIZE AND NOT SUPPLE_ALL_TESTS)
    if(ARG_MARKED_WHEN_SANITIZED)
      supple_find_marks(chosen RUN_WHEN_SANITIZED test_${name})
      list(JOIN chosen ":" filter)
      supple_add_entry(${name} sanitize 2 "${filter}")
      return()
    endif()
    supple_find_marks(left_out LEFT_OUT_WHEN_SANITIZED test_${name})
    if(ARG_QUICK)
      supple_label_filter(filter left_out ${ARG_QUICK})
      supple_add_entry(${name} sanitize 1 "${filter}")
    endif()
  endif()
  foreach(entry IN LISTS ARG_LABELS)
    string(REPLACE "/" ";" label "${entry};1")
    list(GET label 1 parts)
    list(GET label 0 label)
    set(without)
    if(NOT label IN_LIST ARG_QUICK)
      set(without left_out)
    endif()
    supple_label_filter(filter "${without}" ${label})
    supple_add_entry(${name} ${label} ${parts} "${filter}")
  endforeach()
endfunction()
