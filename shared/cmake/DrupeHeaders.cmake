# Precompiled headers: half of the time of a cold build went into reading the same headers again and again. Three sets,
# each compiled once: for what is shipped, for the command line, for tests. Sources still include what they use; the
# preset dev, which has none of this, finds a forgotten #include.
option(DRUPE_PRECOMPILE_HEADERS "Read the headers that nearly every file includes only once" ON)

function(drupe_header_set name)
  cmake_parse_arguments(ARG "" "" "HEADERS;LINK" ${ARGN})
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/${name}.cpp CONTENT "")
  add_library(${name} OBJECT ${CMAKE_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE Eigen3::Eigen nlohmann_json::nlohmann_json ${ARG_LINK})
  target_precompile_headers(${name} PRIVATE <algorithm> <cmath> <cstdint> <functional> <map> <memory> <optional> <string>
                            <vector> <Eigen/Core> <Eigen/Geometry> <nlohmann/json.hpp> ${ARG_HEADERS})
endfunction()

# Compiles the sources of a target with one of the sets; the first unless one is named.
function(drupe_use_headers target set)
  if(NOT set)
    set(set drupe_headers)
  endif()
  if(DRUPE_PRECOMPILE_HEADERS)
    target_precompile_headers(${target} REUSE_FROM ${set})
  endif()
endfunction()

if(DRUPE_PRECOMPILE_HEADERS)
  # A precompiled header fits sources that agree on every macro it looks at, and Aravis asks for -pthread.
  add_compile_options(-pthread)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # GCC 12 forgets that what it read from a precompiled header is a system's header, and warns of the standard
    # library's own code. The preset dev still has these warnings.
    add_compile_options(-Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds -Wno-maybe-uninitialized)
  endif()
  drupe_header_set(drupe_headers)
  drupe_header_set(drupe_cli_headers HEADERS <CLI/CLI.hpp> LINK CLI11::CLI11)
  drupe_header_set(drupe_test_headers HEADERS <gtest/gtest.h> LINK GTest::gtest)
  target_compile_options(drupe_test_headers PRIVATE ${drupe_test_options})
endif()
