# What every target of the house shares.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

find_package(Threads REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)

add_library(scree_flags INTERFACE)
target_include_directories(scree_flags INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(scree_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>  # g++ 12 cries wolf over std::optional of Eigen vectors
  -ffp-contract=off)
set(SCREE_TEST_TIMEOUT_S 300)
if(SCREE_SANITIZE)
  set(SCREE_TEST_TIMEOUT_S 1800)  # everything is 3 to 15 times slower
  # instrumented code makes g++ 12 see uninitialised and out-of-bounds accesses in its own library (GCC PR105562):
  # warnings are errors in the other builds
  target_compile_options(scree_flags INTERFACE -Wno-error)
  # a report must fail the test, also of undefined behaviour, which g++ would only print
  target_compile_options(scree_flags INTERFACE -fsanitize=${SCREE_SANITIZE} -fno-sanitize-recover=undefined
                                               -fno-omit-frame-pointer -g1)
  target_link_options(scree_flags INTERFACE -fsanitize=${SCREE_SANITIZE})
endif()
if(SCREE_BUILD_FUZZERS)  # coverage for libFuzzer everywhere, its main only in the fuzz targets
  target_compile_options(scree_flags INTERFACE -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined -g1)
  target_link_options(scree_flags INTERFACE -fsanitize=address,undefined)
endif()
target_link_libraries(scree_flags INTERFACE Eigen3::Eigen Threads::Threads)

# scree_library(NAME dep…): one target a folder, from every .cpp beside the CMakeLists.txt that calls it.
# fmt stands in for std::format, which g++ 12 lacks.
function(scree_library name)
  file(GLOB sources CONFIGURE_DEPENDS *.cpp)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  if(sources)
    add_library(${name} STATIC ${sources})
    target_link_libraries(${name} PUBLIC scree_flags ${ARGN} PRIVATE fmt::fmt)
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE scree_flags ${ARGN})
  endif()
endfunction()

# scree_tests(FOLDER lib…): tests/FOLDER/*.cpp become one GoogleTest binary.
function(scree_tests folder)
  file(GLOB sources CONFIGURE_DEPENDS ${folder}/*.cpp)
  if(NOT sources)
    return()
  endif()
  string(REPLACE "/" "_" target test_${folder})
  add_executable(${target} ${sources})
  target_link_libraries(${target} PRIVATE ${ARGN} scree_flags fmt::fmt GTest::gtest_main GTest::gmock)
  target_compile_definitions(${target} PRIVATE SCREE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  gtest_discover_tests(${target} DISCOVERY_MODE PRE_TEST TEST_PREFIX "${folder}/" PROPERTIES TIMEOUT ${SCREE_TEST_TIMEOUT_S})
endfunction()
