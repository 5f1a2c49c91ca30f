# One target a folder, with explicit links.
#
#   drupe_library(drupe_store SOURCES a.cpp b.cpp PUBLIC drupe_base PRIVATE OpenSSL::Crypto)
#   drupe_library(drupe_dense ALONE blur.cpp SOURCES ...)      ALONE: those that read themselves once per instruction set,
#                                                              or take long by themselves
#   drupe_library(drupe_http LIGHT SOURCES ...)                LIGHT: no work on pictures and points, so optimised less
#   drupe_library(drupe_sparse DEAR SOURCES ...)               DEAR: takes long to compile, so fewer sources at a time
#   drupe_program(drupe-capture SOURCES main.cpp PRIVATE drupe_http)
#   drupe_test(drupe_store_test SOURCES a_test.cpp PRIVATE drupe_store)
#   drupe_test(drupe_camera_test SOURCES ... LOCK cameras)    tests with the same lock never run at the same time
#   drupe_test(drupe_pg_test WHOLE SOURCES ...)               one process for all its tests: what they share is costly
#
# Includes are written from the top of shared/ or services/: #include "base/status.h", "reconstruction/dense/patch.h".

# Sources of a target are compiled twelve at a time, as one: most of a cold build went into reading the same headers and
# filling in the same templates again and again. Where twelve would take half a minute it is six (DEAR), so that a changed
# source is soon built. Names in unnamed namespaces must therefore differ within a target. The preset dev compiles each
# alone, and so finds a forgotten #include.
option(DRUPE_UNITY "Compile the sources of a target twelve at a time" ON)

function(drupe_join_sources name is_dear)
  set(batch 12)
  if(is_dear)
    set(batch 6)
  endif()
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${DRUPE_UNITY} UNITY_BUILD_BATCH_SIZE ${batch})
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

function(drupe_library name)
  cmake_parse_arguments(ARG "LIGHT;DEAR" "" "ALONE;SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_ALONE} ${ARG_SOURCES})
  if(ARG_LIGHT)
    target_compile_options(${name} PRIVATE ${drupe_light_options})
  endif()
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR}/shared ${PROJECT_SOURCE_DIR}/services)
  target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  drupe_join_sources(${name} "${ARG_DEAR}" ${ARG_ALONE})
endfunction()

function(drupe_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PRIVATE" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_compile_options(${name} PRIVATE ${drupe_light_options})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/shared ${PROJECT_SOURCE_DIR}/services)
  target_link_libraries(${name} PRIVATE ${ARG_PRIVATE})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  drupe_join_sources(${name} FALSE)
endfunction()

function(drupe_test name)
  cmake_parse_arguments(ARG "WHOLE;DEAR" "TIMEOUT;LOCK" "SOURCES;PRIVATE" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  set(properties TIMEOUT ${ARG_TIMEOUT})
  if(ARG_LOCK)
    list(APPEND properties RESOURCE_LOCK ${ARG_LOCK})
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_compile_options(${name} PRIVATE ${drupe_light_options})
  target_compile_definitions(${name} PRIVATE DRUPE_TEST_DATA="${PROJECT_SOURCE_DIR}/tests/data")
  target_link_libraries(${name} PRIVATE ${ARG_PRIVATE} GTest::gtest_main)
  drupe_join_sources(${name} "${ARG_DEAR}")
  if(ARG_WHOLE)
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES ${properties})
    return()
  endif()
  include(GoogleTest)
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST PROPERTIES ${properties})
endfunction()
