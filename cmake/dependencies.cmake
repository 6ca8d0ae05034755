# Every outside thing that the build needs, with a clear message when it is missing. `./dev` installs them all.
if((CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 12) OR
   (CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 14))
  message(FATAL_ERROR "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} is too old: "
                      "GCC >= 12 or Clang >= 14 is needed. "
                      "Set CXX to a newer one (on Debian 12 and 13: CXX=g++) and delete this build folder.")
endif()

set(THREADS_PREFER_PTHREAD_FLAG ON)
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)

find_package(Boost 1.81 CONFIG QUIET)
if(NOT Boost_FOUND)
  message(FATAL_ERROR "Boost >= 1.81 is needed (libboost1.81-dev on Debian 12, libboost-dev on 13): "
                      "run ./dev, which installs it.")
endif()
find_package(glm REQUIRED)
find_package(CLI11 REQUIRED)
find_package(spdlog REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(GTest REQUIRED)
find_package(Vulkan REQUIRED)
find_package(prometheus-cpp CONFIG REQUIRED)
find_package(SDL2 REQUIRED)
find_package(PNG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(OpenSSL 3.0 REQUIRED)
pkg_check_modules(TURBOJPEG REQUIRED IMPORTED_TARGET libturbojpeg)
pkg_check_modules(TOMLPLUSPLUS REQUIRED IMPORTED_TARGET tomlplusplus)
pkg_check_modules(SPIRV_CROSS REQUIRED IMPORTED_TARGET spirv-cross-c-shared)
find_package(SPIRV-Tools REQUIRED CONFIG)
find_package(SPIRV-Tools-opt REQUIRED CONFIG)
pkg_check_modules(OPENEXR REQUIRED IMPORTED_TARGET OpenEXR)
pkg_check_modules(NATS REQUIRED IMPORTED_TARGET libnats)
pkg_check_modules(XXHASH REQUIRED libxxhash) # header only

# For brume-import alone, which is left out without it. Debian has no package file for CMake.
find_path(OPENVDB_INCLUDE_DIR openvdb/openvdb.h)
find_library(OPENVDB_LIBRARY openvdb)
find_library(TBB_LIBRARY tbb)
pkg_check_modules(IMATH IMPORTED_TARGET Imath)
if(OPENVDB_INCLUDE_DIR AND OPENVDB_LIBRARY AND TBB_LIBRARY AND IMATH_FOUND)
  set(OpenVDB_FOUND TRUE)
  add_library(brume_openvdb INTERFACE)
  target_include_directories(brume_openvdb SYSTEM INTERFACE ${OPENVDB_INCLUDE_DIR})
  target_link_libraries(brume_openvdb INTERFACE ${OPENVDB_LIBRARY} ${TBB_LIBRARY} PkgConfig::IMATH)
endif()

find_program(FLATC flatc REQUIRED)
find_program(GLSLANG glslangValidator REQUIRED)

add_library(brume_asio INTERFACE)
target_link_libraries(brume_asio INTERFACE Boost::boost Threads::Threads OpenSSL::SSL)
# What is no template is compiled once: protocol/net/asio.cpp.
target_compile_definitions(brume_asio INTERFACE BOOST_ASIO_NO_DEPRECATED BOOST_ASIO_SEPARATE_COMPILATION
                                                BOOST_BEAST_SEPARATE_COMPILATION)
if(BRUME_SANITIZE MATCHES thread) # the sanitizer does not know fences; Asio's mutexes order the same things
  target_compile_definitions(brume_asio INTERFACE BOOST_ASIO_DISABLE_FENCED_BLOCK)
endif()
