set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

option(DRUPE_WARNINGS_AS_ERRORS "Stop at the first warning" ON)
set(DRUPE_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")

# One binary runs on any x86-64 or arm64, so nothing here names a CPU: vector code chooses its instructions at run
# time through Highway. -march=native would also change Eigen's alignment against Debian's Ceres and PCL.
add_compile_options(-Wall -Wextra -Wshadow -Wnon-virtual-dtor)
# Programs are position-independent, and no library here is shared.
add_compile_options(-fPIE)
add_link_options($<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:-pie>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  add_compile_options(-Wno-restrict)  # GCC 12 warns of "text" + std::to_string(n), wrongly (GCC bug 105651)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # The compiler collects its garbage from half a gigabyte on, not from an eighth: a fifteenth of its time.
  add_compile_options(--param=ggc-min-heapsize=524288)
endif()
if(DRUPE_WARNINGS_AS_ERRORS)
  add_compile_options(-Werror)
endif()
if(DRUPE_SANITIZE)
  add_compile_options(-fsanitize=${DRUPE_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${DRUPE_SANITIZE})
endif()

# What works on pictures and points is optimised as far as it goes. What only passes things on (HTTP, jobs, reports, the
# command line) and the tests' own code need not be, and compile a quarter quicker.
set(drupe_light_options $<$<CONFIG:Release>:-O1>)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()
